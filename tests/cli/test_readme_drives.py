"""The README's own lines on drives, in their order, on every twin: real port and real protocol, in virtual time."""

from __future__ import annotations

import re
import shlex
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from fricomp.cli.main import app
from fricomp.joint import Clock
from fricomp.sim_bench import twins
from fricomp.sim_bench.twins import DriveTwin, TwinClock, TwinServer
from fricomp.sim_bench.twins.configuration import PROTOCOLS

README = Path(__file__).parents[2] / "README.md"
PATIENCE = 20.0  # for another thread [s]

SHORT = {
    "calibrate": "--speeds 0.05,0.1,0.2,0.3,0.5 --dwell 0.3 --repeats 1 --warm-up 0 --method least_squares",
    "run": "--amplitude 0.05 --frequency 1 --cycles 1 --priority 0",
}
"""What makes a line of the README short enough for a test; everything else stands there."""


RUN = "run runs/twin/friction.json --config drive.toml --rate 200 --out runs/motion"
"""What follows a calibration, also where the section does not show it."""


def readme_lines() -> list[list[str]]:
    """The commands of the section on drives, without their comments; `fricomp run` at the end."""
    section = README.read_text("utf-8").partition("**Drives.**")[2].partition("\n## ")[0]
    lines = re.findall(r"^    (fricomp .*)$", section, re.MULTILINE)
    found = [shlex.split(line, comments=True)[1:] for line in lines]
    return found if any(line[0] == "run" for line in found) else [*found, shlex.split(RUN)]


class StandingServer(TwinServer):
    """A twin that answers, and whose time passes where the adapter sleeps."""

    served: list[StandingServer]

    def __init__(self, twin: DriveTwin, *, real_time: bool = False) -> None:
        super().__init__(twin)
        self.twin, self.ended = twin, threading.Event()
        self.served.append(self)

    def wait(self) -> None:
        self.ended.wait()


@contextmanager
def served(line: list[str], servers: list[StandingServer]) -> Iterator[DriveTwin]:
    """Run `fricomp twin` in a terminal of its own, until the others are done."""
    results: list[Any] = []
    thread = threading.Thread(target=lambda: results.append(CliRunner().invoke(app, line)))
    thread.start()
    configuration = Path(line[line.index("--write-config") + 1])
    try:
        for _ in range(round(PATIENCE / 0.02)):
            if servers and configuration.exists() and configuration.stat().st_size:
                break
            threading.Event().wait(0.02)
        yield servers[0].twin
    finally:
        for server in servers:
            server.ended.set()
        thread.join(PATIENCE)
    assert results[0].exit_code == 0, results[0].output


def test_the_readme_shows_a_twin_a_check_and_a_calibration() -> None:
    assert [line[0] for line in readme_lines()][:3] == ["twin", "adapter", "calibrate"]


BY_PROTOCOL = [pytest.param(name, marks=[] if name == "canopen" else pytest.mark.slow) for name in PROTOCOLS]


@pytest.mark.parametrize("protocol", BY_PROTOCOL)
def test_the_lines_of_the_readme_run_in_order(protocol: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    servers: list[StandingServer] = []
    monkeypatch.setattr(StandingServer, "served", servers, raising=False)
    monkeypatch.setattr(twins, "TwinServer", StandingServer)
    clock: Callable[[], Clock] = lambda: TwinClock(servers[0].twin)  # noqa: E731
    monkeypatch.setattr("fricomp.adapters.stopping.MonotonicClock", clock)
    lines = [[word.replace("canopen", protocol) for word in line] for line in readme_lines()]
    assert lines
    with served(lines[0], servers):
        for line in lines[1:]:
            if any(word.startswith("twin-") for word in line):
                continue  # one process, without the other terminal
            result = CliRunner().invoke(app, [*line, *SHORT.get(line[0], "").split()], input="y\n")
            assert result.exit_code == 0, f"{line}: {result.output} {result.exception}"
            assert "failed" not in result.output
    assert Path("runs/twin/friction.json").stat().st_size


@pytest.mark.slow
@pytest.mark.parametrize("protocol", BY_PROTOCOL)
def test_the_line_for_one_process_runs(protocol: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for line in readme_lines():
        if "twin-canopen" in line:
            changed = [word.replace("canopen", protocol) for word in line]
            result = CliRunner().invoke(app, [*changed, *SHORT[line[0]].split()])
            assert result.exit_code == 0, f"{result.output} {result.exception}"
            return
    pytest.fail("the README has no such line")
