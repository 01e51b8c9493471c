"""The safety gate, which every torque passes, with its limits and its watch over the motion."""
