"""Large tables of numbers are read as fast as others read them, and give what the careful way gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration import table
from fricomp.errors import RecordingError
from fricomp.recording import number_rows
from fricomp.recording.named import source

pytest.importorskip("pyarrow")


def _write(path: Path, mark: str, *, last: str = "") -> Path:
    t = np.arange(200) * 0.01
    rows = np.column_stack([1000.0 * t, np.sin(t), np.cos(t)])
    head = "a bench\nt_ms,q_rad,tau_Nm\n".replace(",", mark)
    path.write_text(head + "\n".join(mark.join(map(repr, row)) for row in rows.tolist()) + "\n" + last)
    return path


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_it_gives_what_the_careful_way_gives(mark: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = _write(tmp_path / "log.csv", mark)
    careful = source.read_named_columns(path)
    monkeypatch.setattr(number_rows, "_LARGE", 100)
    monkeypatch.setattr(source, "read_lines", lambda _: pytest.fail("the whole text was read"))
    fast = source.read_named_columns(path)
    assert list(fast) == list(careful)
    for name, values in careful.items():
        np.testing.assert_array_equal(fast[name], values)


@pytest.mark.parametrize("last", ["x,1.0,2.0\n", "1.0,2.0\n", "1.0,2.0,3.0,4.0\n", "1.0,,2.0\n"])
def test_what_is_no_number_is_read_with_care(last: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = _write(tmp_path / "log.csv", ",", last=last)

    def read() -> dict[str, list[float]] | str:
        try:
            return {
                name: np.nan_to_num(one, nan=-1e9).tolist() for name, one in source.read_named_columns(path).items()
            }
        except RecordingError as error:
            return str(error)

    careful = read()
    monkeypatch.setattr(number_rows, "_LARGE", 100)
    assert read() == careful


@pytest.mark.parametrize("names", ['"t_s","q_rad","tau_Nm"', "t_s,q_rad,tau_Nm", '"velocity","torque","n"'])
def test_whether_a_table_holds_points_is_told_by_its_head(
    names: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "log.csv"
    t = np.arange(200) * 0.01
    rows = np.column_stack([t, np.sin(t), np.cos(t)]).tolist()
    path.write_text("\n".join([names, *(",".join(map(repr, row)) for row in rows)]) + "\n")
    monkeypatch.setattr(number_rows, "_LARGE", 100)
    monkeypatch.setattr(table, "read_lines", lambda _: pytest.fail("the whole text was read"))
    assert table.is_friction_table(path) is ("velocity" in names)
    if "velocity" in names:
        assert table.read_friction_table(path).torque == pytest.approx(np.sin(t))
