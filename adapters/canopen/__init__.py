"""CiA 402 drives over CANopen."""

from .adapter import CanOpenAdapter

__all__ = ["CanOpenAdapter"]
