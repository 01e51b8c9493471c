"""Serial ports named by their USB serial number, and `fricomp adapters --scan` over ports and interfaces."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

from fricomp.adapters import can_interfaces, ports
from fricomp.adapters.can_interfaces import CanInterface, list_can_interfaces
from fricomp.adapters.configuration import SerialConfiguration
from fricomp.adapters.link import open_serial_link
from fricomp.adapters.ports import find_device, find_holders, list_serial_ports
from fricomp.cli.main import app
from fricomp.errors import AdapterConnectionError
from fricomp.sim_bench.twins import TwinServer
from fricomp.sim_bench.twins.configuration import make_twin


def port(device: str, serial_number: str | None = None, vid: int | None = 0x0403) -> Any:
    """A port as pyserial lists it."""
    return SimpleNamespace(device=device, serial_number=serial_number, description="USB serial", vid=vid)


@pytest.fixture
def plugged_in(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The ports of this machine, to be changed."""
    known: list[Any] = []
    monkeypatch.setattr("serial.tools.list_ports.comports", lambda: known)
    monkeypatch.setattr(can_interfaces, "list_can_interfaces", tuple)
    return known


def test_a_port_is_found_by_its_serial_number_wherever_it_is_plugged_in(plugged_in: list[Any]) -> None:
    plugged_in[:] = [port("/dev/ttyACM0", "A"), port("/dev/ttyACM1", "B")]
    assert find_device("usb:A") == "/dev/ttyACM0"
    plugged_in[:] = [port("/dev/ttyACM1", "B"), port("/dev/ttyACM2", "A")]
    assert find_device("usb:A") == "/dev/ttyACM2"
    assert find_device("/dev/ttyACM1") == "/dev/ttyACM1"


def test_a_serial_number_that_is_not_there_is_told_with_those_that_are(plugged_in: list[Any]) -> None:
    plugged_in[:] = [port("/dev/ttyACM0", "A"), port("/dev/ttyS0", vid=None)]
    with pytest.raises(AdapterConnectionError, match=r"number 'B', is it plugged in\? There are: usb:A$"):
        open_serial_link(SerialConfiguration(port="usb:B"))


def test_a_serial_number_of_two_ports_is_refused(plugged_in: list[Any]) -> None:
    plugged_in[:] = [port("/dev/ttyUSB0", "A"), port("/dev/ttyUSB1", "A")]
    with pytest.raises(AdapterConnectionError, match=r"/dev/ttyUSB0, /dev/ttyUSB1 have serial number 'A' all"):
        find_device("usb:A")


def test_a_device_that_is_not_there_tells_how_it_would_be_found_again(plugged_in: list[Any], tmp_path: Path) -> None:
    with pytest.raises(AdapterConnectionError, match=r"fricomp adapters --scan .*usb:NUMBER"):
        open_serial_link(SerialConfiguration(port=str(tmp_path / "ttyACM0")))


def test_ports_are_listed_by_device(plugged_in: list[Any]) -> None:
    plugged_in[:] = [port("/dev/ttyUSB1"), port("/dev/ttyACM0", "A")]
    assert [known.name for known in list_serial_ports()] == ["usb:A", "/dev/ttyUSB1"]


def test_a_port_that_another_process_has_open_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    _, user = os.openpty()
    device = os.ttyname(user)
    assert find_holders(device) == ()  # this process's own
    own = os.getpid()
    monkeypatch.setattr("os.getpid", lambda: -1)
    assert [text.partition(" (")[0] for text in find_holders(device)] == [f"process {own}"]


def scan(*options: str) -> str:
    result = CliRunner().invoke(app, ["adapters", "--scan", *options], env={"COLUMNS": "200"})
    assert result.exit_code == 0, f"{result.output} {result.exception}"
    return result.output


def test_the_scan_says_where_there_is_nothing(plugged_in: list[Any]) -> None:
    assert "No serial port and no CAN interface was found." in scan()


def test_the_scan_asks_on_free_usb_ports_and_says_why_not_on_others(
    plugged_in: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    with make_twin("moteus") as twin, TwinServer(twin, real_time=True):
        address = twin.port.address  # type: ignore[attr-defined]
        plugged_in[:] = [port(address, "TWIN1"), port("/dev/ttyS7", vid=None), port("/dev/ttyHELD", "H")]
        holders = {"/dev/ttyHELD": ("process 7 (other)",)}
        monkeypatch.setattr(ports, "find_holders", lambda device: holders.get(device, ()))
        shown = scan()
    lines = {line.split()[1]: line for line in shown.splitlines() if line.startswith("│")}
    assert "drives that answer: 1" in lines[address]
    assert "usb:TWIN1" in lines[address]
    assert "ask with --port /dev/ttyS7" in lines["/dev/ttyS7"]
    assert "open in process 7 (other): not asked" in lines["usb:H"]
    assert "moteus in mode 0" in lines[f"{address},"]


def test_a_port_is_scanned_by_its_serial_number(plugged_in: list[Any]) -> None:
    with make_twin("dynamixel") as twin, TwinServer(twin, real_time=True):
        plugged_in[:] = [port(twin.port.address, "TWIN1")]  # type: ignore[attr-defined]
        shown = scan("--port", "usb:TWIN1")
    assert "XM430-W350, firmware 48" in shown


def test_a_can_adapter_on_a_serial_port_is_told_how_to_ask_its_bus(plugged_in: list[Any]) -> None:
    with make_twin("mit") as twin, TwinServer(twin, real_time=True):
        address = twin.port.port.address  # type: ignore[attr-defined]
        plugged_in[:] = [port(address, "TWIN1")]
        assert "--interface slcan-chunked --channel" in scan()
        shown = scan("--interface", "slcan-chunked", "--channel", address)
    assert "Damiao, feedback_id 0x11, ranges [12.5, 30, 10]" in shown


def test_a_port_that_fails_keeps_no_other_from_being_asked(plugged_in: list[Any]) -> None:
    plugged_in[:] = [port("/dev/none", "A"), port("/dev/nothing", "B")]
    shown = scan()
    assert shown.count("cannot open serial port") == 2
    assert "No drive answers." in shown


def test_a_can_interface_is_asked_only_if_its_bit_rate_is_set(
    plugged_in: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = (CanInterface("socketcan", "can7", False), CanInterface("pcan", "PCAN_USBBUS1", None))
    monkeypatch.setattr(can_interfaces, "list_can_interfaces", lambda: found)
    shown = scan()
    assert "is down: sudo ip link set can7 up type can bitrate 1000000" in shown
    assert "--interface pcan --channel PCAN_USBBUS1 --bitrate N" in shown


def test_can_interfaces_of_linux_are_listed_with_their_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, kind, flags in (("can0", "280", "0x40081"), ("can1", "280", "0x40080"), ("eth0", "1", "0x1003")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "type").write_text(f"{kind}\n")
        (tmp_path / name / "flags").write_text(f"{flags}\n")
    monkeypatch.setattr(can_interfaces, "NETWORKS", tmp_path)
    monkeypatch.setattr(can_interfaces, "VENDORS", ())
    assert list_can_interfaces() == (CanInterface("socketcan", "can0", True), CanInterface("socketcan", "can1", False))
