"""CAN over a serial line (slcan), read in chunks."""

from .bus import ChunkedSlcanBus

__all__ = ["ChunkedSlcanBus"]
