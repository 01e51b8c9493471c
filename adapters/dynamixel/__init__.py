"""Dynamixel X servos on protocol 2.0, in current mode."""

from .adapter import DynamixelAdapter

__all__ = ["DynamixelAdapter"]
