"""Rows and clocks as others write them: stamps at an end of a line, steps of time, late rows, restarts, structures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording.file import read_content
from fricomp.recording.runs import sort_rows

from .proposed_mapping import convert_by_proposal

N_ROWS, RATE = 700, 160.0
TIME = np.arange(N_ROWS) / RATE
POSITION = 1.7 * np.sin(1.3 * TIME) + 0.2 * np.sin(5.1 * TIME + 0.4)
TORQUE = 3.4 * np.sign(np.cos(1.3 * TIME)) + 0.2 * np.cos(5.1 * TIME)
Samples = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
Write = Callable[[Path], Path]


def write(path: Path, *lines: str) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def rows_of(*columns: Samples) -> list[str]:
    return [",".join(f"{cell:.10g}" for cell in row) for row in zip(*columns, strict=True)]


def fill(form: str, scale: float = 1.0) -> list[str]:
    return [form.format(t=t, q=q * scale, u=u) for t, q, u in zip(TIME, POSITION, TORQUE, strict=True)]


def write_line_protocol(folder: Path) -> Path:
    rows = zip(TIME, POSITION, TORQUE, strict=True)
    stamp = 1_700_000_000_000_000_000
    lines = (f"joint,robot=r7 pos={q:.9g},tau={u:.9g},n=3i {stamp + round(1e9 * t)}" for t, q, u in rows)
    return write(folder / "log.lp", *lines)


def write_logger(folder: Path) -> Path:
    return write(folder / "run.log", *fill("[{t:12.5f}] INFO drive: pos={q:.8f} deg, tau={u:.8f} Nm", 180.0 / np.pi))


def write_time_of_day(folder: Path) -> Path:
    return write(folder / "run.log", *fill("11:30:{t:09.6f} -> q: {q:.8f} tau: {u:.8f}"))


def write_steps(folder: Path) -> Path:
    steps = np.diff(TIME, prepend=0.0)
    return write(folder / "log.csv", "delta_t_us,q,tau", *rows_of(1e6 * steps, POSITION, TORQUE))


def write_ruled(folder: Path) -> Path:
    above = "  T(SEC)   POS(RAD)   TRQ(NM)", "  ------   --------   -------"
    return write(folder / "log.dat", *above, *fill("{t:11.6f} {q:12.8f} {u:12.8f}"))


def write_structures(folder: Path) -> Path:
    import pyarrow as pa
    from pyarrow import parquet

    state = pa.StructArray.from_arrays([pa.array(POSITION)], ["position"])
    motor = pa.StructArray.from_arrays([pa.StructArray.from_arrays([pa.array(TORQUE)], ["torque"])], ["meas"])
    parquet.write_table(pa.table({"t": TIME, "state": state, "motor": motor}), folder / "log.parquet")
    return folder / "log.parquet"


def write_feather(folder: Path) -> Path:
    import pyarrow as pa
    from pyarrow import feather

    feather.write_feather(pa.table({"time": TIME, "position": POSITION, "torque": TORQUE}), folder / "log.feather")
    return folder / "log.feather"


def write_late_rows(folder: Path) -> Path:
    rows = rows_of(TIME, POSITION, TORQUE)
    for at in (30, 31, 200, 333, 500):
        rows[at], rows[at + 2] = rows[at + 2], rows[at]
    return write(folder / "log.csv", "t,q,tau", *rows)


def write_rows_as_json(folder: Path) -> Path:
    return write(
        folder / "log.json", *fill('{{"t": {t:.6f}, "actuators": {{"position": {q:.9f}, "torque": {u:.9f}}}}}')
    )


def write_stamps_by_any_name(folder: Path) -> Path:
    """Of two clocks since 1970 the more even one is taken."""
    seconds, late = 1.75e9 + TIME, 1.75e9 + np.round(TIME, 2) + 0.013
    rows = [
        ",".join((f"{a:.6f}", f"{b:.6f}", c)) for a, b, c in zip(late, seconds, rows_of(POSITION, TORQUE), strict=True)
    ]
    return write(folder / "log.csv", "seen_at,recorded_at,position,torque", *rows)


def write_stamps_in_us(folder: Path) -> Path:
    rows = [f"{round(1e6 * (1.75e9 + t))},{c}" for t, c in zip(TIME, rows_of(POSITION, TORQUE), strict=True)]
    return write(folder / "log.csv", "pcRxTime,position,torque", *rows)


def write_trend(folder: Path) -> Path:
    """A controller's trend: a date beside the time of day, whose milliseconds stand behind a semicolon."""
    stamps = [f"10:59:{int(t):02d};{round(1e6 * (t % 1.0)):06d}" for t in TIME]
    rows = (f"Data:,11/28/2026,{stamp},{c}" for stamp, c in zip(stamps, rows_of(POSITION, TORQUE), strict=True))
    return write(folder / "trend.csv", 'Trend Name:,"Axis_2"', "Header:,Date,Time,Axis.Position,Axis.Torque(Nm)", *rows)


FORMS: list[Write] = [
    *(write_line_protocol, write_logger, write_time_of_day, write_steps, write_ruled, write_structures, write_feather),
    *(write_late_rows, write_rows_as_json, write_stamps_by_any_name, write_stamps_in_us, write_trend),
]


@pytest.mark.parametrize("form", FORMS)
def test_it_is_read_as_it_was_measured(form: Write, tmp_path: Path) -> None:
    recording = read_content(form(tmp_path)).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=1e-5)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


