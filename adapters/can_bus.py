"""Opening the CAN bus that stands in a configuration: any interface of python-can, or slcan read in chunks."""

from __future__ import annotations

import warnings
from importlib.util import find_spec
from typing import TYPE_CHECKING

from fricomp.errors import AdapterConnectionError
from fricomp.extras import needing

from .configuration import CanBusConfiguration
from .link import CanLink, PythonCanLink

if TYPE_CHECKING:
    import can


def open_can_link(configuration: CanBusConfiguration) -> CanLink:
    """The bus that stands in the configuration.

    Raises:
        AdapterConnectionError: It cannot be opened.
        MissingExtraError: python-can is not installed.
    """
    with needing("python-can", "can"):
        import can  # noqa: F401
    try:
        return PythonCanLink(_open_bus(configuration))
    except Exception as error:
        raise AdapterConnectionError(
            f"cannot open CAN interface {configuration.interface!r}, channel {configuration.channel!r}: {error}"
        ) from error


def _open_bus(configuration: CanBusConfiguration) -> can.BusABC:
    import can

    if configuration.interface == "slcan-chunked":
        from .slcan import ChunkedSlcanBus

        return ChunkedSlcanBus(str(configuration.channel), configuration.bitrate, **configuration.options)
    _warn_of_another(configuration.interface)
    bus: can.BusABC = can.Bus(
        interface=configuration.interface,
        channel=configuration.channel,
        bitrate=configuration.bitrate,
        **configuration.options,
    )
    return bus


def _warn_of_another(interface: str) -> None:
    """Any installed package may take the name of an interface of python-can, and is used in its place."""
    from can.interfaces import BACKENDS

    module = BACKENDS[interface][0] if interface in BACKENDS else "can"
    if module.partition(".")[0] != "can" and find_spec(f"can.interfaces.{interface}") is not None:
        warnings.warn(
            f"CAN interface {interface!r} is that of {module}, which stands before python-can's own: uninstall its "
            f"package if that is not intended",
            RuntimeWarning,
            stacklevel=2,
        )
