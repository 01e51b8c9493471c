"""Adapters: buses and drives behind one interface, with the safety gate inside."""

from .adapter import JointAdapter
from .options import AdapterOptions
from .registry import ENTRY_POINT_GROUP, adapter_class, adapter_names, open_adapter
from .transmission import Transmission

__all__ = [
    "ENTRY_POINT_GROUP",
    "AdapterOptions",
    "JointAdapter",
    "Transmission",
    "adapter_class",
    "adapter_names",
    "open_adapter",
]
