"""From a friction model to a torque: the curve, the choice of settings, the hot path, networks and adaptation."""
