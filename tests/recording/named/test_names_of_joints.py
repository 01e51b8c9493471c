"""Whose a column is: names in lists beside numbers, names with a word of a quantity, paths, and what is asked for."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from scipy.io import savemat

from fricomp.errors import RecordingError
from fricomp.recording import RecordingWarning
from fricomp.recording.file import read_content, read_recording
from fricomp.recording.named.joints.joint_name import select_joint
from fricomp.recording.named.log import read_named_log, separate_joints
from fricomp.recording.validity import Samples

N_ROWS = 400
TIME = np.arange(N_ROWS) / 200.0
POSITION = np.stack([0.2 * np.sin(TIME), np.sin(2.0 * TIME + 1.0), 0.4 * np.cos(3.0 * TIME)], axis=1)
TORQUE = 1.7 * np.sign(np.gradient(POSITION, axis=0)) + 0.3 * POSITION
JOINTS = ["shoulder", "elbow", "wrist"]
Write = Callable[[Path], Path]


def list_records(*, turned: bool) -> list[dict[str, object]]:
    """A row a sample with lists, whose order changes from row to row where they are `turned`."""
    orders = [np.roll(np.arange(3), k % 3 if turned else 0) for k in range(N_ROWS)]
    return [
        {"t": t, "name": [JOINTS[k] for k in order], "position": q[order].tolist(), "effort": u[order].tolist()}
        for t, q, u, order in zip(TIME.tolist(), POSITION, TORQUE, orders, strict=True)
    ]


def write_json(folder: Path) -> Path:
    (folder / "log.json").write_text(json.dumps(list_records(turned=True)), encoding="utf-8")
    return folder / "log.json"


def write_parquet(folder: Path) -> Path:
    parquet.write_table(pa.Table.from_pylist(list_records(turned=True)), folder / "log.parquet")
    return folder / "log.parquet"


def write_document(folder: Path) -> Path:
    content = {"joint_names": JOINTS, "time": TIME.tolist(), "q": POSITION.T.tolist(), "tau": TORQUE.T.tolist()}
    (folder / "log.json").write_text(json.dumps(content), encoding="utf-8")
    return folder / "log.json"


def write_split_frame(folder: Path) -> Path:
    rows = [list(record.values()) for record in list_records(turned=False)]
    content = {"columns": ["t", "name", "position", "effort"], "index": list(range(N_ROWS)), "data": rows}
    (folder / "log.json").write_text(json.dumps(content), encoding="utf-8")
    return folder / "log.json"


def write_lists_in_cells(folder: Path) -> Path:
    rows = [",".join(f'"{value}"' for value in record.values()) for record in list_records(turned=True)]
    (folder / "log.csv").write_text("\n".join(["t,name,position,effort", *rows]) + "\n", encoding="utf-8")
    return folder / "log.csv"


def write_archive(folder: Path) -> Path:
    np.savez(folder / "log.npz", names=np.array(JOINTS), t=TIME, q=POSITION, tau=TORQUE)
    return folder / "log.npz"


def write_matlab(folder: Path) -> Path:
    cells = np.array(JOINTS, dtype=object)
    savemat(folder / "log.mat", {"t": TIME, "q": POSITION.T, "tau": TORQUE.T, "joint_names": cells})
    return folder / "log.mat"


def write_echoed_rows(folder: Path) -> Path:
    rows = [
        ",".join(map(str, [1750000000 + int(t), round(t % 1 * 1e9), "", *JOINTS, *q, *np.zeros(3), *u]))
        for t, q, u in zip(TIME.tolist(), POSITION, TORQUE, strict=True)
    ]
    (folder / "echo.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    return folder / "echo.csv"


def write_names_in_cells(folder: Path, head: str, *, turned: bool) -> Path:
    names = [head.format(what, k) for what in ("name", "position", "effort") for k in range(3)]
    lists = ([*one["name"], *one["position"], *one["effort"]] for one in list_records(turned=turned))  # type: ignore[misc]
    rows = [",".join(map(str, [f"{t:.3f}", *cells])) for t, cells in zip(TIME, lists, strict=True)]
    (folder / "log.csv").write_text("\n".join([",".join(["%time_s", *names]), *rows]) + "\n", encoding="utf-8")
    return folder / "log.csv"


def write_exported_panel(folder: Path) -> Path:
    return write_names_in_cells(folder, "{}[{}]", turned=True)


def write_plot_of_topic(folder: Path) -> Path:
    return write_names_in_cells(folder, "field.{}{}", turned=False)


@pytest.mark.parametrize(
    "write_log",
    [
        write_json, write_parquet, write_document, write_split_frame, write_lists_in_cells, write_archive, write_matlab,
        write_echoed_rows, write_exported_panel, write_plot_of_topic,
    ],
)  # fmt: skip
def test_lists_are_told_apart_by_the_names_beside_them(tmp_path: Path, write_log: Write) -> None:
    log = read_named_log(write_log(tmp_path))
    assert [one.metadata.joint for one in log.recordings] == JOINTS
    for k, one in enumerate(log.recordings):
        np.testing.assert_allclose(one.position, POSITION[:, k], atol=1e-9)
        np.testing.assert_allclose(one.torque, TORQUE[:, k], atol=1e-9)


def test_matrices_with_a_row_a_channel_are_turned_round(tmp_path: Path) -> None:
    np.savez(tmp_path / "log.npz", t=TIME, q=POSITION.T, tau=TORQUE.T, gains=np.ones(3))
    log = read_named_log(tmp_path / "log.npz")
    np.testing.assert_allclose(log.recordings[1].position, POSITION[:, 1])


def test_arrays_of_objects_are_left_out_and_an_archive_of_nothing_else_is_refused(tmp_path: Path) -> None:
    words = np.array(["a", {}], dtype=object)
    np.savez(tmp_path / "some.npz", facts=words, t=TIME, q=POSITION[:, 1], tau=TORQUE[:, 1])
    assert len(read_named_log(tmp_path / "some.npz").recordings) == 1
    np.savez(tmp_path / "all.npz", log=words)
    with pytest.raises(RecordingError, match="holds objects of Python alone"):
        read_named_log(tmp_path / "all.npz")


@pytest.mark.parametrize("orient", ["columns", "index", "table"])
def test_data_frames_are_read_in_each_of_their_orders(tmp_path: Path, orient: str) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"t": TIME, "q": POSITION[:, 1], "tau": TORQUE[:, 1]})
    frame.to_json(tmp_path / "log.json", orient=orient)
    found = read_named_log(tmp_path / "log.json").recordings[0]
    np.testing.assert_allclose(found.position, POSITION[:, 1], atol=1e-9)


def name_columns(*names: str) -> dict[str, Samples]:
    return {"t": TIME} | {name: np.sin((2 + k) * TIME) for k, name in enumerate(names)}


_OF_ARMS = (("q", ""), ("dq", " [rad/s]"), ("tau", ""))


@pytest.mark.parametrize(
    ("names", "joints"),
    [
        (("q_theta1", "tau_theta1", "q_theta2", "tau_theta2"), ["theta1", "theta2"]),
        (("pos_elbow", "i_elbow"), ["elbow"]),
        (("qpos_hip", "qfrc_actuator_hip"), ["hip"]),
        (("a/j0/position", "a/j0/effort", "b/j0/position", "b/j0/effort"), ["a_0", "b_0"]),
        (("AXIS_ACT[A2]", "Torque_A2"), ["A2"]),
        (("PL.FB (deg)", "IL.FB (Arms)"), ["joint"]),
    ],
)
def test_names_of_joints_are_found(tmp_path: Path, names: tuple[str, ...], joints: list[str]) -> None:
    log = separate_joints(tmp_path / "log.csv", name_columns(*names), {})
    assert [one.metadata.joint for one in log.recordings] == joints


@pytest.mark.parametrize(
    ("logged", "wanted", "found"),
    [
        (["left_arm_elbow", "left_arm_wrist"], "elbow", "left_arm_elbow"),
        (["elbow", "wrist"], "panda_elbow_joint", "elbow"),
        (["left_elbow", "right_elbow"], "elbow", None),
        (["right_elbow"], "left_elbow", None),
        (["hip"], "hip_roll", None),
        (["axis0"], "elbow", "axis0"),
        (["knee"], "elbow", None),
        (["joint_1", "joint_2"], "joint_3", None),
        (["joint_3", "joint_26"], "0x1A", "joint_26"),
    ],
)
def test_a_joint_is_taken_where_its_name_leaves_no_choice(logged: list[str], wanted: str, found: str | None) -> None:
    assert select_joint(logged, wanted) == found


def test_a_log_that_counts_from_zero_goes_with_a_simulation_that_counts_from_one() -> None:
    logged, simulated = ["joint_0", "joint_1", "joint_2"], ["joint1", "joint2", "joint3"]
    assert select_joint(logged, "joint2", simulated) == "joint_1"
    assert select_joint(logged, "joint_2") == "joint_2"


def write_columns(path: Path, names: str, *columns: Samples) -> Path:
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=names, comments="")
    return path


def test_a_log_of_another_joint_is_refused_with_the_line_that_takes_it(tmp_path: Path) -> None:
    path = write_columns(tmp_path / "log.csv", "t,knee_q,knee_tau", TIME, POSITION[:, 1], TORQUE[:, 1])
    with pytest.raises(RecordingError, match="--channel position=knee_q --channel torque=knee_tau"):
        read_content(path, joint="elbow")
    found = read_content(path, joint="elbow", channels={"position": "knee_q", "torque": "knee_tau"})
    assert found.recording.metadata.joint == "elbow"


def test_a_note_on_a_log_names_its_file_once(tmp_path: Path) -> None:
    path = write_columns(tmp_path / "log.csv", "t,knee_q,knee_tau", TIME, POSITION[:, 1], TORQUE[:, 1])
    with pytest.warns(RecordingWarning) as told:
        read_recording(path)
    assert all(str(one.message).count("log.csv") == 1 for one in told)


def test_columns_of_one_name_are_those_of_as_many_joints(tmp_path: Path) -> None:
    columns = (TIME, POSITION[:, 0], TORQUE[:, 0], POSITION[:, 1], TORQUE[:, 1])
    path = write_columns(tmp_path / "log.csv", "time,position,torque,position,torque", *columns)
    second = read_content(path, joint="joint_2").recording
    np.testing.assert_allclose(second.position, POSITION[:, 1], atol=1e-12)


def test_an_axis_that_slides_is_not_taken_to_be_metres_long(tmp_path: Path) -> None:
    path = write_columns(
        tmp_path / "log.csv", "t,LinAxis.ActualPosition,force", TIME, 80 * POSITION[:, 1], TORQUE[:, 1]
    )
    with pytest.raises(RecordingError, match="called as the position of an axis that slides, states no unit"):
        read_content(path)
    path = write_columns(tmp_path / "log.csv", "t,LinAxis.ActualPosition,force", TIME, POSITION[:, 1], TORQUE[:, 1])
    assert read_content(path).recording.metadata.motion == "linear"


def test_rows_with_held_stamps_are_spread_where_the_joint_moves_on(tmp_path: Path) -> None:
    held = np.floor(TIME * 50.0) / 50.0
    path = write_columns(tmp_path / "log.csv", "t,q_rad,tau_Nm", held, POSITION[:, 1], TORQUE[:, 1])
    content = read_content(path)
    np.testing.assert_allclose(np.diff(content.recording.time), 1.0 / 200.0, rtol=1e-3)
    assert any(finding.code == "held_stamps" for finding in content.findings)


def test_bytes_in_hexadecimal_are_told(tmp_path: Path) -> None:
    rows = "\n".join(f"{t},{k:024x}" for k, t in enumerate(TIME, start=10**20))
    (tmp_path / "log.csv").write_text(f"time,data\n{rows}\n", encoding="utf-8")
    with pytest.raises(RecordingError, match="holds bytes in hexadecimal"):
        read_content(tmp_path / "log.csv")


def test_a_position_that_goes_round_at_360_is_in_degrees_and_its_rate_with_it(tmp_path: Path) -> None:
    angle = 6.0 * TIME + POSITION[:, 1]
    turned, rate = np.mod(np.rad2deg(angle), 360.0), np.rad2deg(np.gradient(angle, TIME))
    path = write_columns(tmp_path / "log.csv", "t,q,dq,tau", TIME, turned, rate, TORQUE[:, 1])
    content = read_content(path)
    np.testing.assert_allclose(np.unwrap(content.recording.position), angle, atol=1e-6)
    np.testing.assert_allclose(content.recording.channels["velocity"], np.deg2rad(rate), atol=1e-6)
    assert any("taken to be in degrees" in finding.message for finding in content.findings)


def test_an_arm_without_units_whose_joints_would_be_turns_away_is_asked_about(tmp_path: Path) -> None:
    columns = [TIME, 40.0 + 0.0 * TIME, np.rad2deg(POSITION[:, 1]), 90.0 + 0.0 * TIME, *TORQUE.T]
    path = write_columns(tmp_path / "log.csv", "t,q_1,q_2,q_3,tau_1,tau_2,tau_3", *columns)
    with pytest.raises(RecordingError, match="states no unit and covers 11"):
        read_content(path, joint="joint_2")
    assert len(read_named_log(path, {"position": "q"}).recordings) == 3


@pytest.mark.parametrize(
    ("moved", "pulled"),
    [
        (("q_1", "q_2", "q_3"), ("motor_torque_1", "motor_torque_2", "motor_torque_3")),
        (("arm_angle1", "arm_angle2", "arm_angle3"), ("tau_m1", "tau_m2", "tau_m3")),
        (("q_A", "q_B", "q_C"), ("tau_A", "tau_B", "tau_C")),
        (("angle_A", "angle_V", "angle_X"), ("force_A", "force_V", "force_X")),
    ],
)
def test_what_names_share_or_units_write_alike_tells_whose_a_column_is(
    tmp_path: Path, moved: tuple[str, ...], pulled: tuple[str, ...]
) -> None:
    names = ["t", *moved, *pulled]
    path = tmp_path / "log.csv"
    np.savetxt(path, np.column_stack([TIME, POSITION, TORQUE]), delimiter=",", header=",".join(names), comments="")
    recordings = read_named_log(path).recordings
    assert len(recordings) == 3
    for one, q, u in zip(recordings, POSITION.T, TORQUE.T, strict=True):
        assert (one.metadata.motion, one.metadata.torque_unit) == ("rotary", "N·m")
        np.testing.assert_allclose(one.position, q)
        np.testing.assert_allclose(one.torque, u)


def test_torques_of_motors_and_gears_beside_positions_are_not_taken_for_each_other(tmp_path: Path) -> None:
    names = ["t", "q_1", "q_2", "motor_torque_1", "motor_torque_2", "gear_torque_1"]
    path = tmp_path / "log.csv"
    columns = np.column_stack([TIME, POSITION[:, :2], TORQUE])
    np.savetxt(path, columns, delimiter=",", header=",".join(names), comments="")
    with pytest.raises(RecordingError, match="does not say where the torque"):
        read_named_log(path)


@pytest.mark.parametrize(
    ("names", "joints"),
    [
        (("pos(A1)", "pos(A2)", "torque(A1)", "torque(A2)"), ["A1", "A2"]),
        (("Position[J1] [rad]", "Position[J2] [rad]", "Torque[J1] [Nm]", "Torque[J2] [Nm]"), ["joint_1", "joint_2"]),
        (
            ("left/elbow_pos (rad)", "right/elbow_pos (rad)", "left/elbow_effort", "right/elbow_effort"),
            ["left_elbow", "right_elbow"],
        ),
        (
            tuple(f"{word}_{arm}/elbow{unit}" for word, unit in _OF_ARMS for arm in ("left", "right")),
            ["left_elbow", "right_elbow"],
        ),
    ],
)
def test_axes_in_brackets_and_paths_tell_joints_apart(
    names: tuple[str, ...], joints: list[str], tmp_path: Path
) -> None:
    time = np.arange(600) / 200.0
    angles = [np.sin(time), 0.7 * np.sin(1.7 * time)]
    of_channel = (lambda q: q, lambda q: np.gradient(q, time), lambda q: 0.4 * q + 0.2)
    kinds = (0, 2) if len(names) == 4 else (0, 1, 2)
    columns = [time, *(of_channel[kind](q) for kind in kinds for q in angles)]
    path = tmp_path / "log.csv"
    head = ",".join(["time", *names])
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=head, comments="", fmt="%.9f")
    log = read_named_log(path)
    assert [one.metadata.joint for one in log.recordings] == joints
    for recording, angle in zip(log.recordings, angles, strict=True):
        assert recording.position == pytest.approx(angle, abs=1e-8)
        assert recording.torque == pytest.approx(0.4 * angle + 0.2, abs=1e-8)
