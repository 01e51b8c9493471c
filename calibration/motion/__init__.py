"""A joint's rigid body and friction from any recorded motion, without a sweep."""
