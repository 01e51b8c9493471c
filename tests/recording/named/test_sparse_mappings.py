"""A mapping that is proposed for rows of one channel each is followed as it is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping
from fricomp.recording.inspection.inspection import inspect_log

from .proposed_mapping import convert_by_proposal
from .test_forms_of_printouts import POSITION, TIME, TORQUE

INSIDE = slice(1, -1)


def write_sparse(path: Path, names: str) -> Path:
    """Rows of time and position, and between them rows of time and torque."""
    rows = [names]
    for t, q, tau in zip(TIME, POSITION, TORQUE, strict=True):
        rows += [f"{t:.6f},{q:.9f},", f"{t + 1e-5:.6f},,{tau:.9f}"]
    path.write_text("\n".join(rows) + "\n")
    return path


def test_rows_of_one_channel_each_are_converted_by_the_names_that_they_are_read_by(tmp_path: Path) -> None:
    recording = convert_by_proposal(write_sparse(tmp_path / "log.csv", "t,q,tau"), tmp_path)
    assert recording.position == pytest.approx(POSITION[INSIDE.start :], abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE[INSIDE.start :], abs=0.02)


@pytest.mark.parametrize("extra", ["", "skip_bad_rows = true\n"])
def test_rows_of_one_channel_each_are_guessed_without_names(extra: str, tmp_path: Path) -> None:
    path = write_sparse(tmp_path / "log.csv", "a,b,c")
    (tmp_path / "log.toml").write_text(extra + inspect_log(path).guess)
    (found,) = convert(path, load_mapping(tmp_path / "log.toml"))
    assert len(found.recording) >= TIME.size - 2
    assert found.recording.torque[5:-5] == pytest.approx(TORQUE[6:-5], abs=0.02)


def test_a_cell_that_is_missing_in_a_table_of_whole_rows_is_told(tmp_path: Path) -> None:
    rows = [f"{t:.6f},{q:.9f},{tau:.9f}" for t, q, tau in zip(TIME, POSITION, TORQUE, strict=True)]
    rows[7] = rows[7].rpartition(",")[0] + ","
    (tmp_path / "log.csv").write_text("\n".join(["a,b,c", *rows]) + "\n")
    lines = [
        "[source]",
        "header = true",
        "[channels]",
        'time = { column = "a" }',
        'position = { column = "b" }',
        'torque = { column = "c" }',
    ]
    (tmp_path / "log.toml").write_text("\n".join(lines))
    with pytest.raises(RecordingError, match="line 9, column c"):
        convert(tmp_path / "log.csv", load_mapping(tmp_path / "log.toml"))
