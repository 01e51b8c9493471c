"""Logs whose names, lists and times stand as programs print them: YAML, numpy, moteus, scopes, gnuplot, controllers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.recording import Recording, convert, load_mapping
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.inspection.mapping_text import render_mapping
from fricomp.sim_bench.studies.logs.good_log import joint_log

from .proposed_mapping import convert_by_proposal

LOG = joint_log(12.0, 125.0, 47)
TIME, POSITION, TORQUE = (np.asarray(one) for one in (LOG.time, LOG.position, LOG.torque))
assert LOG.velocity is not None
VELOCITY = np.asarray(LOG.velocity)
ROWS = np.stack([TIME, POSITION, VELOCITY, TORQUE], axis=1)
TURN = 2.0 * np.pi
Form = tuple[str, str]
"""Name of a file, and its text."""


def _rows(form: str, columns: NDArray[Any]) -> str:
    return "".join(form.format(*row) + "\n" for row in columns.tolist())


def _list(values: np.ndarray[tuple[int], np.dtype[np.float64]], mark: str = ", ") -> str:
    return mark.join(f"{one:.9g}" for one in values)


def moteus_print() -> Form:
    row = "{0:.6f} 1/{{MODE(0x000): 10, POSITION(0x001): {1:.9g}, VELOCITY(0x002): {2:.6g}, TORQUE(0x003): {3:.9g}"
    row += ", FAULT(0x00f): 0}}"
    return "m.log", _rows(row, ROWS / [1.0, TURN, TURN, 1.0])


def labview_without_times() -> Form:
    head = (
        "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\t\n\t\nChannels\t2\t\t\n"
        "Samples\t1500\t1500\t\nX_Dimension\tTime\tTime\t\nX0\t0,0E+0\t0,0E+0\t\nDelta_X\t0,008\t0,008\t\n"
        "***End_of_Header***\t\t\t\nX_Value\tAngle [deg]\tMoment [N.m]\tComment\n"
    )
    rows = _rows("\t{0:.9g}\t{1:.9g}", np.stack([np.rad2deg(POSITION), TORQUE], axis=1))
    return "m.lvm", head + rows.replace(".", ",")


def gnuplot() -> Form:
    return "g.dat", "# time (s)   joint angle (mrev)   torque (N m)\n" + _rows(
        "{0:.6f}  {1: .9e}  {2: .9e}", np.stack([TIME, 1e3 * POSITION / TURN, TORQUE], axis=1)
    )


def numpy_rows() -> Form:
    return "n.txt", "t q dq tau\n" + _rows("[{0:.6f} {1: .9f}  {2: .5f} {3: .9f}]", ROWS)


def named_lists() -> Form:
    return "v.txt", "".join(
        f"{name} = [{_list(one)}]\n" for name, one in (("t", TIME), ("q", POSITION), ("tau", TORQUE))
    )


def yaml_items() -> Form:
    return "y.yaml", "robot: x\nrows:\n" + _rows(
        "- state:\n    position: {1:.9f}\n    velocity: {2:.6f}\n  t: {0:.6f}\n  torque: {3:.9f}", ROWS
    )


def yaml_lists() -> Form:
    block = "".join(
        f"  {name}:\n" + "".join(f"  - {value:.9g}\n" for value in one)
        for name, one in (("position", POSITION), ("time", TIME), ("torque", TORQUE))
    )
    return "y.yaml", f"robot: x\nlog:\n{block}"


def yaml_lists_in_brackets() -> Form:
    columns = (("position", POSITION), ("time", TIME), ("torque", TORQUE))
    return "y.yml", "".join(f"{name}: [{_list(one, ',' + chr(10) + '  ')}]\n" for name, one in columns)


def two_rates() -> Form:
    """A scope whose second channel has every second sample, and its own times."""
    steps = range(TIME.size)
    ways = [f"{1e3 * TIME[k]:.6f};{POSITION[k]:.9f}" for k in steps]
    pushes = [f"{1e3 * TIME[2 * k]:.6f};{TORQUE[2 * k]:.9f}" if 2 * k < TIME.size else ";" for k in steps]
    return "s.csv", "Name;Angle [rad];Name;Torque [Nm]\nSampleTime[ms];8;SampleTime[ms];16\n" + "".join(
        f"{a};{b}\n" for a, b in zip(ways, pushes, strict=True)
    )


def trajectory_controller() -> Form:
    names = "desired.positions[0],actual.positions[0],error.positions[0],actual.effort[0],joint_names[0],stamp"
    columns = np.stack([POSITION + 0.01, POSITION, 0.01 + 0.0 * POSITION, TORQUE, TIME], axis=1)
    return "j.csv", names + "\n" + _rows("{0:.9f},{1:.9f},{2:.9f},{3:.9f},elbow,{4:.6f}", columns)


def process_values() -> Form:
    columns = np.stack([TIME, POSITION + 0.01, POSITION, 1.1 * TORQUE, TORQUE], axis=1)
    return "p.csv", "t,pos_sp,pos_pv,trq_sp,trq_pv\n" + _rows("{0:.6f},{1:.9f},{2:.9f},{3:.9f},{4:.9f}", columns)


def german_short_words() -> Form:
    columns = np.stack([TIME, 10800.0 / np.pi * POSITION, np.rad2deg(VELOCITY), 100.0 * TORQUE], axis=1)
    head = "Zeit;Lage Ist;Geschw. Ist;Moment Ist\n[s];[arcmin];[°/s];[Ncm]\n"
    return "z.csv", head + _rows("{0:.6f};{1:.9g};{2:.9g};{3:.9g}", columns)


def data_frame() -> Form:
    head = "        time [s]    joint angle [deg]   torque [Nm]\n"
    cells = zip(TIME, np.rad2deg(POSITION), TORQUE, strict=True)
    rows = [f"{k:<6d}  {t:.6f}  {q:.9g}  {tau:.9g}\n" for k, (t, q, tau) in enumerate(cells)]
    return "f.txt", head + "".join(rows)


def days() -> Form:
    columns = np.stack([46082.5 + TIME / 86400.0, np.rad2deg(POSITION), TORQUE], axis=1)
    rows = _rows("{0:.12f};{1:.9g};{2:.9g}", columns)
    return "e.csv", "Zeitpunkt;Winkel in Grad;Drehmoment in Nm\n" + rows.replace(".", ",")


EXACT: list[Callable[[], Form]] = [
    moteus_print, labview_without_times, gnuplot, numpy_rows, named_lists, yaml_items, yaml_lists,
    yaml_lists_in_brackets, trajectory_controller, process_values, german_short_words,
    data_frame, days,
]  # fmt: skip


def _write(folder: Path, form: Form) -> Path:
    (folder / form[0]).write_text(form[1], encoding="utf-8")
    return folder / form[0]


def _require_same(recording: Recording) -> None:
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=1e-5)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


@pytest.mark.parametrize("form", EXACT)
def test_it_is_read_as_it_was_measured(form: Callable[[], Form], tmp_path: Path) -> None:
    _require_same(read_content(_write(tmp_path, form())).recording)


def two_joints_in_turns() -> Form:
    rows = (f"{t:.6f},elbow,{q:.9f},{tau:.9f}\n{t:.6f},wrist,0.1,0.0\n" for t, q, tau in ROWS[:, [0, 1, 3]].tolist())
    return "l.csv", "t,joint,q,tau\n" + "".join(rows)


def test_the_mapping_of_joints_in_turns_reads_them_by_the_names_that_it_has(tmp_path: Path) -> None:
    path, mapping = _write(tmp_path, two_joints_in_turns()), tmp_path / "log.toml"
    seen = inspect_log(path)
    assert seen.log is not None
    mapping.write_text(render_mapping(path, seen.log), encoding="utf-8")
    elbow, _ = convert(path, load_mapping(mapping))
    _require_same(elbow.recording)


@pytest.mark.parametrize("form", [gnuplot, process_values, german_short_words, trajectory_controller])
def test_its_mapping_reads_the_same(form: Callable[[], Form], tmp_path: Path) -> None:
    _require_same(convert_by_proposal(_write(tmp_path, form()), tmp_path))


def test_channels_of_a_scope_with_two_rates_meet_at_the_times_of_the_first(tmp_path: Path) -> None:
    recording = read_content(_write(tmp_path, two_rates())).recording
    assert recording.time == pytest.approx(TIME[: len(recording)], abs=1e-5)
    assert len(recording) >= TIME.size - 2
    assert float(np.sqrt(np.mean((recording.torque - TORQUE[: len(recording)]) ** 2))) < 0.3 * float(np.std(TORQUE))
    assert recording.torque[::2] == pytest.approx(TORQUE[: len(recording) : 2], abs=1e-6)


def test_signals_of_a_simulation_at_two_rates_meet_at_the_times_of_the_longer(tmp_path: Path) -> None:
    from scipy.io import savemat

    half = {"Time": TIME[::2], "Data": np.sin(3.0 * TIME[::2])}
    savemat(tmp_path / "a.mat", {"out": {"q": {"Time": TIME, "Data": POSITION}, "tau": half}})
    recording = read_content(tmp_path / "a.mat").recording
    assert recording.position == pytest.approx(POSITION[: len(recording)], abs=1e-9)
    assert recording.torque == pytest.approx(np.sin(3.0 * recording.time), abs=1e-3)
    assert convert_by_proposal(tmp_path / "a.mat", tmp_path).position == pytest.approx(recording.position, abs=1e-9)
    assert len(recording) >= TIME.size - 2


def test_a_duty_cycle_is_no_torque_where_a_current_stands_beside_it(tmp_path: Path) -> None:
    columns = np.stack([TIME, np.rad2deg(POSITION), 0.01 * VELOCITY, 3.0 * TORQUE], axis=1)
    path = _write(
        tmp_path, ("v.csv", "t [s],pos [deg],duty,iqf [A]\n" + _rows("{0:.6f},{1:.9g},{2:.6g},{3:.9g}", columns))
    )
    recording = read_content(path).recording
    assert recording.metadata.torque_unit == "A"
    assert recording.torque == pytest.approx(3.0 * TORQUE, abs=1e-6)


def test_registers_of_a_servo_are_known_with_their_numbers_behind_them(tmp_path: Path) -> None:
    counts = np.round(np.stack([1e3 * TIME, POSITION / 1.53398e-3, TORQUE / 2.69e-3], axis=1))
    names = "Time(ms),Present Position(132),Present Current(126)\n"
    path = _write(tmp_path, ("d.csv", names + _rows("{0:.0f},{1:.0f},{2:.0f}", counts)))
    proposal = inspect_log(path).guess
    assert 'column = "Present Position(132)", scale = 0.00153398 }' in proposal
    assert 'column = "Present Current(126)", scale = 0.00269 }' in proposal


def test_a_position_that_its_name_says_is_proposed_beside_no_torque(tmp_path: Path) -> None:
    counts = np.round(np.stack([1e3 * TIME, POSITION / 1.53398e-3, np.abs(TORQUE) / 2.5e-3], axis=1))
    path = _write(tmp_path, ("f.csv", "ms,position,load\n" + _rows("{0:.0f},{1:.0f},{2:.0f}", counts)))
    assert 'position = { column = "position", scale = 6.2832/COUNTS_A_TURN }' in inspect_log(path).guess


def test_a_unit_of_the_user_behind_a_position_is_no_word_of_a_reference(tmp_path: Path) -> None:
    counts = np.round(np.stack([1e3 * TIME, POSITION / 1e-3, 100.0 * TORQUE], axis=1))
    names = "Time [ms],Position feedback [reference unit],Torque [Ncm]\n"
    with pytest.raises(RecordingError, match=r"position = \{ column = 'Position feedback \[reference unit\]', scale"):
        read_content(_write(tmp_path, ("s.csv", names + _rows("{0:.0f},{1:.0f},{2:.0f}", counts))))
