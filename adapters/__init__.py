"""Adapters: buses and drives behind one interface, with the safety gate inside."""

if __name__ == "adapters":
    raise ImportError("adapters is a part of fricomp, with other classes under this name: import fricomp.adapters")

from .adapter import JointAdapter
from .can_adapter import CanAdapter
from .driver import Driver
from .options import AdapterOptions
from .recorded import recording_metadata
from .registry import ENTRY_POINT_GROUP, adapter_class, adapter_names, open_adapter
from .serial_adapter import SerialAdapter
from .transmission import Transmission

__all__ = [
    "ENTRY_POINT_GROUP",
    "AdapterOptions",
    "CanAdapter",
    "Driver",
    "JointAdapter",
    "SerialAdapter",
    "Transmission",
    "adapter_class",
    "adapter_names",
    "open_adapter",
    "recording_metadata",
]
