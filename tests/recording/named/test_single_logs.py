"""The log of one joint is read by the names of its columns, told, and written as a mapping that reads the same."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.cli.main import app
from fricomp.errors import RecordingError
from fricomp.recording import RecordingWarning, convert, load_mapping, read_recording
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.inspection.mapping_text import render_mapping
from fricomp.recording.named.log import read_named_log

N_ROWS, RATE = 2000, 200.0
TIME = np.arange(N_ROWS) / RATE
POSITION = 0.8 * np.sin(1.3 * TIME) + 0.2 * np.sin(4.1 * TIME)
VELOCITY = np.gradient(POSITION, TIME)
TORQUE = 0.3 * np.sign(VELOCITY) + 0.1 * VELOCITY + 0.02 * np.gradient(VELOCITY, TIME)
Columns = dict[str, np.ndarray]


def write_text(path: Path, columns: Columns, mark: str = ",", encoding: str = "utf-8") -> Path:
    rows = [mark.join(repr(value) for value in row) for row in np.stack(list(columns.values()), axis=1).tolist()]
    text = "\n".join([mark.join(columns), *(row.replace(".", ",") if mark == ";" else row for row in rows)])
    path.write_text(text + "\n", encoding=encoding)
    return path


def write_units_in_names(folder: Path) -> Path:
    columns = {"t_ms": 1e3 * TIME, "q_deg": np.rad2deg(POSITION), "tau_mNm": 1e3 * TORQUE}
    return write_text(folder / "log.csv", columns)


def write_spreadsheet(folder: Path) -> Path:
    """As a European spreadsheet saves it: UTF-16, semicolons, decimal commas."""
    columns = {"Time [s]": TIME, "Position [rad]": POSITION, "Velocity [rad/s]": VELOCITY, "Torque [Nm]": TORQUE}
    return write_text(folder / "log.csv", columns, ";", "utf-16")


def write_latin(folder: Path) -> Path:
    """A column that nobody asked for has a degree sign of one byte."""
    columns = {"time": TIME, "angle": POSITION, "effort": TORQUE, "Raum °C": np.full(N_ROWS, 21.0)}
    return write_text(folder / "log.txt", columns, "\t", "latin-1")


def write_commanded_beside(folder: Path) -> Path:
    columns = {"stamp": 1e9 * (1.7e9 + TIME), "pos_cmd": POSITION + 0.1, "pos_meas": POSITION, "torque_meas": TORQUE}
    columns["torque_cmd"] = TORQUE + 1.0
    return write_text(folder / "log.csv", {name: np.round(values, 9) for name, values in columns.items()})


def write_dates(folder: Path) -> Path:
    begin = datetime(2026, 3, 1, 12, tzinfo=UTC)
    rows = [
        f"{(begin + timedelta(seconds=float(t))).isoformat()},{q:.9g},{tau:.9g}"
        for t, q, tau in zip(TIME, POSITION, TORQUE, strict=True)
    ]
    path = folder / "log.csv"
    path.write_text("\n".join(["timestamp,position,torque_nm", *rows]))
    return path


def write_numpy(folder: Path) -> Path:
    np.savez(folder / "log.npz", t=TIME, q=POSITION, dq=VELOCITY, tau=TORQUE)
    return folder / "log.npz"


def write_json(folder: Path) -> Path:
    rows = ",".join(
        f'{{"time":{t!r},"q":{q!r},"tau":{u!r}}}' for t, q, u in np.stack([TIME, POSITION, TORQUE]).T.tolist()
    )
    (folder / "log.json").write_text(f"[{rows}]")
    return folder / "log.json"


FORMS = [
    write_units_in_names,
    write_spreadsheet,
    write_latin,
    write_commanded_beside,
    write_dates,
    write_numpy,
    write_json,
]


@pytest.mark.parametrize("write", FORMS)
@pytest.mark.filterwarnings("ignore::fricomp.recording.RecordingWarning")
def test_a_log_without_a_mapping_is_read_by_its_names(write: Callable[[Path], Path], tmp_path: Path) -> None:
    recording = read_recording(write(tmp_path))
    assert len(recording) == N_ROWS
    assert recording.time == pytest.approx(TIME, abs=1e-6)  # nanoseconds since 1970 have steps of 256 in a double
    assert recording.position == pytest.approx(POSITION, abs=1e-7)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-7)
    assert recording.metadata.torque_unit == "N·m"


@pytest.mark.parametrize("write", FORMS)
def test_the_mapping_that_is_shown_reads_the_same(write: Callable[[Path], Path], tmp_path: Path) -> None:
    path, mapping = write(tmp_path), tmp_path / "log.toml"
    seen = inspect_log(path)
    assert seen.log is not None
    mapping.write_text(render_mapping(path, seen.log), encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    for name, values in seen.log.recordings[0].channels.items():
        assert found.recording.channels[name] == pytest.approx(values, abs=3e-7), name
    assert found.recording.metadata.motion == seen.log.recordings[0].metadata.motion


@pytest.mark.parametrize("unit", ["A", "mA"])
def test_the_mapping_of_a_current_shows_the_line_that_makes_a_torque_of_it(unit: str, tmp_path: Path) -> None:
    time = np.arange(4000) * 5e-3
    position, current = np.sin(1.3 * time), 40.0 * np.cos(1.3 * time)
    rows = (f"{t:.3f},{q:.6f},{i:.5f}" for t, q, i in zip(time, position, current, strict=True))
    path = tmp_path / "log.csv"
    path.write_text("\n".join([f"time_s,position_rad,current_{unit}", *rows]))
    shown = render_mapping(path, read_named_log(path)).splitlines()
    (line,) = (one for one in shown if one.startswith("# torque ="))
    text = "\n".join(one for one in shown if not one.startswith("torque ="))
    text = text.replace(line, line.removeprefix("# ")).replace('torque_unit = "A"', 'torque_unit = "N·m"')
    mapping = tmp_path / "mapping.toml"
    mapping.write_text(text.replace("scale = 0.1", "scale = 0.25"), encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    assert found.recording.metadata.torque_unit == "N·m"
    np.testing.assert_allclose(found.recording.torque, 0.25 * current, atol=1e-4)


def test_two_joints_are_a_mapping_of_two_joints(tmp_path: Path) -> None:
    columns = {"time": TIME, "q_1": POSITION, "tau_1": TORQUE, "q_2": -POSITION, "tau_2": -TORQUE}
    path = write_text(tmp_path / "log.csv", columns)
    mapping = tmp_path / "log.toml"
    mapping.write_text(render_mapping(path, read_named_log(path)))
    first, second = convert(path, load_mapping(mapping))
    assert second.recording.position == pytest.approx(-first.recording.position)
    with pytest.raises(RecordingError, match=r"is the log of 2 joints, joint_1, joint_2: give the --simulation"):
        read_recording(path)


def test_what_was_taken_for_what_is_told(tmp_path: Path) -> None:
    with pytest.warns(RecordingWarning, match=r"time 't_ms' in ms, position 'q_deg' in deg, torque 'tau_mNm' in mNm"):
        read_recording(write_units_in_names(tmp_path))


def test_a_slide_is_linear_and_a_current_stands_in_for_the_torque(tmp_path: Path) -> None:
    slide = write_text(tmp_path / "slide.csv", {"t": TIME, "pos_mm": 1e3 * POSITION, "force_N": TORQUE})
    recording = read_content(slide).recording
    assert (recording.metadata.motion, recording.metadata.torque_unit) == ("linear", "N")
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    drive = write_text(tmp_path / "drive.csv", {"t": TIME, "pos": POSITION, "current_mA": 1e3 * TORQUE})
    assert read_content(drive).recording.metadata.torque_unit == "A"


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"t": TIME, "q": POSITION}, "does not say where the torque of a joint is: its columns are t, q"),
        ({"q": POSITION, "tau": TORQUE}, "has no column of time"),
        ({"t": TIME, "pos": POSITION, "angle": POSITION, "tau": TORQUE}, "could each be the position: choose by"),
        ({"t": TIME, "pos_counts": POSITION, "tau": TORQUE}, "'pos_counts' is in units of a device"),
        ({"t": np.zeros(N_ROWS), "q": POSITION, "tau": TORQUE}, "rows were left out"),
    ],
)
def test_what_names_do_not_say_is_asked_for(columns: Columns, message: str, tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=message):
        read_recording(write_text(tmp_path / "log.csv", columns))


def test_convert_looks_at_a_log_and_writes_the_mapping_that_it_takes(tmp_path: Path) -> None:
    path, mapping = write_units_in_names(tmp_path), tmp_path / "log.toml"
    looked = CliRunner().invoke(app, ["convert", str(path), "--inspect", "--out", str(mapping)], env={"COLUMNS": "200"})
    assert looked.exit_code == 0, looked.output
    assert "2000 samples, 9.995 s at 200 Hz" in looked.output
    out = tmp_path / "joint.csv"
    done = CliRunner().invoke(app, ["convert", str(path), "--mapping", str(mapping), "--out", str(out)])
    assert done.exit_code == 0, done.output
    assert read_recording(out).torque == pytest.approx(TORQUE, abs=1e-7)


def test_of_two_clocks_the_evener_is_taken_whatever_its_name(tmp_path: Path) -> None:
    late = np.sort(TIME + np.random.default_rng(3).exponential(0.002, N_ROWS))
    columns = {"t": late + 1e-7 * np.arange(N_ROWS), "device_time_us": 1e6 * TIME, "q": POSITION, "tau": TORQUE}
    (recording,) = read_named_log(write_text(tmp_path / "log.csv", columns)).recordings
    assert recording.time == pytest.approx(TIME, abs=1e-9)


def test_a_device_s_clock_is_taken_though_its_rows_were_received_out_of_turn(tmp_path: Path) -> None:
    received = TIME + np.random.default_rng(4).uniform(0.0, 4.0 * TIME[1], N_ROWS)
    turn = np.argsort(received)
    columns = {"time": TIME[turn], "log_time": received[turn], "q": POSITION[turn], "tau": TORQUE[turn]}
    (recording,) = read_named_log(write_text(tmp_path / "log.csv", columns)).recordings
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=1e-9)
    assert recording.position == pytest.approx(POSITION, abs=1e-7)


def test_a_joint_that_rests_beside_another_is_put_in_order_as_well(tmp_path: Path) -> None:
    turn = np.argsort(TIME + np.random.default_rng(5).uniform(0.0, 4.0 * TIME[1], N_ROWS))
    columns = {"t": TIME, "q1": POSITION, "tau1": TORQUE, "q2": np.full(N_ROWS, 0.3), "tau2": 0.1 * TORQUE}
    path = write_text(tmp_path / "log.csv", {name: values[turn] for name, values in columns.items()})
    first, second = read_named_log(path).recordings
    assert len(first) == len(second) == N_ROWS
    assert read_content(path).recording.metadata.joint == "joint_1"


def test_of_two_clocks_that_are_as_even_the_plainest_is_taken(tmp_path: Path) -> None:
    columns = {"time": TIME, "log_time": 2.0 * TIME, "q": POSITION, "tau": TORQUE}
    (recording,) = read_named_log(write_text(tmp_path / "log.csv", columns)).recordings
    assert recording.duration == pytest.approx(TIME[-1])


def test_current_and_angle_are_read_by_their_units(tmp_path: Path) -> None:
    columns = {"t_epoch_ms": 1e3 * TIME, "x_deg": np.rad2deg(POSITION), "i_mA": 1e3 * TORQUE}
    (recording,) = read_named_log(write_text(tmp_path / "log.csv", columns)).recordings
    assert recording.metadata.torque_unit == "A"
    assert recording.position == pytest.approx(POSITION)
    assert recording.torque == pytest.approx(TORQUE)


def test_columns_without_names_are_told_as_such_with_the_way_to_a_mapping(tmp_path: Path) -> None:
    np.save(tmp_path / "log.npy", np.stack([TIME, POSITION, TORQUE], axis=1))
    with pytest.raises(RecordingError, match=r"names do not say what they hold.*--inspect --out log.toml"):
        read_content(tmp_path / "log.npy")
    (tmp_path / "log.bin").write_bytes(np.stack([TIME, POSITION, TORQUE], axis=1).tobytes())
    with pytest.raises(RecordingError, match="dtype and columns under"):
        read_content(tmp_path / "log.bin")


def test_the_channel_that_a_refusal_proposes_for_lists_finds_the_joints_beside_it(tmp_path: Path) -> None:
    other = np.full(N_ROWS, 0.2)
    path = tmp_path / "log.npz"
    np.savez(
        path,
        timestamp=TIME,
        **{"observation.state": np.stack([other, POSITION], axis=1)},  # type: ignore[arg-type]
        **{"observation.effort": np.stack([0.1 * other, TORQUE], axis=1)},  # type: ignore[arg-type]
    )
    with pytest.raises(RecordingError, match=r"where the position of a joint is.*--channel position=observation.state"):
        read_content(path)
    content = read_content(path, channels={"position": "observation.state"})
    assert content.recording.torque == pytest.approx(TORQUE)


def test_stamps_of_a_coarse_clock_are_spread_or_told_with_the_rate_of_the_rows(tmp_path: Path) -> None:
    columns = {"TIME": np.floor(TIME / 0.02) * 0.02, "q": POSITION, "tau": TORQUE}
    content = read_content(write_text(tmp_path / "log.csv", columns))
    assert content.recording.sample_period == pytest.approx(1.0 / 200.0, rel=1e-2)
    columns["q"] = np.repeat(POSITION[::4], 4)[: POSITION.size]  # held as the stamps are, which the torque is not
    with pytest.raises(RecordingError, match=r"stamped as the one before.*--row-rate 200"):
        read_content(write_text(tmp_path / "log.csv", columns))


@pytest.mark.parametrize(
    ("simulated", "line"),
    [
        ((), "take one by --joint NAME, such as --joint m_2,"),
        (["elbow"], "by --match LOGGED=elbow, such as --match m_2=elbow,"),
    ],
)
def test_which_of_several_joints_is_meant_is_asked_with_the_line_to_write(
    simulated: list[str], line: str, tmp_path: Path
) -> None:
    rest = np.full(N_ROWS, 0.25)
    columns = {"time": TIME, "m_1.pos": rest, "m_1.tau": rest, "m_2.pos": POSITION, "m_2.tau": TORQUE}
    with pytest.raises(RecordingError, match="none of them clearly 'elbow'") as refused:
        read_content(write_text(tmp_path / "log.csv", columns), joint="elbow", simulated=simulated)
    assert line in str(refused.value)
