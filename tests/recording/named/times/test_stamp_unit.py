"""Times whose unit is told by the day that they are, or by what stands above them, and those that nothing tells."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.named.times.stamp_unit import are_known_ticks, guess_unit

RATE = 400.0
TIME = np.arange(4000) / RATE
POSITION = 0.7 * np.sin(1.7 * TIME) + 0.1 * np.sin(5.3 * TIME + 0.4)
RATE_OF_IT = 1.19 * np.cos(1.7 * TIME) + 0.53 * np.cos(5.3 * TIME + 0.4)
TORQUE = 0.25 * np.sign(RATE_OF_IT) + 0.08 * RATE_OF_IT + 0.3 * np.sin(POSITION)
CLOCK = 32768


def write(folder: Path, name: str, stamps: np.ndarray[tuple[int], np.dtype[np.int64]], above: str = "") -> Path:
    cells = zip(stamps.tolist(), POSITION, TORQUE, strict=True)
    rows = [f"{t},{q:.9f},{tau:.9f}" for t, q, tau in cells]
    (folder / "log.csv").write_text("\n".join([f"{above}{name},q [rad],tau [Nm]", *rows]) + "\n")
    return folder / "log.csv"


@pytest.mark.parametrize("name", ["TimeStamp", "ticks", "clk"])
@pytest.mark.parametrize("begin", [133_900_000_000_000_000, 638_800_000_000_000_000])
def test_file_times_of_windows_and_ticks_of_net_are_tenths_of_microseconds(
    begin: int, name: str, tmp_path: Path
) -> None:
    path = write(tmp_path, name, begin + np.round(1e7 * TIME).astype(np.int64))
    recording = read_content(path).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=2e-5)  # what a float of that size counts


@pytest.mark.parametrize(
    ("first", "one", "unit"),
    [(1.7e9, 1.0, "s"), (1.7e12, 1e-3, "ms"), (1.7e15, 1e-6, "us"), (1.7e18, 1e-9, "ns"), (8.2e17, 1e-9, "ns"),
     (3.8e9, 1.0, "s")],
)  # fmt: skip
def test_stamps_of_other_epochs_have_their_units(first: float, one: float, unit: str) -> None:
    assert guess_unit(first + np.round(TIME[:100] * 1e9) * 1e-9 / one) == unit


def test_ticks_are_as_many_a_second_as_stands_above_them(tmp_path: Path) -> None:
    ticks = np.round(CLOCK * TIME).astype(np.int64)
    for above in (
        f"# tick rate: {CLOCK} Hz\n",
        "# counter clock = 32.768 kHz\n",
        f"# {CLOCK} x\n# ticks per second: {CLOCK}\n",
    ):
        recording = read_content(write(tmp_path, "ticks", ticks, above)).recording
        assert recording.time == pytest.approx(TIME, abs=1.0 / CLOCK)


@pytest.mark.parametrize("name", ["ticks", "TickCount", "systick", "timer_ticks"])
def test_ticks_of_unknown_size_are_asked_about_and_the_proposal_asks_too(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, name, np.round(CLOCK * TIME).astype(np.int64))
    with pytest.raises(RecordingError, match="scale = 1/TICKS_A_SECOND"):
        read_content(path)
    proposal = inspect_log(path).guess
    assert "scale = 1/TICKS_A_SECOND" in proposal
    (tmp_path / "log.toml").write_text(re.sub("1/TICKS_A_SECOND", repr(1.0 / CLOCK), proposal))
    (found,) = convert(path, load_mapping(tmp_path / "log.toml"))
    assert found.recording.time == pytest.approx(TIME, abs=1.0 / CLOCK)


@pytest.mark.parametrize(
    ("step", "known"),
    [(2.0, True), (5.0, True), (16.0 + 2.0 / 3.0, True), (2500.0, True), (81.92, False), (64.0, False)],
)
def test_ticks_of_a_whole_rate_are_parts_of_a_second(step: float, known: bool) -> None:
    assert are_known_ticks(np.round(step * np.arange(2000))) == known


def test_ticks_that_jitter_are_parts_of_a_second() -> None:
    steps = np.random.default_rng(4).integers(7, 14, 500)
    assert are_known_ticks(np.cumsum(steps).astype(np.float64))
