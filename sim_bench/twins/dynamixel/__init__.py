"""Dynamixel servos on one line, protocol 2.0."""
