"""A calibration that is told to end in the middle of a motion: zero torque, and what was recorded stays."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from fricomp.adapters import adapter_class
from fricomp.calibration.sweep import (
    CalibrationOptions,
    CalibrationRequest,
    IdentificationSettings,
    SweepSettings,
    load_sweep,
)
from fricomp.calibration.sweep.motion.motion import MotionRunner
from fricomp.calibration.sweep.motion.velocity_loop import DriveLoop
from fricomp.cli.calibration.start import record_file, start_run
from fricomp.errors import AdapterError, FricompError
from fricomp.joint import JointCommand
from fricomp.recording import RecordingWriter
from fricomp.sim_bench.studies.adapters.bench import PROTOCOLS

SETTINGS = SweepSettings(speeds="0.8,1.5,3.0,4.0", repeats=1, warm_up=0.2, dwell=0.4, tare=0.2, breakaway_positions=0)


@pytest.fixture(autouse=True)
def _signals_as_before() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def make_request(backend: str) -> CalibrationRequest:
    options = CalibrationOptions(IdentificationSettings(method="least_squares"))
    return CalibrationRequest(backend, settings=SETTINGS, options=options)


class Interrupter:
    """Does something in the middle of a command, some cycles after the second plateau is on disk."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, backend: str, strike: Callable[[Any], None]) -> None:
        self.left: int | None = None
        self.n_plateaus = 0
        self.adapter: Any = None
        kind: Any = adapter_class(backend)
        append, write = RecordingWriter.append, kind._write

        def counting(writer: RecordingWriter, block: Any, label: str = "") -> Any:
            self.n_plateaus += '"plateau"' in label
            if self.n_plateaus == 2 and self.left is None:
                self.left = 300
            return append(writer, block, label)

        def interrupted(adapter: Any, command: JointCommand, mode: Any) -> None:
            if self.left is not None:
                self.left -= 1
                if self.left == 0:
                    self.adapter = adapter
                    strike(adapter)
            write(adapter, command, mode)

        monkeypatch.setattr(RecordingWriter, "append", counting)
        monkeypatch.setattr(kind, "_write", interrupted)


@pytest.mark.parametrize(
    ("backend", "number"), [("sim", signal.SIGINT), ("twin-canopen", signal.SIGTERM), ("twin-moteus", signal.SIGTERM)]
)
def test_a_signal_leaves_zero_torque_and_all_whole_blocks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, backend: str, number: signal.Signals
) -> None:
    out = tmp_path / "run"
    with monkeypatch.context() as patch:
        interrupter = Interrupter(patch, backend, lambda _: signal.raise_signal(number))
        with pytest.raises(KeyboardInterrupt):
            start_run(make_request(backend), out, overwrite=False)
    assert_stopped_and_kept(interrupter.adapter, out)


def assert_stopped_and_kept(adapter: Any, out: Path) -> None:
    stand_in = getattr(adapter, "twin", adapter).stand_in
    assert not adapter.enabled
    for _ in range(600):  # a drive that nobody reaches any more has its watchdog
        getattr(adapter, "twin", stand_in).step()
    assert stand_in.torque == [0.0]
    assert [label.number for label, _ in load_sweep(out / "recording.csv").of_kind("plateau")] == [0, 1]


def strike_between_calls(monkeypatch: pytest.MonkeyPatch, strike: Callable[[], None]) -> list[Any]:
    """Do something in motion while no adapter is called; returns the adapter, once there is one."""
    seen: list[Any] = []
    start, command, left = MotionRunner.start, DriveLoop.command, iter(range(100, -1, -1))

    def noted(runner: MotionRunner, loop: Any) -> None:
        seen[:] = [runner._adapter]
        start(runner, loop)

    def struck(loop: DriveLoop, *given: Any) -> None:
        if next(left, None) == 0:
            strike()
        command(loop, *given)

    monkeypatch.setattr(MotionRunner, "start", noted)
    monkeypatch.setattr(DriveLoop, "command", struck)
    return seen


def run_or_record(out: Path, *, motion: bool) -> None:
    if not motion:
        start_run(make_request("sim"), out, overwrite=False)
        return
    file = out.with_suffix(".csv")
    file.write_text("time,position,velocity\n0,1.0,0\n1,1.0,0\n2,1.0,0\n")
    record_file(replace(make_request("sim"), motion=str(file)), out)


@pytest.mark.parametrize("motion", [False, True])
def test_the_joint_is_stopped_before_anything_is_closed_or_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, motion: bool
) -> None:
    told: list[tuple[str, bool]] = []
    seen = strike_between_calls(monkeypatch, lambda: signal.raise_signal(signal.SIGINT))
    stop, close = adapter_class("sim")._stop, RecordingWriter.close

    def disturbed(adapter: Any) -> None:
        if adapter.gate.tripped:
            signal.raise_signal(signal.SIGINT)
        stop(adapter)

    def closing(writer: RecordingWriter) -> None:
        told.append(("closed", seen[0].enabled))
        close(writer)

    monkeypatch.setattr(adapter_class("sim"), "_stop", disturbed)
    monkeypatch.setattr(RecordingWriter, "close", closing)
    monkeypatch.setattr("builtins.print", lambda text, **_: told.append((text, seen[0].enabled)))
    with pytest.raises(KeyboardInterrupt):
        run_or_record(tmp_path / "run", motion=motion)
    assert "closed" in dict(told)
    assert "the joint is at zero torque" in "".join(text for text, _ in told)
    assert not any(enabled for _, enabled in told)


@pytest.mark.parametrize("motion", [False, True])
def test_a_stop_that_fails_is_told_and_no_zero_torque_is_claimed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *, motion: bool
) -> None:
    def fail(adapter: Any) -> None:
        raise AdapterError("the bus is off")

    def strike() -> None:
        monkeypatch.setattr(adapter_class("sim"), "_stop", fail)
        signal.raise_signal(signal.SIGINT)

    strike_between_calls(monkeypatch, strike)
    with pytest.raises(AdapterError, match=r"KeyboardInterrupt.*the bus is off: cut the power") as caught:
        run_or_record(tmp_path / "run", motion=motion)
    assert isinstance(caught.value.__cause__, KeyboardInterrupt)
    said = capsys.readouterr().err
    assert "Interrupted" in said
    assert "zero torque" not in said


def unplug(adapter: Any) -> None:
    adapter.twin.unplugged = True


def power_cycle(adapter: Any) -> None:
    adapter.twin.power_cycle()


@pytest.mark.parametrize(
    ("backend", "strike"),
    [*((f"twin-{protocol}", unplug) for protocol in sorted(PROTOCOLS)), ("twin-canopen", power_cycle)],
)
def test_a_drive_that_is_lost_ends_the_sweep_with_one_sentence_and_all_whole_blocks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, backend: str, strike: Callable[[Any], None]
) -> None:
    out = tmp_path / "run"
    with monkeypatch.context() as patch:
        interrupter = Interrupter(patch, backend, strike)
        with pytest.raises(FricompError) as caught:
            start_run(make_request(backend), out, overwrite=False)
    assert len(str(caught.value).splitlines()) == 1
    assert_stopped_and_kept(interrupter.adapter, out)