@pytest.mark.parametrize("form", [write_logger, write_steps, write_ruled, write_structures, write_late_rows])
def test_its_mapping_reads_the_same(form: Write, tmp_path: Path) -> None:
    recording = convert_by_proposal(form(tmp_path), tmp_path)
    assert np.diff(recording.time) == pytest.approx(np.diff(TIME), abs=1e-5)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)


def test_a_log_with_the_names_of_channels_may_be_restarted_with_its_header(tmp_path: Path) -> None:
    half, header = N_ROWS // 2, "time,position,torque"
    later = np.where(np.arange(N_ROWS) < half, TIME, TIME - TIME[half])
    rows = rows_of(later, POSITION, TORQUE)
    path = write(tmp_path / "log.csv", header, *rows[:half], "# restarted", header, *rows[half:])
    content = read_content(path)
    assert content.recording.position == pytest.approx(POSITION)
    assert any("the clock starts again 1 time(s)" in one.message for one in content.findings)


def test_a_log_with_the_names_of_channels_may_lack_numbers(tmp_path: Path) -> None:
    rows = rows_of(TIME, POSITION, TORQUE)
    rows[44] = rows[44].rsplit(",", 1)[0] + ",n/a"
    recording = read_content(write(tmp_path / "log.csv", "time,position,torque", *rows)).recording
    assert recording.position == pytest.approx(np.delete(POSITION, 44))


def test_what_begins_far_from_zero_and_falls_is_no_time(tmp_path: Path) -> None:
    rows = rows_of(1.75e9 + 1e3 * POSITION, POSITION, TORQUE)
    with pytest.raises(RecordingError, match="has no column of time"):
        read_content(write(tmp_path / "log.csv", "counter,position,torque", *rows))


def test_lines_of_which_one_is_no_json_are_none(tmp_path: Path) -> None:
    lines = fill('{{"t": {t:.6f}, "position": {q:.9f}, "torque": {u:.9f}}}')
    with pytest.raises(RecordingError, match=r"is no JSON: .*trailing characters"):
        read_content(write(tmp_path / "log.json", *lines[:9], "{", *lines[9:]))


def test_a_recording_of_the_project_may_not(tmp_path: Path) -> None:
    rows = rows_of(TIME, POSITION, TORQUE)
    rows[44] = rows[44].rsplit(",", 1)[0] + ",n/a"
    path = write(tmp_path / "log.csv", "# fricomp.recording/1", "time,position,torque", *rows)
    with pytest.raises(RecordingError, match="row 45, column torque holds 'n/a'"):
        read_content(path)


@pytest.mark.parametrize("rate", [20.0, 160.0, 1000.0])
def test_whole_seconds_since_1970_are_seconds(rate: float, tmp_path: Path) -> None:
    stamps = np.floor(1_650_000_000.3 + np.arange(N_ROWS * 6) / rate)
    position, torque = np.tile(POSITION, 6), np.tile(TORQUE, 6)
    path = write(tmp_path / "log.csv", "unix_time,q,tau", *rows_of(stamps, position, torque))
    if np.unique(stamps).size > 100:  # as many tell how many rows come a second
        assert read_content(path).recording.sample_period == pytest.approx(1.0 / rate, rel=3e-3)
        return
    with pytest.raises(RecordingError, match=rf"convert LOG --row-rate {rate:g}\b"):
        read_content(path)


def test_a_name_that_comes_twice_is_refused_unless_the_numbers_are_the_same(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "t,pos,tau,pos", *rows_of(TIME, POSITION, TORQUE, 2.0 * POSITION))
    with pytest.raises(RecordingError, match="--channel 'position=pos#1' or --channel 'position=pos#2'"):
        read_content(path)
    second = read_content(path, channels={"position": "pos#2"}).recording
    assert second.position == pytest.approx(2.0 * POSITION)
    same = write(tmp_path / "same.csv", "t,pos,tau,pos", *rows_of(TIME, POSITION, TORQUE, POSITION))
    assert read_content(same).recording.position == pytest.approx(POSITION)


def test_a_clock_that_jitters_leaves_the_rows_in_their_order() -> None:
    stamps = TIME + np.random.default_rng(6).uniform(0.0, 3.0, N_ROWS) / RATE
    assert np.any(np.diff(stamps) < 0.0)
    channels, told = sort_rows({"time": stamps, "position": POSITION})
    assert not told
    assert np.array_equal(channels["position"], POSITION)


@pytest.mark.parametrize("suffix", [".sqlite", ".db", ".tdms"])
def test_what_is_not_read_is_called_by_its_name(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"log{suffix}"
    path.write_bytes(b"SQLite format 3\0\0")
    with pytest.raises(RecordingError, match=r"which is not read here: save it as CSV or Parquet"):
        read_content(path)


@pytest.mark.parametrize("ratio", [51.0, -120.0])
def test_a_motor_speed_beside_a_joint_angle_tells_the_gear(ratio: float, tmp_path: Path) -> None:
    speed = ratio * np.gradient(POSITION, TIME) * 30.0 / np.pi
    rows = rows_of(TIME, POSITION, speed, TORQUE / abs(ratio))
    path = write(tmp_path / "log.csv", "t,joint angle [rad],motor speed [rpm],motor torque [Nm]", *rows)
    content = read_content(path)
    told = " ".join(one.message for one in content.findings)
    assert "'motor speed [rpm]' is that of the motor, and was left out" in told
    assert float(told.split("gear_ratio = ")[1].split()[0]) == pytest.approx(ratio, rel=0.01)
    assert content.recording.velocity is None
