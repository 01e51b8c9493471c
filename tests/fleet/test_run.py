"""Fleets with work whose outcome is known: rows as they come, resuming, failures, dying workers."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError, RecordingError
from fricomp.fleet import FleetJoint, FleetRow, SerialExecutor, open_executor, read_rows, run_fleet
from tests.fleet.working import count_bytes, count_bytes_after_a_death, divide_by_zero

_SERIAL = (SerialExecutor(), 1)


@pytest.fixture
def joints(tmp_path: Path) -> list[FleetJoint]:
    made = []
    for number, name in enumerate(("ankle", "elbow", "knee"), start=1):
        path = tmp_path / f"{name}.csv"
        path.write_bytes(b"x" * number)
        made.append(FleetJoint(name, (path,)))
    return made


def test_every_joint_gets_a_row_and_a_folder(joints: list[FleetJoint], tmp_path: Path) -> None:
    from pyarrow import parquet

    out, seen = tmp_path / "out", list[FleetRow | None]()
    rows = run_fleet(joints, count_bytes, out, _SERIAL, settings={}, progress=seen.append)
    assert [(row["name"], row["bytes"], row["error"]) for row in rows] == [
        ("ankle", 1, ""),
        ("elbow", 2, ""),
        ("knee", 3, ""),
    ]
    assert (out / "knee" / "report.html").read_text() == "knee: [3]"
    assert parquet.read_table(out / "fleet.parquet").column("bytes").to_pylist() == [1, 2, 3]
    assert len(seen) == 3


def test_a_failure_stops_no_other_joint(joints: list[FleetJoint], tmp_path: Path) -> None:
    joints[0].recordings[0].write_bytes(b"")
    joints[1].recordings[0].unlink()
    rows = run_fleet(joints, count_bytes, tmp_path / "out", _SERIAL, settings={})
    assert [row["error"] for row in rows] == [
        "the recording is empty",
        f"cannot read {tmp_path / 'elbow.csv'}: No such file or directory",
        "",
    ]
    with ThreadPoolExecutor(1) as pool:
        unforeseen = run_fleet(
            [FleetJoint("x", joints[2].recordings)], divide_by_zero, tmp_path / "b", (pool, 1), settings={}
        )
    assert unforeseen[0]["error"].startswith("ZeroDivisionError")


def test_a_fleet_goes_on_where_it_was_and_tries_again_what_failed(joints: list[FleetJoint], tmp_path: Path) -> None:
    out, seen = tmp_path / "out", list[FleetRow | None]()
    joints[0].recordings[0].write_bytes(b"")
    run_fleet(joints[:2], count_bytes, out, _SERIAL, settings={"seed": 1})
    with pytest.raises(RecordingError, match="give --resume"):
        run_fleet(joints, count_bytes, out, _SERIAL, settings={"seed": 1})
    with pytest.raises(RecordingError, match="give another --out"):
        run_fleet(joints, count_bytes, out, _SERIAL, settings={"seed": 2}, resume=True)
    joints[0].recordings[0].write_bytes(b"xxxx")
    rows = run_fleet(joints, count_bytes, out, _SERIAL, settings={"seed": 1}, resume=True, progress=seen.append)
    assert [row["bytes"] for row in rows] == [4, 2, 3]
    assert seen.count(None) == 1  # the elbow was done


def test_what_is_finished_is_on_disk_when_a_fleet_is_stopped(joints: list[FleetJoint], tmp_path: Path) -> None:
    def stop(row: FleetRow | None) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_fleet(joints, count_bytes, tmp_path / "out", _SERIAL, settings={}, progress=stop)
    assert len(read_rows(tmp_path / "out")) == 1


def test_the_simulation_travels_with_the_joint(joints: list[FleetJoint], tmp_path: Path) -> None:
    model = tmp_path / "robot.xml"
    model.write_text("<mujoco/>")
    joint = FleetJoint("ankle", joints[0].recordings, model)
    assert run_fleet([joint], count_bytes, tmp_path / "out", _SERIAL, settings={})[0]["simulated"]


def test_an_executor_with_workers_of_its_own_takes_no_other_number() -> None:
    with pytest.raises(DiagnosisError, match="leave out --workers"), open_executor("dask://local:2", 3):
        pass


@pytest.mark.slow
def test_a_worker_process_that_dies_is_said_and_the_rest_goes_on(
    joints: list[FleetJoint], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FRICOMP_TEST_MARKER", str(tmp_path / "dead"))
    settings, out = {"seed": 1}, tmp_path / "out"
    with pytest.raises(DiagnosisError, match="a worker process died"), open_executor("processes", 2) as pool:
        run_fleet(joints, count_bytes_after_a_death, out, pool, settings=settings)
    with open_executor("processes", 2) as pool:
        rows = run_fleet(joints, count_bytes_after_a_death, out, pool, settings=settings, resume=True)
    assert [row["bytes"] for row in rows] == [1, 2, 3]


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # dask.distributed warns on its own shutdown
def test_a_killed_worker_of_a_dask_cluster_loses_no_joint(
    joints: list[FleetJoint], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setenv("FRICOMP_TEST_MARKER", str(tmp_path / "dead"))
    with open_executor("dask://local:2") as pool:
        rows = run_fleet(joints, count_bytes_after_a_death, tmp_path / "out", pool, settings={})
    assert (tmp_path / "dead").exists()
    assert [(row["bytes"], row["error"]) for row in rows] == [(1, ""), (2, ""), (3, "")]


def _of_one_name(folder: Path, content: bytes) -> FleetJoint:
    folder.mkdir()
    (folder / "elbow.csv").write_bytes(content)
    return FleetJoint("elbow", (folder / "elbow.csv",))


def test_what_was_done_from_other_files_of_the_same_name_is_done_again(tmp_path: Path) -> None:
    first, second = _of_one_name(tmp_path / "a", b"x"), _of_one_name(tmp_path / "b", b"xx")
    out, seen = tmp_path / "out", list[FleetRow | None]()
    run_fleet([first], count_bytes, out, _SERIAL, settings={})
    (again,) = run_fleet([second], count_bytes, out, _SERIAL, settings={}, resume=True)
    assert (again["bytes"], again["recordings"]) == (2, str(tmp_path / "b" / "elbow.csv"))
    assert (out / "elbow" / "report.html").read_text() == "elbow: [2]"
    second.recordings[0].write_bytes(b"yy")  # as long as before, and other samples
    run_fleet([second], count_bytes, out, _SERIAL, settings={}, resume=True, progress=seen.append)
    run_fleet([second], count_bytes, out, _SERIAL, settings={}, resume=True, progress=seen.append)
    assert [row is None for row in seen] == [False, True]


def test_a_result_of_other_files_does_not_outlive_them(tmp_path: Path) -> None:
    first, second = _of_one_name(tmp_path / "a", b"x"), _of_one_name(tmp_path / "b", b"")
    out = tmp_path / "out"
    run_fleet([first], count_bytes, out, _SERIAL, settings={})
    (out / "elbow" / "mine.txt").write_text("a note of mine")
    (failed,) = run_fleet([second], count_bytes, out, _SERIAL, settings={}, resume=True)
    assert failed["error"] == "the recording is empty"
    assert [path.name for path in (out / "elbow").iterdir()] == ["mine.txt"]


def test_a_finished_joint_stays_when_its_files_are_out_of_reach(joints: list[FleetJoint], tmp_path: Path) -> None:
    out = tmp_path / "out"
    run_fleet(joints, count_bytes, out, _SERIAL, settings={})
    joints[1].recordings[0].unlink()
    rows = run_fleet(joints, count_bytes, out, _SERIAL, settings={}, resume=True)
    assert [row["bytes"] for row in rows] == [1, 2, 3]
