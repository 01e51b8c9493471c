"""Stamps that are held, corrupt or missing, and what the reading of a log makes of them."""

from pathlib import Path

import numpy as np
import pytest

from fricomp.cli.convert import convert
from fricomp.errors import RecordingError
from fricomp.recording import read_recording
from fricomp.recording.file import read_content
from fricomp.recording.stamps import find_rising, find_row_rate, spread_stamps

from .joint_log import joint_log


@pytest.mark.parametrize(("rate", "held"), [(1000.0, 0.01), (110.0, 0.0156)])
def test_held_stamps_are_spread_and_tell_the_rate_of_the_rows(rate: float, held: float) -> None:
    time = np.arange(4000) / rate
    stamps = np.floor(time / held + 1e-9) * held
    assert find_row_rate(stamps) == pytest.approx(rate, rel=0.01)
    assert np.std(spread_stamps(stamps) - time) < 0.1 * held


def test_stamps_that_change_once_do_not_tell_the_rate_of_the_rows(tmp_path: Path) -> None:
    time = (1.75e9 + 40.0 + np.arange(3000) / 100.0).astype(np.float32).astype(np.float64)
    assert 1 < np.unique(time).size < 4
    assert find_row_rate(time) is None
    rows = [f"{t:.1f},{np.sin(k / 50.0):.6f},{np.cos(k / 50.0):.6f}" for k, t in enumerate(time)]
    (tmp_path / "log.csv").write_text("\n".join(["timestamp,q,tau", *rows]) + "\n")
    with pytest.raises(RecordingError, match=r"which the stamps do not tell.*double precision"):
        read_content(tmp_path / "log.csv")


def test_corrupt_stamps_cost_their_own_rows_alone() -> None:
    time = 3000.0 + np.arange(1000) / 100.0
    bad = {1: -0.12, 2: 0.79, 3: 0.0, 4: 2.7e151, 5: -0.03, 6: 47.6, 400: 1e9, 700: 2999.0}
    for row, stamp in bad.items():
        time[row] = stamp
    assert sorted(np.flatnonzero(~find_rising(time)).tolist()) == sorted(bad)


def test_rows_below_a_coarse_clock_are_spread_and_told_and_row_rate_takes_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = joint_log(12.0, 500.0, 3)
    stamps = np.floor(log.time / 0.02 + 1e-9) * 0.02
    source = tmp_path / "coarse.csv"
    rows = (f"{t:.2f},{q!r},{u!r}" for t, q, u in zip(stamps, log.position.tolist(), log.torque.tolist(), strict=True))
    source.write_text("\n".join(["time,position,torque", *rows]) + "\n")
    convert(source, tmp_path / "spread.csv")
    assert "they were spread, at 500 Hz" in " ".join("".join(capsys.readouterr()).split())
    convert(source, tmp_path / "out.csv", row_rate=500.0)
    for name in ("spread.csv", "out.csv"):
        assert read_recording(tmp_path / name).sample_period == pytest.approx(2e-3, rel=1e-4)


def test_split_writes_the_parts_and_nothing_else(tmp_path: Path) -> None:
    from fricomp.recording import write_recording

    log = joint_log(20.0, 250.0, 4)
    write_recording(log.rows((log.time < 8.0) | (log.time > 12.0)), tmp_path / "log.csv")
    convert(tmp_path / "log.csv", tmp_path / "part.csv", split=True)
    written = sorted(path.name for path in tmp_path.glob("part*"))
    assert written == ["part_log_part_1.csv", "part_log_part_2.csv"]
    assert sum(len(read_recording(tmp_path / name)) for name in written) == len(read_recording(tmp_path / "log.csv"))


def _convert_text(folder: Path, text: str, source: str, time: str = 'column = "t"') -> float:
    (folder / "log.csv").write_text(text)
    (folder / "map.toml").write_text(
        f"[source]\nheader = true\n{source}\n[channels]\ntime = {{ {time} }}\n"
        'position = { column = "q" }\ntorque = { column = "u" }\n'
    )
    convert(folder / "log.csv", folder / "out.csv", str(folder / "map.toml"), force=True)
    return read_recording(folder / "out.csv").sample_period


