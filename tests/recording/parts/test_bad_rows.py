"""Rows without a number or a later time: left out alone, before anything is summed over them, and never unsaid."""

from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest

from fricomp.recording import Mapping, NamedRecording, Recording, convert, write_recording
from fricomp.recording.file import read_content
from fricomp.recording.validity import drop_bad_rows

TIME = np.arange(1000) / 100


def _convert(folder: Path, columns: list[np.ndarray], position: str) -> NamedRecording:
    from tomllib import loads

    channels = f"time = {{ column = 1 }}\nposition = {position}\nvelocity = {{ column = 2 }}\ntorque = {{ column = 3 }}"
    np.save(folder / "log.npy", np.column_stack(columns))
    mapping = msgspec.convert(loads(f"skip_bad_rows = true\n[channels]\n{channels}"), Mapping)
    (named,) = convert(folder / "log.npy", mapping)
    return named


def test_a_bad_row_does_not_spoil_the_sums_and_angles_after_it(tmp_path: Path) -> None:
    velocity, torque = np.cos(TIME), np.ones(1000)
    velocity[400] = np.nan
    summed = _convert(tmp_path, [TIME, velocity, torque], '{ integral_of = "velocity" }').recording
    assert np.array_equal(summed.time, np.delete(TIME, 400))
    assert np.abs(summed.position - np.sin(summed.time)).max() < 1e-4
    angle = (3.0 * TIME) % (2 * np.pi)
    angle[400] = np.nan
    turned = _convert(tmp_path, [TIME, angle, torque], "{ column = 2, unwrap = 6.283185307179586 }").recording
    assert turned.position == pytest.approx(np.delete(3.0 * TIME, 400), abs=1e-9)


@pytest.mark.parametrize("row", [0, 500])
def test_one_wild_stamp_costs_one_row(tmp_path: Path, row: int, make_recording: Callable[..., Recording]) -> None:
    time = TIME.copy()
    time[row] = 1e6
    named = _convert(tmp_path, [time, np.cos(TIME), np.ones(1000)], "{ constant = 1 }")
    assert np.array_equal(named.recording.time, np.delete(TIME, row))
    assert [(one.code, one.severity, one.row) for one in named.findings] == [("bad_rows", "note", row + 1)]
    path = tmp_path / "log.csv"
    write_recording(make_recording(1000), path)
    lines = path.read_text().splitlines()
    first = next(n for n, line in enumerate(lines) if line.startswith("time")) + 1
    lines[first + row] = "1e6," + lines[first + row].partition(",")[2]
    path.write_text("\n".join(lines) + "\n")
    assert len(read_content(path, skip_bad_rows=True).recording) == 999


def test_a_clock_that_starts_anew_keeps_its_first_part(tmp_path: Path) -> None:
    time = np.concatenate([TIME[:600], TIME[:400]])
    named = _convert(tmp_path, [time, np.cos(TIME), np.ones(1000)], "{ constant = 1 }")
    assert np.array_equal(named.recording.time, TIME[:600])
    assert named.findings[0].severity == "error"


@pytest.mark.parametrize(("bad", "severity"), [(10, "note"), (11, "warning"), (201, "error")])
def test_many_bad_rows_are_graver_than_few(tmp_path: Path, bad: int, severity: str) -> None:
    torque = np.ones(1000)
    torque[:bad] = np.nan
    named = _convert(tmp_path, [TIME, np.cos(TIME), torque], "{ constant = 1 }")
    assert [(one.severity, len(named.recording)) for one in named.findings] == [(severity, 1000 - bad)]


def test_a_number_with_an_underscore_is_none(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time,position,torque\n0,0.1,1\n0.1,0.2,1_0\n0.2,0.3,1\n")
    assert read_content(path, skip_bad_rows=True).recording.torque.tolist() == [1.0, 1.0]


def test_the_column_that_rows_lack_a_number_in_is_named() -> None:
    time = np.arange(1000) / 100.0
    torque = np.where(np.arange(1000) % 3 == 0, np.nan, 1.0)
    kept, (finding,) = drop_bad_rows({"time": time, "position": time, "torque": torque})
    assert len(kept["time"]) == 666
    assert "torque has no number in 334 of them" in finding.message
    assert finding.severity == "error"
