"""`fricomp adapters`: which adapters there are, and with `--scan` which ports and drives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fricomp.adapters import JointAdapter
    from fricomp.adapters.asking import FoundDrive
    from fricomp.adapters.can_interfaces import CanInterface
    from fricomp.adapters.ports import SerialPort

__all__ = ["EXTRAS", "app"]

app = typer.Typer(add_completion=False)

EXTRAS = {
    "canopen": ("can",),
    "dynamixel": ("serial",),
    "mit": ("can",),
    "moteus": ("serial",),
    "odrive": ("can",),
    "sim": ("sim",),
    "twin-canopen": ("can", "sim"),
    "twin-dynamixel": ("can", "sim"),
    "twin-mit": ("can", "sim"),
    "twin-moteus": ("can", "sim"),
    "twin-odrive": ("can", "sim"),
}
"""Adapter of this package to the extras that it needs; the memory of every twin holds CAN frames."""

_MODULES = {"can": ("can", "canopen"), "serial": ("serial",), "sim": ("mujoco",)}


_EPILOG = """
fricomp adapters --scan

fricomp adapters --scan --port usb:FT6S4DSP --baudrate 57600

fricomp adapters --scan --interface slcan-chunked --channel /dev/ttyACM0 --bitrate 1000000
"""


@app.command(epilog=_EPILOG)
def adapters(
    scan: Annotated[
        bool, typer.Option("--scan", help="List ports, CAN interfaces, and the drives that answer; only reads.")
    ] = False,
    port: Annotated[
        str | None, typer.Option(help="Scan this serial port alone: a device, or usb: and its serial number.")
    ] = None,
    baudrate: Annotated[int, typer.Option(help="Baud rate of the serial port; 0 tries the usual ones.")] = 0,
    interface: Annotated[str, typer.Option(help="python-can interface of the bus named by --channel.")] = "socketcan",
    channel: Annotated[str | None, typer.Option(help="Scan this CAN bus alone: can0, /dev/ttyACM0, ...")] = None,
    bitrate: Annotated[
        int, typer.Option(help="Bit rate of the CAN bus [bit/s], where its interface sets it.")
    ] = 1_000_000,
) -> None:
    """List the adapters, those of other packages included, and what each needs installed.

    With --scan: serial ports with their serial numbers, CAN interfaces, and the drives that answer on those that are
    free. Drives are only read, and one that somebody else has energised is shown as such. A port that is not on USB,
    and a CAN interface whose bit rate is not set, are asked when they are named.
    """
    if port is not None:
        _print_drives(_scan_port(port, baudrate))
    if channel is not None:
        _print_drives(_scan_bus(interface, channel, bitrate))
    if scan and port is None and channel is None:
        _scan_all(baudrate)
    if not scan and port is None and channel is None:
        _list_adapters()


def _list_adapters() -> None:
    from fricomp.adapters.registry import REFUSED, adapter_names
    from fricomp.cli.output import answer
    from fricomp.cli.terminal import console, make_table

    names = ("backend", "what it drives", "from", "needs the extra", "installed")
    rows = [(name, *(_shipped(name) if name in EXTRAS else _plugged_in(name))) for name in adapter_names()]
    refused = [(name, f"refused: {reason}", "", "", "no") for name, reason in REFUSED.items()]
    answer({"adapters": [dict(zip(names, row, strict=True)) for row in (*rows, *refused)]})
    console().print(make_table(names, rows))
    for name, why, *_ in refused:
        console().print(f"{name} is {why}.")


def _scan_all(baudrate: int) -> None:
    """List every place, ask where that disturbs nobody, and list the drives."""
    from fricomp.cli.terminal import Table, console

    places = [*_serial_places(baudrate), *_can_places()]
    table = Table("place", "what it is", "state")
    found: list[tuple[str, FoundDrive]] = []
    for name, what, reason, ask in places:
        state, drives = (reason, ()) if ask is None else _asked(ask)
        found += drives
        table.add_row(name, what, state)
    if not places:
        console().print("No serial port and no CAN interface was found.")
        return
    console().print(table)
    _print_drives(found)


_Ask = Callable[[], "Sequence[tuple[str, FoundDrive]]"]
_Place = tuple[str, str, str, _Ask | None]
"""What opens a place, what it is, why it is not asked, and how it is."""


def _asked(ask: _Ask) -> tuple[str, Sequence[tuple[str, FoundDrive]]]:
    """What is said of a place that was asked, and the drives on it; one that fails keeps no other from being asked."""
    from fricomp.errors import AdapterError

    try:
        found = ask()
    except AdapterError as error:
        return str(error), ()
    return f"drives that answer: {len(found)}" if found else "nobody answers", found


def _serial_places(baudrate: int) -> list[_Place]:
    from fricomp.adapters.ports import find_holders, list_serial_ports
    from fricomp.errors import MissingExtraError

    def place(port: SerialPort) -> _Place:
        holders = ", ".join(find_holders(port.device))
        if holders:
            return port.name, port.description, f"open in {holders}: not asked", None
        if not port.is_usb:
            return port.name, port.description, f"not on USB: ask with --port {port.device}", None
        return f"{port.device} ({port.name})", port.description, "", lambda: _scan_port(port.device, baudrate)

    with suppress(MissingExtraError):
        return [place(port) for port in list_serial_ports()]
    return [("serial ports", "", "not listed: pyserial is not installed (extra serial)", None)]


def _can_places() -> list[_Place]:
    from fricomp.adapters.can_interfaces import list_can_interfaces
    from fricomp.errors import MissingExtraError

    def place(bus: CanInterface) -> _Place:
        what = f"CAN interface of {bus.interface}"
        if bus.is_up is None:
            how = f"--interface {bus.interface} --channel {bus.channel} --bitrate N"
            return bus.channel, what, f"its bit rate is set by who opens it: ask with {how}", None
        if not bus.is_up:
            how = f"sudo ip link set {bus.channel} up type can bitrate 1000000"
            return bus.channel, what, f"is down: {how}", None
        return bus.channel, what, "", lambda: _scan_bus(bus.interface, bus.channel, 1_000_000)

    with suppress(MissingExtraError):
        return [place(bus) for bus in list_can_interfaces()]
    return [("CAN interfaces", "", "not all listed: python-can is not installed (extra can)", None)]


def _scan_port(port: str, baudrate: int) -> list[tuple[str, FoundDrive]]:
    """The drives on a serial port, at the first of the baud rates at which some answer."""
    from fricomp.adapters.configuration import SerialConfiguration
    from fricomp.adapters.link import open_serial_link
    from fricomp.adapters.scan import BAUDRATES, find_on_serial, is_slcan
    from fricomp.errors import AdapterConnectionError
    from fricomp.joint import MonotonicClock

    clock = MonotonicClock()
    for tried in (baudrate,) if baudrate else BAUDRATES:
        link = open_serial_link(SerialConfiguration(port=port, baudrate=tried))
        try:
            if is_slcan(link, clock, tried):
                how = f"fricomp adapters --scan --interface slcan-chunked --channel {port} --bitrate N"
                raise AdapterConnectionError(f"a CAN adapter; its bus is asked with {how}")
            found = find_on_serial(link, clock, tried)
        finally:
            link.close()
        if found:
            return [(f"{port}, {tried} baud", drive) for drive in found]
    return []


def _scan_bus(interface: str, channel: str, bitrate: int) -> list[tuple[str, FoundDrive]]:
    from fricomp.adapters.can_bus import open_can_link
    from fricomp.adapters.configuration import CanBusConfiguration
    from fricomp.adapters.scan import find_on_can
    from fricomp.joint import MonotonicClock

    link = open_can_link(CanBusConfiguration(interface=interface, channel=channel, bitrate=bitrate))
    try:
        return [(channel, drive) for drive in find_on_can(link, MonotonicClock())]
    finally:
        link.close()


_ENERGISED = {True: "yes: somebody else holds it", False: "no", None: "does not tell"}


def _print_drives(found: Sequence[tuple[str, FoundDrive]]) -> None:
    from fricomp.cli.terminal import Table, console

    if not found:
        console().print("No drive answers.")
        return
    table = Table("where", "backend", "id", "what it says", "energised")
    for where, drive in found:
        table.add_row(where, drive.protocol, str(drive.address), drive.what, _ENERGISED[drive.energised])
    console().print(table)


def _shipped(name: str) -> tuple[str, str, str, str]:
    """What it drives, that it is from here, its extras, and which of them are missing."""
    from fricomp.adapters.registry import adapter_class
    from fricomp.extras import is_installed

    missing = [extra for extra in EXTRAS[name] if not all(map(is_installed, _MODULES[extra]))]
    summary = _summary(adapter_class(name)) if not missing else ""
    wanted = f"no: pip install '.[{','.join(missing)}]'" if missing else "yes"
    return summary, "fricomp", ", ".join(EXTRAS[name]), wanted


def _plugged_in(name: str) -> tuple[str, str, str, str]:
    """The same of another package's adapter, which has to be loaded to be known."""
    from fricomp.adapters.registry import adapter_class
    from fricomp.errors import FricompError

    try:
        return _summary(adapter_class(name)), "plug-in", "", "yes"
    except FricompError as error:
        return "", "plug-in", "", f"no: {error}"


def _summary(adapter: type[JointAdapter]) -> str:
    return (adapter.__doc__ or "").partition("\n")[0].rstrip(".")
