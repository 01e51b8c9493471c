"""Adapter and twin in two processes over a pseudo-terminal: the trial command, and a drive that is killed outright."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fricomp.adapters import JointAdapter, open_adapter
from fricomp.adapters.configuration import read_configuration
from fricomp.errors import AdapterError, SafetyTrip
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.studies.adapters.bench import PROTOCOLS
from fricomp.sim_bench.twins import TwinServer
from fricomp.sim_bench.twins.adapter_table import adapter_configuration
from fricomp.sim_bench.twins.configuration import make_twin
from fricomp.sim_bench.twins.odrive import flat_endpoints

pytestmark = pytest.mark.slow

COMMAND = [sys.executable, "-c", "from fricomp.cli.main import run; run()"]
PATIENCE = 60.0
PERIOD = 0.01


@pytest.fixture
def start_twin(tmp_path: Path) -> Iterator[Callable[[str], tuple[subprocess.Popen[bytes], Path]]]:
    started: list[subprocess.Popen[bytes]] = []

    def start(protocol: str) -> tuple[subprocess.Popen[bytes], Path]:
        path = tmp_path / f"{protocol}.toml"
        process = subprocess.Popen([*COMMAND, "twin", protocol, "--write-config", str(path)], stdout=subprocess.PIPE)
        started.append(process)
        deadline = time.monotonic() + PATIENCE
        while not (path.exists() and "limits" in path.read_text()):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)
        return process, path

    yield start
    for process in started:
        process.kill()
        process.communicate()


def run_command(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*COMMAND, *arguments], check=False, capture_output=True, text=True, timeout=PATIENCE)


def cycle(adapter: JointAdapter, command: JointCommand, feedback: JointFeedback) -> bool:
    sent = adapter.write(command)
    adapter.clock.sleep_until(adapter.clock.now_ns() + round(PERIOD * 1e9))
    adapter.read_into(feedback)
    return sent


@pytest.mark.parametrize("protocol", ["mit", "moteus"])
def test_a_drive_that_is_killed_stops_the_joints_with_one_clear_error(
    start_twin: Callable[[str], tuple[subprocess.Popen[bytes], Path]], protocol: str
) -> None:
    process, path = start_twin(protocol)
    table = read_configuration(path) | {"stale_after": 0.5, "watchdog": 1.0, "response_timeout": 2.0}
    adapter = open_adapter(protocol, table)
    command, feedback = JointCommand(1), JointFeedback(1)
    with adapter:
        adapter.configure("torque", PERIOD)
        adapter.enable()
        for _ in range(10):
            assert cycle(adapter, command, feedback)
        process.send_signal(signal.SIGKILL)
        process.wait()
        errors = 0
        try:
            for _ in range(200):
                if not cycle(adapter, command, feedback):
                    break
        except AdapterError:
            errors += 1
        assert adapter.gate.tripped
        assert errors <= 1
        assert not adapter.enabled
        assert not adapter.write(command)
        with pytest.raises(SafetyTrip):
            adapter.enable()


def test_the_trial_command_ends_well_on_a_twin(
    start_twin: Callable[[str], tuple[subprocess.Popen[bytes], Path]],
) -> None:
    _, path = start_twin("canopen")
    path.write_text(
        path.read_text().replace("stale_after = 0.2", "stale_after = 1.0").replace("watchdog = 0.5", "watchdog = 1.5")
    )
    found = run_command("adapter", "check", str(path), "--yes", "--rate", "100")
    assert found.returncode == 0, found.stdout + found.stderr
    for step in ("open", "configure", "listen", "energise at zero torque", "push joint forward", "stop"):
        assert step in found.stdout


def test_a_share_above_a_twentieth_is_refused_before_anything_is_opened(tmp_path: Path) -> None:
    path = tmp_path / "any.toml"
    path.write_text('backend = "mit"\n')
    found = run_command("adapter", "check", str(path), "--share", "0.2")
    assert found.returncode == 2
    assert "at most 0.05, got 0.2" in found.stderr


LOOP = """
import sys
from fricomp.adapters import open_adapter
from fricomp.adapters.configuration import read_configuration
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.studies.adapters.bench import PROTOCOLS
from fricomp.sim_bench.twins import TwinServer
from fricomp.sim_bench.twins.adapter_table import adapter_configuration
from fricomp.sim_bench.twins.configuration import make_twin
from fricomp.sim_bench.twins.odrive import flat_endpoints

table = read_configuration(sys.argv[1]) | {"stale_after": 1.0, "watchdog": 1.5, "response_timeout": 5.0}
if table["backend"] == "canopen":
    table["heartbeat"] = 0.5
adapter, command, feedback = open_adapter(table["backend"], table), JointCommand(1), JointFeedback(1)
adapter.open()
adapter.configure("torque", 0.01)
adapter.enable()
command.torque[0] = 0.2
while adapter.write(command):
    adapter.clock.sleep_until(adapter.clock.now_ns() + 10_000_000)
    adapter.read_into(feedback)
"""


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_a_control_process_that_is_killed_leaves_no_torque_behind(tmp_path: Path, protocol: str) -> None:
    path = tmp_path / "drive.toml"
    with make_twin(protocol) as twin, TwinServer(twin, real_time=True):
        endpoints = tmp_path / "endpoints.json"
        endpoints.write_text(json.dumps(flat_endpoints()))
        path.write_text(adapter_configuration(protocol, twin, str(endpoints)))
        process = subprocess.Popen([sys.executable, "-c", LOOP, str(path)])
        deadline = time.monotonic() + PATIENCE
        try:
            while abs(twin.stand_in.torque[0]) < 0.1:
                assert process.poll() is None
                assert time.monotonic() < deadline
                time.sleep(0.01)
        finally:
            process.kill()
            process.wait()
        while twin.stand_in.torque[0] != 0.0:
            assert time.monotonic() < deadline
            time.sleep(0.01)
