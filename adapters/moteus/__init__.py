"""moteus controllers behind an fdcanusb."""

from .adapter import MoteusAdapter

__all__ = ["MoteusAdapter"]
