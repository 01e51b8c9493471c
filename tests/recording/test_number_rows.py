"""Large CSV files of numbers, read by pyarrow: the same as the careful reader gives, and what it leaves to that one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np
import pytest

from fricomp.calibration.table import is_friction_table, read_friction_table
from fricomp.errors import RecordingError
from fricomp.reading import watch_reading
from fricomp.recording import Recording, RecordingMetadata, RecordingWarning, csv_file, read_recording, write_recording
from fricomp.recording.mapping import Source
from fricomp.recording.named.log import separate_joints
from fricomp.recording.named.source import read_named_columns
from fricomp.recording.number_rows import read_head, read_number_rows
from fricomp.recording.sources import Columns, text

pytest.importorskip("pyarrow")

_ROWS = 40_000


def _record() -> Recording:
    random, time = np.random.default_rng(0), np.asarray(np.arange(_ROWS) * 1e-3, dtype=np.float64)
    return Recording(
        time=time,
        position=np.sin(time),
        torque=random.standard_normal(_ROWS),
        metadata=RecordingMetadata(joint="Ellbogen links ü", torque_unit="N·m"),
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    write_recording(_record(), tmp_path / "large.csv")
    assert read_head(tmp_path / "large.csv") is not None
    return tmp_path / "large.csv"


def _read_carefully(path: Path, patch: pytest.MonkeyPatch) -> Recording:
    with patch.context() as slow:
        slow.setattr(csv_file, "read_head", lambda _: None)
        return read_recording(path)


def test_a_large_file_reads_to_the_same_bits(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fast, slow = read_recording(path), _read_carefully(path, monkeypatch)
    for name, values in slow.channels.items():
        np.testing.assert_array_equal(fast.channels[name], values)
        np.testing.assert_array_equal(values, _record().channels[name])
    assert fast.metadata == slow.metadata


@pytest.mark.parametrize("line", ["# block 3: motion\n", "# a, comment\n", "\n"])
def test_comments_between_rows_are_left_out(path: Path, line: str) -> None:
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join([*lines[:900], line, *lines[900:]]), encoding="utf-8")
    np.testing.assert_array_equal(read_recording(path).torque, _record().torque)


@pytest.mark.parametrize("cell", ["", "abc", "1_0"])
def test_a_bad_cell_is_named_as_in_a_small_file(path: Path, cell: str) -> None:
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    time, _, torque = lines[20_000].split(",")
    lines[20_000] = f"{time},{cell},{torque}"
    path.write_text("".join(lines), encoding="utf-8")
    with pytest.raises(RecordingError, match=r"column '?position"):
        read_recording(path)


def test_a_file_that_was_cut_off_is_read_with_care(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-7])
    assert read_head(path) is None
    with pytest.warns(RecordingWarning, match="unfinished"):
        assert len(read_recording(path)) == _ROWS - 1


def test_a_byte_order_mark_counts(path: Path) -> None:
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    np.testing.assert_array_equal(read_recording(path).torque, _record().torque)


def test_a_large_friction_table_has_the_columns_it_needs(tmp_path: Path) -> None:
    velocity, torque = np.linspace(-2.0, 2.0, _ROWS), np.linspace(-1.0, 1.0, _ROWS)
    rows = "".join(f"run,{v!r},{t!r}\n" for v, t in zip(velocity.tolist(), torque.tolist(), strict=True))
    path = tmp_path / "points.csv"
    path.write_text(f"# joint 3\nlabel, velocity, torque\n{rows}", encoding="utf-8")
    assert is_friction_table(path)
    table = read_friction_table(path)
    np.testing.assert_array_equal(table.velocity, velocity)
    np.testing.assert_array_equal(table.torque, torque)
    assert table.normal_load is None


def test_a_row_of_a_large_table_that_is_not_finite_is_named(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    rows = [f"{v!r},{v!r}\n" for v in np.linspace(0.1, 2.0, 2 * _ROWS).tolist()]
    rows[50_000] = "nan,1.0\n"
    path.write_text("velocity,torque\n" + "".join(rows), encoding="utf-8")
    with pytest.raises(RecordingError, match="row 50001, column velocity"):
        read_friction_table(path)


def test_rows_that_are_no_numbers_are_left_to_others(path: Path) -> None:
    assert read_number_rows(path, 0, ("time", "position", "torque")) is None


def test_who_watches_is_told_how_far_a_large_file_is_read(path: Path) -> None:
    told: list[float] = []

    @contextmanager
    def watch(name: str) -> Iterator[Callable[[float], None]]:
        assert name == "large.csv"
        yield told.append

    with watch_reading(watch):
        read_recording(path)
    assert told == sorted(told)  # a bar never falls back
    assert told[-1] == 1.0
    assert len(told) > 1
    told.clear()
    read_recording(path)
    assert told == []


def _write_log(path: Path, row: str, head: str = "stamp;mode;angle;torque\n") -> Path:
    """A log of some 2 MB whose rows are as `row` says: stamp, a whole number, angle, torque."""
    random = np.random.default_rng(1)
    numbers = zip(random.standard_normal(_ROWS).tolist(), random.standard_normal(_ROWS).tolist(), strict=True)
    path.write_text(head + "".join(row.format(k=k, q=q, tau=tau) + "\n" for k, (q, tau) in enumerate(numbers)))
    return path


def _read_mapped(path: Path, source: Source, patch: pytest.MonkeyPatch, *, quickly: bool) -> Columns:
    """The columns that a mapping asks for, read by pyarrow alone, or without it."""
    with patch.context() as one:
        one.setattr(
            text, "read_lines" if quickly else "read_head", lambda _: pytest.fail("read twice") if quickly else None
        )
        return text.read_text(path, source, ("stamp", "angle", 4), skip_bad_rows=False)


@pytest.mark.parametrize(
    ("row", "source"),
    [
        ("{k}e-3,1,{q!r},{tau!r}", Source(header=True)),
        ("{k}e-3;run;{q!r};{tau!r}", Source(header=True, delimiter=";")),
        ("{k}e-3;1;{q:.9f};{tau!r}", Source(header=True, delimiter=";", decimal=".")),
        ("2026-03-05 10:11:12.{k:06d}\t1\t{q!r}\t{tau!r}", Source(header=True, delimiter="\t")),
        ("2026-03-05T10:11:12.{k:06d}+02:00,1,{q!r},{tau!r}", Source(header=True)),
    ],
)
def test_a_mapping_reads_a_large_table_to_the_same_numbers(
    row: str, source: Source, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    head = "a line of words\n" + source.delimiter.join(("stamp", "mode", "angle", "torque")) + "\n"
    path = _write_log(tmp_path / "log.csv", row, head)
    source = msgspec.structs.replace(source, skip_lines=1)
    fast = _read_mapped(path, source, monkeypatch, quickly=True)
    slow = _read_mapped(path, source, monkeypatch, quickly=False)
    for key, values in fast.items():
        np.testing.assert_allclose(values, slow[key], rtol=0.0, atol=3e-7 if key == "stamp" else 0.0)


def test_decimal_commas_of_a_large_table_are_read_as_such(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = _write_log(tmp_path / "log.csv", "{k}e-3;1;{q!r};{tau!r}")
    path.write_text(path.read_text().replace(".", ","))
    source = Source(header=True, delimiter=";")
    fast = _read_mapped(path, source, monkeypatch, quickly=True)
    slow = _read_mapped(path, source, monkeypatch, quickly=False)
    for key, values in fast.items():
        np.testing.assert_array_equal(values, slow[key])
    np.testing.assert_array_equal(read_named_columns(path)["torque"], slow[4])


@pytest.mark.parametrize(("decimal", "value"), [(".", 1234.0), (",", 1.234)])
def test_a_mapping_says_what_a_comma_of_a_large_table_is(
    decimal: Literal[".", ","], value: float, tmp_path: Path
) -> None:
    path = _write_log(tmp_path / "log.csv", "{k};1;{q!r};1,234")
    source = Source(header=True, delimiter=";", decimal=decimal)
    assert set(text.read_text(path, source, (4,), skip_bad_rows=False)[4].tolist()) == {value}


def test_a_row_of_a_large_table_that_is_commented_out_is_left_out(tmp_path: Path) -> None:
    path = _write_log(tmp_path / "log.csv", "{k},1,{q!r},{tau!r}", "stamp,mode,angle,torque\n")
    lines = path.read_text().splitlines()
    lines[300] = "#" + lines[300]
    path.write_text("\n".join([*lines, ""]))
    assert text.read_text(path, Source(header=True), ("torque",), skip_bad_rows=False)["torque"].size == _ROWS - 1


def test_columns_of_a_large_log_are_held_once(path: Path, tmp_path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    first = next(k for k, line in enumerate(lines) if not line.startswith("#"))
    rows = [f"{line},{k}" for k, line in enumerate(lines[first + 1 :])]
    named = tmp_path / "named.csv"
    named.write_text("\n".join(["time [s],joint_pos [rad],joint_torque [Nm],count", *rows, ""]), encoding="utf-8")
    columns = read_named_columns(named)
    recording = separate_joints(named, columns, {}).recordings[0]
    assert np.shares_memory(recording.position, columns["joint_pos [rad]"])
    assert np.shares_memory(recording.torque, columns["joint_torque [Nm]"])
    with pytest.raises(ValueError, match="read-only"):
        recording.position[0] = 1.0