def test_decimal_commas_are_read_where_a_comma_is_no_delimiter(tmp_path: Path) -> None:
    rows = "".join(f"{k * 0.004:.3f};{np.sin(k / 50):.6f};{0.1 * k:.2f}\n".replace(".", ",") for k in range(300))
    assert _convert_text(tmp_path, "t;q;u\n" + rows, 'delimiter = ";"') == pytest.approx(0.004)


def test_another_delimiter_is_told_by_what_the_line_looks_like(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("0,1;0,2;0,3\n" * 20)
    channels = "".join(f"{name} = {{ column = {k} }}\n" for k, name in enumerate(("time", "position", "torque"), 1))
    (tmp_path / "map.toml").write_text(f"[source]\nheader = false\n[channels]\n{channels}")
    with pytest.raises(RecordingError, match='delimiter = ";"'):
        convert(tmp_path / "log.csv", tmp_path / "out.csv", str(tmp_path / "map.toml"), force=True)


def test_another_delimiter_is_found_where_columns_are_named(tmp_path: Path) -> None:
    rows = "".join(f"{k * 0.004:.3f};{np.sin(k / 50):.6f};{0.1 * k:.2f}\n".replace(".", ",") for k in range(300))
    assert _convert_text(tmp_path, "t;q;u\n" + rows, "") == pytest.approx(0.004)


def test_a_word_among_numbers_is_told_with_its_line(tmp_path: Path) -> None:
    rows = [f"{k * 0.004:.3f},{np.sin(k / 50):.6f},{0.1 * k:.2f}" for k in range(300)]
    rows[99] = "0.396,lost,9.9"
    with pytest.raises(RecordingError, match="line 101, column q: 'lost' is no number"):
        _convert_text(tmp_path, "t,q,u\n" + "\n".join(rows), "")


def test_stamps_by_iso_8601_are_seconds(tmp_path: Path) -> None:
    stamps = (f"2024-03-01T23:59:{58 + k * 0.005:09.6f}" for k in range(300))
    rows = "".join(f"{stamp},{np.sin(k / 50):.6f},1.0\n" for k, stamp in enumerate(stamps))
    period = _convert_text(tmp_path, "t,q,u\n" + rows, "", 'column = "t", from_zero = true')
    assert period == pytest.approx(0.005, rel=1e-3)


def test_lists_of_a_parquet_table_are_read_by_number_and_by_name(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    log = joint_log(6.0, 200.0, 5)
    pairs = [[0.0, float(q)] for q in log.position]
    table = {"timestamp": log.time, "observation.state": pairs, "effort": log.torque}
    folder = tmp_path / "data" / "chunk-000"
    folder.mkdir(parents=True)
    parquet.write_table(pyarrow.table(table), folder / "episode.parquet")
    (tmp_path / "meta").mkdir()
    info = '{"features": {"observation.state": {"names": ["shoulder", "elbow"]}}}'
    (tmp_path / "meta" / "info.json").write_text(info)
    for name in ("observation.state:2", "observation.state.elbow"):
        (tmp_path / "map.toml").write_text(
            f'[channels]\ntime = {{ column = "timestamp" }}\nposition = {{ column = "{name}" }}\n'
            'torque = { column = "effort" }\n'
        )
        out = tmp_path / f"{name[-5:]}.csv"
        convert(folder / "episode.parquet", out, str(tmp_path / "map.toml"))
        np.testing.assert_allclose(read_recording(out).position, log.position)


def test_a_delay_moves_a_channel_to_where_it_acts(tmp_path: Path) -> None:
    log = joint_log(6.0, 500.0, 6)
    np.savez(tmp_path / "log.npz", t=log.time, q=log.position, u=log.torque)
    (tmp_path / "map.toml").write_text(
        '[channels]\ntime = { column = "t" }\nposition = { column = "q" }\n'
        'torque = { column = "u", delay = 0.02 }\nmotor_position = { column = "q", scale = 2.0 }\n'
    )
    convert(tmp_path / "log.npz", tmp_path / "out.csv", str(tmp_path / "map.toml"))
    moved = read_recording(tmp_path / "out.csv")
    np.testing.assert_allclose(moved.torque[10:], log.torque[:-10], atol=1e-9)
    np.testing.assert_allclose(np.asarray(moved.motor_position), 2.0 * log.position)
