"""From the blocks of a sweep to friction points: settled parts, breakaways, gravity, the rigid body taken off."""
