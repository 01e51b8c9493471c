"""A calibration that is told to end in the middle of a motion: zero torque, and what was recorded stays."""

from __future__ import annotations

import signal
from collections.abc import Iterator
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
from fricomp.cli.calibration import start_run
from fricomp.joint import JointCommand
from fricomp.recording import RecordingWriter

SETTINGS = SweepSettings(
    speeds="0.1,0.3,0.8,1.5,3.0,4.0", repeats=1, warm_up=0.5, dwell=0.4, tare=0.5, breakaway_positions=0
)


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
    """Raises a signal in the middle of a command, some cycles after the second plateau is on disk."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, backend: str, number: signal.Signals) -> None:
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
                    signal.raise_signal(number)
            write(adapter, command, mode)

        monkeypatch.setattr(RecordingWriter, "append", counting)
        monkeypatch.setattr(kind, "_write", interrupted)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize("backend", ["sim", "twin-canopen", "twin-moteus"])
def test_a_signal_leaves_zero_torque_and_all_whole_blocks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, backend: str, number: signal.Signals
) -> None:
    out = tmp_path / "run"
    with monkeypatch.context() as patch:
        interrupter = Interrupter(patch, backend, number)
        with pytest.raises(KeyboardInterrupt):
            start_run(make_request(backend), out, overwrite=False)
    adapter = interrupter.adapter
    stand_in = getattr(adapter, "twin", adapter).stand_in
    assert not adapter.enabled
    assert not stand_in.servos[0].enabled
    stand_in.step()
    assert stand_in.torque == [0.0]
    assert [label.number for label, _ in load_sweep(out / "recording.csv").of_kind("plateau")] == [0, 1]
