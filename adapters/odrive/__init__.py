"""ODrive over CANSimple, firmware 0.6 and 0.5."""

from .adapter import OdriveAdapter

__all__ = ["OdriveAdapter"]
