"""Logs of an arm in the forms in which they come are read to the same recordings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.log import ArmLog, read_arm_log
from fricomp.errors import RecordingError
from fricomp.recording import Recording, RecordingMetadata, write_recording

from ..moving_arm import write_arm

N_ROWS, N_JOINTS = 400, 3
TIME = np.arange(N_ROWS) / 100.0
POSITION = np.stack([np.sin((j + 1) * TIME) for j in range(N_JOINTS)], axis=1)
TORQUE = np.stack([np.cos((j + 2) * TIME) for j in range(N_JOINTS)], axis=1)


def write_csv(path: Path, columns: dict[str, np.ndarray], mark: str = ",") -> Path:
    rows = np.stack(list(columns.values()), axis=1)
    text = "\n".join([mark.join(columns), *(mark.join(map(repr, row.tolist())) for row in rows)])
    path.write_text(text.replace(".", ",") if mark == ";" else text)
    return path


def number(prefix: str, values: np.ndarray, first: int = 1) -> dict[str, np.ndarray]:
    return {f"{prefix}{j}": column for j, column in enumerate(values.T, start=first)}


def write_numbered(folder: Path) -> Path:
    return write_csv(folder / "log.csv", {"time": TIME, **number("q_", POSITION), **number("tau_", TORQUE)})


def write_vendor(folder: Path) -> Path:
    """Zero-based, with commands and a torque of the model beside what was measured."""
    wanted = {**number("target_q_", POSITION + 1.0, 0), **number("target_moment_", TORQUE + 1.0, 0)}
    seen = {**number("actual_q_", POSITION, 0), **number("actual_torque_", TORQUE, 0)}
    return write_csv(folder / "robot.csv", {"timestamp": TIME + 1e4, **wanted, **seen, "safety_mode": np.ones(N_ROWS)})


def write_degrees(folder: Path) -> Path:
    """Milliseconds, degrees, semicolons and decimal commas, as a spreadsheet saves them."""
    columns = {
        "t_ms": 1e3 * TIME,
        **number("Position_deg_", np.rad2deg(POSITION)),
        **number("Torque_mNm_", 1e3 * TORQUE),
    }
    return write_csv(folder / "table.csv", columns, ";")


def write_lists(folder: Path) -> Path:
    rows = [f'{t!r},"{q.tolist()}","{tau.tolist()}"' for t, q, tau in zip(TIME.tolist(), POSITION, TORQUE, strict=True)]
    path = folder / "lists.csv"
    path.write_text("\n".join(["time,joint_positions,joint_efforts", *rows]))
    return path


def write_plotted(folder: Path) -> Path:
    columns = {"__time": TIME + 1.7e9}
    for j, name in enumerate(("base_joint", "elbow_joint", "hand_joint")):
        columns[f"/joint_states/{name}/position"] = POSITION[:, j]
        columns[f"/joint_states/{name}/effort"] = TORQUE[:, j]
    return write_csv(folder / "plot.csv", columns)


def write_parquet(folder: Path) -> Path:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    table = pyarrow.table(
        {"timestamp_ns": (1e9 * TIME).astype(np.int64), "q": POSITION.tolist(), "tau": TORQUE.tolist()}
    )
    parquet.write_table(table, folder / "log.parquet")
    return folder / "log.parquet"


def write_matlab(folder: Path) -> Path:
    from scipy.io import savemat

    savemat(folder / "log.mat", {"t": TIME, "q": POSITION, "q_des": POSITION, "tau": TORQUE})
    return folder / "log.mat"


def write_arrays(folder: Path) -> Path:
    np.savez(folder / "log.npz", time=TIME, qd=POSITION, q=POSITION, tau_measured=TORQUE, tau_feedback=2.0 * TORQUE)
    return folder / "log.npz"


def write_quantities(folder: Path) -> Path:
    """One file a quantity, numbers below each other, as `%f` prints them."""
    np.savetxt(folder / "run_time.txt", TIME)
    np.savetxt(folder / "run_positions.txt", POSITION.ravel())
    np.savetxt(folder / "run_torques.txt", TORQUE)
    return folder


def write_singles(folder: Path) -> Path:
    for j in range(N_JOINTS):
        metadata = RecordingMetadata(joint=f"joint_{j + 1}")
        write_recording(Recording(TIME, POSITION[:, j], TORQUE[:, j], metadata=metadata), folder / f"{j}.csv")
    return folder


WRITERS = (
    write_numbered,
    write_vendor,
    write_degrees,
    write_lists,
    write_plotted,
    write_parquet,
    write_matlab,
    write_arrays,
    write_quantities,
    write_singles,
)


@pytest.mark.parametrize("write", WRITERS, ids=lambda one: one.__name__)
def test_every_form_gives_the_same_recordings(tmp_path: Path, write: Callable[[Path], Path]) -> None:
    log = read_arm_log([write(tmp_path)])
    assert log.is_arm
    assert len(log.recordings) == N_JOINTS
    for j, one in enumerate(log.recordings):
        assert one.position == pytest.approx(POSITION[:, j], abs=1e-12)
        assert one.torque == pytest.approx(TORQUE[:, j], abs=1e-12)
        assert one.time - one.time[0] == pytest.approx(TIME, abs=1e-6)


def test_joints_are_called_as_the_columns_call_them(tmp_path: Path) -> None:
    def name_all(log: ArmLog) -> list[str]:
        return [one.metadata.joint for one in log.recordings]

    assert name_all(read_arm_log([write_numbered(tmp_path)])) == ["joint_1", "joint_2", "joint_3"]
    assert name_all(read_arm_log([write_vendor(tmp_path)])) == ["joint_0", "joint_1", "joint_2"]
    assert name_all(read_arm_log([write_plotted(tmp_path)])) == ["base_joint", "elbow_joint", "hand_joint"]


def test_currents_stand_for_torques_that_are_missing(tmp_path: Path) -> None:
    columns = {"time": TIME, **number("q_", POSITION), **number("current_mA_", 1e3 * TORQUE)}
    log = read_arm_log([write_csv(tmp_path / "log.csv", columns)])
    assert {one.metadata.torque_unit for one in log.recordings} == {"A"}
    assert log.recordings[1].torque == pytest.approx(TORQUE[:, 1])


def test_two_columns_that_could_be_the_torque_are_asked_about(tmp_path: Path) -> None:
    columns = {"time": TIME, **number("q_", POSITION), **number("tau_", TORQUE), **number("effort_", 2.0 * TORQUE)}
    path = write_csv(tmp_path / "log.csv", columns)
    with pytest.raises(RecordingError, match=r"'tau_1' and 'effort_1' could each be the torque .* --channel torque="):
        read_arm_log([path])
    for wanted in ("effort", "effort_{joint}"):
        assert read_arm_log([path], channels={"torque": wanted}).recordings[0].torque == pytest.approx(
            2.0 * TORQUE[:, 0]
        )


def test_rows_without_numbers_cost_only_themselves(tmp_path: Path) -> None:
    torn = TORQUE.copy()
    torn[50:60, 1] = np.nan
    columns = {"time": TIME, **number("q_", POSITION), **number("tau_", torn)}
    log = read_arm_log([write_csv(tmp_path / "log.csv", columns)])
    assert [len(one) for one in log.recordings] == [N_ROWS, N_ROWS - 10, N_ROWS]


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"a": TIME, "b": TIME}, "names do not say what they hold: a, b"),
        ({"time": TIME, "x": TIME}, "does not say where a position and a torque"),
        ({"time": TIME, **number("q_", POSITION)}, "does not say where the torque"),
        ({"1.0": TIME, "2.0": TIME}, "no line of names"),
    ],
)
def test_what_does_not_say_its_columns_is_refused(tmp_path: Path, columns: dict[str, np.ndarray], message: str) -> None:
    with pytest.raises(RecordingError, match=message):
        read_arm_log([write_csv(tmp_path / "log.csv", columns)])


def test_velocities_alone_do_not_say_where_an_arm_was(tmp_path: Path) -> None:
    path = write_csv(tmp_path / "log.csv", {"time": TIME, **number("dq_", POSITION), **number("tau_", TORQUE)})
    assert len(read_arm_log([path]).recordings) == N_JOINTS
    with pytest.raises(RecordingError, match="velocities alone do not tell where an arm was: say it by --channel pos"):
        read_arm_log([path], simulation="arm.urdf")


def write_files_of_joints(folder: Path, names: tuple[str, ...]) -> Path:
    """A recording a file whose columns are called as channels are, so that nothing in it names the joint."""
    log = folder / "log"
    log.mkdir()
    for j, name in enumerate(names):
        write_csv(log / f"{name}.csv", {"time": TIME, "position": POSITION[:, j], "torque": TORQUE[:, j]})
    return log


def test_files_that_are_called_as_joints_are_an_arm(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    log = read_arm_log([write_files_of_joints(tmp_path, ("arm_elbow", "arm_shoulder", "arm_wrist"))])
    assert not log.is_arm
    log = read_arm_log(log.files, simulation=simulation)
    assert log.is_arm
    assert [one.metadata.joint for one in log.recordings] == ["arm_elbow", "arm_shoulder", "arm_wrist"]


def test_files_that_are_called_otherwise_stay_recordings_of_one_joint(tmp_path: Path) -> None:
    log = read_arm_log([write_files_of_joints(tmp_path, ("slow", "fast"))], simulation=write_arm(tmp_path))
    assert not log.is_arm


def test_files_are_the_joints_that_the_user_says(tmp_path: Path) -> None:
    names = {"a": "shoulder", "b": "elbow"}
    log = read_arm_log([write_files_of_joints(tmp_path, ("a", "b"))], simulation=write_arm(tmp_path), names=names)
    assert log.is_arm


def test_forces_of_joints_that_turn_in_the_simulation_are_torques(tmp_path: Path) -> None:
    """A generalised force has no unit in its name; one that states N stays a force."""
    simulation = write_arm(tmp_path)
    names = ("shoulder", "elbow", "wrist")
    columns = {"t": TIME} | {f"{name}_position": q for name, q in zip(names, POSITION.T, strict=True)}
    path = write_csv(tmp_path / "log.csv", columns | {f"{n}_force": u for n, u in zip(names, TORQUE.T, strict=True)})
    log = read_arm_log([path], simulation=simulation)
    assert {(one.metadata.motion, one.metadata.torque_unit) for one in log.recordings} == {("rotary", "N·m")}
    assert any("torques in N·m" in note for note in log.notes)
    assert {one.metadata.motion for one in read_arm_log([path]).recordings} == {"linear"}
    path = write_csv(tmp_path / "N.csv", columns | {f"{n}_force_N": u for n, u in zip(names, TORQUE.T, strict=True)})
    assert {one.metadata.motion for one in read_arm_log([path], simulation=simulation).recordings} == {"linear"}


def test_tables_of_two_sides_are_one_arm_where_their_names_make_those_of_the_simulation(tmp_path: Path) -> None:
    """They were two sessions: a payload of -6.7 kg was told between a left and a right arm."""
    joint = '<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint name="{0}_j{1}"/>{2}</body>'
    arms = (joint.format(side, 1, joint.format(side, 2, joint.format(side, 3, ""))) for side in ("left", "right"))
    simulation = tmp_path / "duo.xml"
    simulation.write_text(f"<mujoco><worldbody>{''.join(arms)}</worldbody></mujoco>")
    folder = tmp_path / "log"
    folder.mkdir()
    for k, side in enumerate(("left", "right")):
        columns = {"time": TIME, **number("q", POSITION + k), **number("tau", TORQUE + k)}
        write_csv(folder / f"{side}_arm.csv", columns)
    log = read_arm_log([folder], simulation=simulation)
    (session,) = log.sessions
    assert [one.metadata.joint for one in session] == [f"{s}_joint_{k}" for s in ("left", "right") for k in (1, 2, 3)]
    assert session[4].torque == pytest.approx(TORQUE[:, 1] + 1.0)
    assert any("left_arm.csv for left" in note for note in log.notes)
    assert len(read_arm_log([folder], simulation=write_arm(tmp_path)).sessions) == 2


def test_a_table_of_each_quantity_whose_columns_are_called_as_joints_is_one_log(tmp_path: Path) -> None:
    """The positions alone were read, and refused since they say of no column what it is."""
    names = ("shoulder", "elbow", "wrist")
    late = TIME + 0.002
    for stem, time, values in (("positions_deg", TIME, np.rad2deg(POSITION)), ("torques", late, TORQUE)):
        write_csv(tmp_path / f"{stem}.csv", {"time": time, **dict(zip(names, values.T, strict=True))})
    (session,) = read_arm_log([tmp_path]).sessions
    assert [one.metadata.joint for one in session] == list(names)
    for one, position, torque in zip(session, POSITION.T, TORQUE.T, strict=True):
        assert one.position == pytest.approx(position, abs=1e-6)
        assert np.interp(late[:-1], one.time, one.torque) == pytest.approx(torque[:-1], abs=0.02)


def test_lists_and_their_names_in_a_structure_of_a_table_are_of_one_set_of_joints(tmp_path: Path) -> None:
    """They came twice, by number and by name, and were refused."""
    pa = pytest.importorskip("pyarrow")
    pytest.importorskip("pyarrow.parquet")
    names = ["elbow", "shoulder", "wrist"]
    states = [
        {"name": names, "position": q.tolist(), "effort": tau.tolist()} for q, tau in zip(POSITION, TORQUE, strict=True)
    ]
    path = tmp_path / "states.parquet"
    pa.parquet.write_table(pa.table({"time": TIME, "joint_state": pa.array(states)}), path)
    (session,) = read_arm_log([path]).sessions
    assert len(session) == 3
    for one, name, position in zip(session, names, POSITION.T, strict=True):
        assert name in one.metadata.joint
        assert one.position == pytest.approx(position)


def test_a_folder_with_a_folder_of_each_joint_is_an_arm(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    for name, q, tau in zip(("shoulder", "elbow", "wrist"), POSITION.T, TORQUE.T, strict=True):
        (tmp_path / "log" / name).mkdir(parents=True)
        write_csv(tmp_path / "log" / name / "data.csv", {"t": TIME, "pos": q, "tau": tau})
    (session,) = read_arm_log([tmp_path / "log"], simulation=simulation).sessions
    assert {one.metadata.joint for one in session} == {"shoulder", "elbow", "wrist"}
    (tmp_path / "log" / "elbow" / "again.csv").write_text((tmp_path / "log" / "elbow" / "data.csv").read_text())
    with pytest.raises(RecordingError, match="holds no log"):
        read_arm_log([tmp_path / "log"], simulation=simulation)


def test_a_folder_whose_log_lies_in_a_folder_says_which(tmp_path: Path) -> None:
    """As `fricomp cases make --arm` writes it: the simulation beside the folder `log`."""
    write_arm(tmp_path)
    (tmp_path / "log").mkdir()
    for name in ("elbow", "wrist"):
        write_csv(tmp_path / "log" / f"{name}.csv", {"t": TIME, "pos": POSITION[:, 0], "tau": TORQUE[:, 0]})
    with pytest.raises(RecordingError, match=r"holds no log: give .*log, which does"):
        read_arm_log([tmp_path])
