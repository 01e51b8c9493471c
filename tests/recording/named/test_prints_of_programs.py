"""Tables as R, Octave, Python and loggers of microcontrollers print them; stamps in two columns or no seconds."""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import check_recording, write_recording
from fricomp.recording.file import read_content
from fricomp.recording.intake import Intake, read_source
from fricomp.recording.named.native import is_native
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(8.0, 250.0, 5)
ROWS = list(zip(LOG.time, LOG.position, np.asarray(LOG.velocity), LOG.torque, strict=True))
DAY = datetime(2026, 3, 14, 23, 59, 57, tzinfo=UTC)


def _write(path: Path, *lines: str) -> Path:
    path.write_text("\n".join(lines) + "\n")
    return path


def _from_r(folder: Path) -> Path:
    rows = (f'"{k}" {t:.4f} {q:.6f} {v:.5f} {tau:.5f}' for k, (t, q, v, tau) in enumerate(ROWS, 1))
    return _write(folder / "log.txt", '"time" "position" "velocity" "torque"', *rows)


def _from_octave(folder: Path) -> Path:
    lines = ["# Created by Octave 8.4.0, Sat Mar 14 10:11:12 2026 UTC <jk@lab>"]
    lines += ["# name: Ts", "# type: scalar", "0.004", "", ""]
    for k, name in enumerate(("t", "q", "dq", "tau")):
        lines += [f"# name: {name}", "# type: matrix", f"# rows: {len(ROWS)}", "# columns: 1"]
        lines += [*(f" {row[k]:.7f}" for row in ROWS), "", ""]
    return _write(folder / "log.txt", *lines)


def _from_tuples(folder: Path) -> Path:
    return _write(
        folder / "log.txt",
        "time,q,dq,tau",
        *(f"({row[0]:.4f}, {row[1]:.6f}, {row[2]:.5f}, {row[3]:.5f})" for row in ROWS),
    )


def _from_numpy(folder: Path) -> Path:
    shown = (f"{t:.4f},[np.float64({q:.6f})],tensor({v:.5f}),{tau:.5f}" for t, q, v, tau in ROWS)
    return _write(folder / "log.csv", "time,q,dq,tau", *shown)


def _from_esp_idf(folder: Path) -> Path:
    rows = (f"I ({1e3 * t + 312:.0f}) motor: pos={q:.6f} vel={v:.5f} tau={tau:.5f}" for t, q, v, tau in ROWS)
    return _write(folder / "monitor.log", *rows)


def _from_ros(folder: Path) -> Path:
    rows = (f"[INFO] [{1.7e9 + t:.9f}] [node]: pos: {q:.6f} vel: {v:.5f} effort: {tau:.5f}" for t, q, v, tau in ROWS)
    return _write(folder / "node.log", *rows)


def _from_archive(folder: Path) -> Path:
    np.savez(folder / "log.npz", data=np.array(ROWS), columns=np.array(["time", "q", "dq", "tau"]))
    return folder / "log.npz"


def _in_two_columns(folder: Path) -> Path:
    stamps = [DAY + timedelta(milliseconds=round(1e3 * row[0])) for row in ROWS]
    shown = (
        f"{at:%d/%m/%Y},{at:%H:%M:%S},{at.microsecond // 1000},{q:.6f},{v:.5f},{tau:.5f}"
        for at, (_, q, v, tau) in zip(stamps, ROWS, strict=True)
    )
    return _write(folder / "log.csv", "Date,Time,ms,q,dq,tau", *shown)


def _in_one_word(folder: Path) -> Path:
    stamps = [DAY + timedelta(milliseconds=round(1e3 * row[0])) for row in ROWS]
    shown = (
        f"{at:%Y%m%d_%H%M%S_%f},{q:.6f},{v:.5f},{tau:.5f}" for at, (_, q, v, tau) in zip(stamps, ROWS, strict=True)
    )
    return _write(folder / "log.csv", "timestamp,q,dq,tau", *shown)


