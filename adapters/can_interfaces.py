"""CAN interfaces of this machine: those of Linux with their state, and those that python-can finds."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from fricomp.extras import needing

__all__ = ["CanInterface", "list_can_interfaces"]

NETWORKS = Path("/sys/class/net")
TYPE_OF_CAN = "280"  # ARPHRD_CAN (linux/if_arp.h)
VENDORS = ("canalystii", "cantact", "gs_usb", "ixxat", "kvaser", "neovi", "nican", "pcan", "slcan", "systec", "vector")
"""Interfaces of python-can with hardware of their own; the others are buses in memory or on a network."""


class CanInterface(NamedTuple):
    """A CAN interface.

    Attributes:
        interface: As python-can names it.
        channel: Its channel.
        is_up: Whether it runs, with a bit rate that is set already; None where it is set by whoever opens it.
    """

    interface: str
    channel: str
    is_up: bool | None


def list_can_interfaces() -> tuple[CanInterface, ...]:
    """All CAN interfaces that can be found without opening one.

    Raises:
        MissingExtraError: python-can is not installed.
    """
    return (*_of_linux(), *_of_vendors())


def _of_linux() -> list[CanInterface]:
    found = []
    for entry in sorted(NETWORKS.iterdir()) if NETWORKS.is_dir() else ():
        try:
            if (entry / "type").read_text().strip() == TYPE_OF_CAN:
                is_up = bool(int((entry / "flags").read_text(), 16) & 1)  # IFF_UP (linux/if.h)
                found.append(CanInterface("socketcan", entry.name, is_up))
        except (OSError, ValueError):  # it has gone meanwhile
            continue
    return found


def _of_vendors() -> list[CanInterface]:
    with needing("python-can", "can"):
        import can
    found = []
    with _silence():  # every driver that is not installed complains
        for name in VENDORS:
            try:
                configurations = can.detect_available_configs(name)
            except Exception:  # whatever a vendor's driver raises, it has nothing to offer
                continue
            found += [CanInterface(str(c["interface"]), str(c["channel"]), None) for c in configurations]
    return found


@contextmanager
def _silence() -> Iterator[None]:
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        yield
    finally:
        logging.disable(before)
