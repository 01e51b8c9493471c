"""Twins from configuration tables, and over every kind of link."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from signal import SIGINT
from typing import Any

import can
import pytest
import serial

from fricomp.adapters import open_adapter
from fricomp.errors import AdapterConnectionError, ParameterError
from fricomp.joint import JointFeedback
from fricomp.sim_bench.twins import DriveTwin, TwinServer
from fricomp.sim_bench.twins.adapter_table import adapter_configuration
from fricomp.sim_bench.twins.configuration import PROTOCOLS, make_twin
from fricomp.sim_bench.twins.odrive import flat_endpoints

from .rig import fresh_channel, wait_for


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_every_protocol_starts_as_delivered(protocol: str) -> None:
    with make_twin(protocol) as made:
        for _ in range(5):
            made.step()
        assert made.stand_in.torque == [0.0]


def address(made: DriveTwin) -> str:
    port: Any = made.port  # type: ignore[attr-defined]
    return str(getattr(port, "port", port).address)


@pytest.mark.parametrize("kind", ["pty", "tcp"])
def test_a_can_twin_answers_python_cans_slcan_across_a_serial_line(kind: str) -> None:
    with make_twin("odrive", {"link": {"kind": kind}}) as made, TwinServer(made, real_time=True) as server:
        with can.Bus(interface="slcan", channel=address(made), bitrate=1_000_000, sleep_after_open=0.0) as bus:
            bus.send(can.Message(arbitration_id=1 << 5 | 0x09, is_extended_id=False, is_remote_frame=True))
            found: list[int] = []

            def answered() -> bool:
                message = bus.recv(0.01)
                found.extend([message.arbitration_id] if message is not None else [])
                return (1 << 5 | 0x09) in found

            wait_for(answered)
        assert server.error is None


@pytest.mark.parametrize("kind", ["pty", "tcp"])
def test_a_serial_twin_answers_on_a_line(kind: str) -> None:
    with make_twin("moteus", {"link": {"kind": kind}}) as made, TwinServer(made) as server:
        with serial.serial_for_url(address(made), timeout=5.0) as line:
            line.write(b"can send 8001 1100\n")
            assert [line.readline().split()[0] for _ in range(2)] == [b"OK", b"rcv"]
        assert server.error is None


def test_drives_and_joints_are_configured() -> None:
    table = {
        "link": {"kind": "can", "interface": "virtual", "channel": fresh_channel()},
        "drives": [{"receive_id": 5, "gear_ratio": 6.0}, {"receive_id": 6, "feedback_id": 0x66}],
        "sim": {"model": "two_link_arm", "seed": 2},
    }
    with make_twin("mit", table) as made:
        first, second = made.drives
        assert (first.settings.receive_id, first.settings.feedback_id, first.axis.gear_ratio) == (5, 0x11, 6.0)
        assert second.settings.feedback_id == 0x66
        assert made.stand_in.settings.seed == 2
        assert first.axis.torque_limit == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("protocol", "table", "message"),
    [
        ("can", {}, "no twin for 'can'; there are canopen, dynamixel, mit, moteus, odrive"),
        ("mit", {"drives": [{}, {}]}, "2 drives given for 1 joints"),
        ("mit", {"drives": [{"recieve_id": 3}]}, "no recieve_id; known: receive_id"),
        ("mit", {"drives": [{"gear_ratio": 0.0}]}, "gear_ratio must be positive"),
        ("moteus", {"link": {"kind": "can"}}, "choose link.kind"),
        ("moteus", {"lnik": {}}, "lnik"),
        ("moteus", {"sim": {"model": "missing.xml", "joints": [{"name": "a"}]}}, "not a model"),
    ],
)
def test_a_wrong_configuration_says_what_is_valid(protocol: str, table: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        make_twin(protocol, table)


def test_a_bus_that_cannot_be_opened_is_a_connection_error() -> None:
    with pytest.raises(AdapterConnectionError, match="no-such-can"):
        make_twin("mit", {"link": {"kind": "can", "interface": "no-such-can", "channel": "x"}})


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_configuration_written_for_a_twin_is_one_its_adapter_takes(protocol: str, tmp_path: Path) -> None:
    endpoints = tmp_path / "flat_endpoints.json"
    endpoints.write_text(json.dumps(flat_endpoints()))
    with make_twin(protocol, {"drives": [{"gear_ratio": 2.0}]}) as made:
        table = tomllib.loads(adapter_configuration(protocol, made, str(endpoints)))
        adapter = open_adapter(table["backend"], table)
    (limits,) = adapter.options.limits
    (transmission,) = adapter.options.transmissions or ()
    assert (limits.torque, limits.position, transmission.gear_ratio) == (5.0, (-2.95, 2.95), 2.0)


def test_no_configuration_is_written_for_a_bus_that_its_owner_knows() -> None:
    table = {"link": {"kind": "can", "interface": "virtual", "channel": fresh_channel()}}
    with make_twin("mit", table) as made, pytest.raises(ParameterError, match="pty or TCP"):
        adapter_configuration("mit", made)


def test_the_command_serves_a_twin_in_a_process_of_its_own_until_interrupted(tmp_path: Path) -> None:
    file = tmp_path / "drive.toml"
    command = [sys.executable, "-m", "fricomp.cli.main", "twin", "odrive", "--write-config", str(file)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for _ in range(2):
            process.stdout.readline()
        with open_adapter("odrive", tomllib.loads(file.read_text())) as adapter:
            adapter.configure("torque", 0.005)
            assert adapter.capabilities.watchdog is not None
            feedback = JointFeedback(1)
            wait_for(lambda: adapter.read_into(feedback))
            assert feedback.position[0] == pytest.approx(0.0, abs=1e-4)
        process.send_signal(SIGINT)
        assert process.wait(timeout=10.0) == 130


def test_the_documented_lines_open_a_twin_in_this_process() -> None:
    """The imports are among them."""
    page = (Path(__file__).parents[3] / "docs" / "twins.md").read_text("utf-8")
    (lines,) = (block for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "make_twin(" in block)
    names: dict[str, Any] = {}
    exec(lines, names)
    with names["twin"], names["adapter"] as adapter:
        assert [joint.name for joint in adapter.capabilities.joints] == ["joint"]
