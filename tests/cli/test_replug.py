"""A cable that is pulled in the middle of a calibration and comes back as another device: `--resume` goes on."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import can
import pytest
from can.interfaces.virtual import VirtualBus
from typer.testing import CliRunner, Result

from fricomp.cli.main import app
from fricomp.recording import read_recording
from fricomp.sim_bench.twins import DriveTwin, TwinClock
from fricomp.sim_bench.twins.adapter_table import adapter_configuration, twin_address
from fricomp.sim_bench.twins.configuration import CAN_PROTOCOLS, PROTOCOLS, make_twin
from fricomp.sim_bench.twins.odrive import flat_endpoints
from fricomp.sim_bench.twins.port import PtyPort

SHORT = shlex.split("--speeds 0.05,0.1,0.2,0.3,0.5 --dwell 0.3 --repeats 1 --warm-up 0 --method least_squares")
PULLED_NS = 12_000_000_000


class PulledClock(TwinClock):
    """Virtual time of a twin whose cable is pulled at one moment, and plugged into another port."""

    def __init__(self, twin: DriveTwin, pull: Callable[[], None]) -> None:
        super().__init__(twin)
        self._pull: Callable[[], None] | None = pull

    def sleep_until(self, deadline_ns: int) -> None:
        if self._pull is not None and deadline_ns > PULLED_NS:
            pull, self._pull = self._pull, None
            pull()
        super().sleep_until(deadline_ns)


def replug(twin: Any) -> None:
    old = getattr(twin.port, "port", twin.port)
    new = PtyPort()  # first, so that it is another device
    old.close()
    if twin.port is old:
        twin.port = new
    else:
        twin.port.port, twin.port.is_open = new, False


def call(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments))


@pytest.fixture
def endpoints(tmp_path: Path) -> Path:
    file = tmp_path / "endpoints.json"
    file.write_text(json.dumps(flat_endpoints()))
    return file


def calibrate_and_go_on(file: Path, out: Path, clock: PulledClock, complaint: str, torque: Callable[[], float]) -> None:
    """A calibration that ends in one clear sentence and at zero torque, and goes on where it was."""
    stopped = call("calibrate", "--config", str(file), "--out", str(out), *SHORT)
    assert stopped.exit_code == 1
    assert complaint in str(stopped.exception)
    assert f"go on with fricomp calibrate --resume --out {out}" in stopped.stderr
    kept = len(read_recording(out / "recording.csv"))
    assert kept > 0
    clock.sleep_until(clock.now_ns() + 1_000_000_000)  # longer than the watchdogs of all twins
    assert torque() == 0.0
    # A Dynamixel whose watchdog has fired holds still: whether its joint may go limp is its user's to say.
    take_over = ["--take-over"] if 'backend = "dynamixel"' in file.read_text() else []
    cleared = call("adapter", "clear", str(file), *take_over)
    assert cleared.exit_code == 0, cleared.exception
    assert "nothing is energised" in cleared.output
    resumed = call("calibrate", "--resume", "--out", str(out))
    assert resumed.exit_code == 0, f"{resumed.output} {resumed.exception}"
    assert len(read_recording(out / "recording.csv")) > kept


@pytest.mark.slow
@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_calibration_goes_on_after_its_port_was_replugged(
    protocol: str, tmp_path: Path, endpoints: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    twin = make_twin(protocol)
    first = twin_address(twin)
    file = tmp_path / "drive.toml"
    text = adapter_configuration(protocol, twin, str(endpoints)).replace(str(first), "usb:TWIN1")
    # Above what the simulated motor has: at its very limit the noise of a reading would stop a servo's velocity mode.
    file.write_text(text.replace("torque = 5.0", "torque = 5.5") if protocol == "dynamixel" else text)

    def ports() -> list[Any]:
        return [SimpleNamespace(device=twin_address(twin), serial_number="TWIN1", description="", vid=1)]

    clock = PulledClock(twin, lambda: replug(twin))
    monkeypatch.setattr("serial.tools.list_ports.comports", ports)
    monkeypatch.setattr("fricomp.adapters.stopping.MonotonicClock", lambda: clock)
    complaint = "cannot read from the serial port: it has been unplugged"
    calibrate_and_go_on(file, tmp_path / "run", clock, complaint, lambda: float(twin.stand_in.torque[0]))
    assert twin_address(twin) != first
    twin.close()


class ResetBus(VirtualBus):
    """A virtual bus whose network is set down at one moment, or whose controller goes bus-off, until it is reopened."""

    error: can.CanError | None = None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        if self.error is not None:
            raise self.error
        super().send(msg, timeout)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if self.error is not None:
            raise self.error
        return super()._recv_internal(timeout)


ERRORS = {
    "link reset": can.CanOperationError("Network is down", 100),
    "bus-off": can.CanOperationError("Failed to transmit: No buffer space available", 105),
}


@pytest.mark.slow
@pytest.mark.parametrize("protocol", sorted(CAN_PROTOCOLS))
@pytest.mark.parametrize("name", ERRORS)
def test_a_calibration_goes_on_after_its_bus_was_reset(
    protocol: str, name: str, tmp_path: Path, endpoints: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[ResetBus] = []

    def open_bus(configuration: Any) -> can.BusABC:
        opened.append(ResetBus(channel=configuration.channel))
        return opened[-1]

    channel = f"reset {protocol} {name}"
    with make_twin(protocol) as other:  # on a pseudo-terminal: what is written of it holds for both but for the bus
        text = adapter_configuration(protocol, other, str(endpoints)).replace(str(twin_address(other)), channel)
    file = tmp_path / "drive.toml"
    file.write_text(text.replace('"slcan-chunked"', '"virtual"'))
    twin = make_twin(protocol, {"link": {"kind": "can", "channel": channel}})
    clock = PulledClock(twin, lambda: setattr(opened[-1], "error", ERRORS[name]))
    monkeypatch.setattr("fricomp.adapters.can_bus._open_bus", open_bus)
    monkeypatch.setattr("fricomp.adapters.stopping.MonotonicClock", lambda: clock)
    complaint = str(ERRORS[name])
    calibrate_and_go_on(file, tmp_path / "run", clock, complaint, lambda: float(twin.stand_in.torque[0]))
    twin.close()