def _in_ms(folder: Path) -> Path:
    rows = (f"{1e3 * t:.0f},{q:.6f},{v:.5f},{tau:.5f}" for t, q, v, tau in ROWS)
    return _write(folder / "log.csv", "time,position,velocity,torque", *rows)


def _in_us_of_the_day(folder: Path) -> Path:
    rows = (f"{1.7e15 + 1e6 * t:.0f},{q:.6f},{v:.5f},{tau:.5f}" for t, q, v, tau in ROWS)
    return _write(folder / "log.csv", "time,position,velocity,torque", *rows)


@pytest.mark.parametrize(
    "write",
    [_from_r, _from_octave, _from_tuples, _from_numpy, _from_esp_idf, _from_ros, _from_archive, _in_two_columns,
     _in_one_word, _in_ms, _in_us_of_the_day],
)  # fmt: skip
def test_it_is_read_as_it_was_measured(tmp_path: Path, write: Callable[[Path], Path]) -> None:
    (named,) = read_source(write(tmp_path), Intake())
    read = named.recording
    assert len(read) == len(LOG)
    np.testing.assert_allclose(np.asarray(read.time) - read.time[0], LOG.time, atol=1e-6)
    np.testing.assert_allclose(read.position, LOG.position, atol=1e-6)
    np.testing.assert_allclose(np.asarray(read.velocity), np.asarray(LOG.velocity), atol=1e-5)
    np.testing.assert_allclose(read.torque, LOG.torque, atol=1e-5)


def test_what_this_package_writes_is_a_recording_whatever_its_stamps_are(tmp_path: Path) -> None:
    slow = LOG.with_channels(time=1e12 + 3.0 * np.arange(len(LOG)))
    for name in ("slow.csv", "slow.parquet"):
        write_recording(slow, tmp_path / name)
        assert is_native(tmp_path / name)
        np.testing.assert_array_equal(read_content(tmp_path / name).recording.time, slow.time)


def test_numbers_of_rows_are_told_with_what_to_write(tmp_path: Path) -> None:
    rows = (f"{k},{q:.6f},{tau:.5f}" for k, (_, q, _, tau) in enumerate(ROWS))
    path = _write(tmp_path / "log.csv", "time,position,torque", *rows)
    (finding,) = [one for one in check_recording(read_content(path).recording) if one.code == "time_unit"]
    assert "--row-rate" in finding.advice
    (named,) = read_source(path, Intake(row_rate=250.0))
    np.testing.assert_allclose(named.recording.time, LOG.time, atol=1e-9)


def test_rows_with_one_cell_more_that_counts_nothing_keep_their_names(tmp_path: Path) -> None:
    rows = (f"{t:.4f},{q:.6f},{tau:.5f},7.5" for t, q, _, tau in ROWS)
    with pytest.raises(RecordingError, match="cells"):
        read_source(_write(tmp_path / "log.csv", "time,position,torque", *rows), Intake())


@pytest.mark.parametrize(
    ("before", "scale"),
    [("[{:10.4f}s] ", 1.0), ("[{:.1f} ms] ", 1e3), ("({:.0f}us) can0: ", 1e6), ("{:.1f}ms: ", 1e3)],
)
def test_a_time_with_its_unit_in_front_of_the_labels_is_read(before: str, scale: float, tmp_path: Path) -> None:
    time = 0.004 * np.arange(500)
    position = np.sin(3.0 * time)
    rows = [
        f"{before.format(scale * t)}POS={q:+.6f}rad T={np.cos(3.0 * t):+.6f}Nm"
        for t, q in zip(time, position, strict=True)
    ]
    log = tmp_path / "log.txt"
    log.write_text("\n".join(rows) + "\n")
    (read,) = read_source(log, Intake())
    found = read.recording
    assert np.allclose(found.time - found.time[0], time, atol=1e-6)
    assert np.allclose(found.position, position, atol=1e-5)
