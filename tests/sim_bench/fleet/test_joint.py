"""Which joints are meant by files, folders, patterns and tables."""

from pathlib import Path

import pytest

from fricomp.errors import RecordingError
from fricomp.sim_bench.fleet import FleetJoint, is_joint_table, list_joints

_PLAIN = FleetJoint("", ())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("a/elbow.csv", "b/elbow.csv", "b/knee.parquet", "b/knee_2.parquet"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text("time,position,torque\n0,0,0\n")
    return tmp_path


def test_every_recording_is_a_joint_with_a_name_of_its_own(folder: Path) -> None:
    names = [joint.name for joint in list_joints([str(folder / "a"), str(folder / "*" / "*.csv")], _PLAIN)]
    assert names == ["a-elbow", "a-elbow-2", "b-elbow"]
    assert [joint.name for joint in list_joints([str(folder / "b")], _PLAIN)] == ["elbow", "knee", "knee_2"]


def test_names_that_are_one_folder_are_told_apart(folder: Path) -> None:
    table = folder / "joints.csv"
    table.write_text(
        "name,recording\nleft/elbow,a/elbow.csv\nleft-elbow,a/elbow.csv\nb,b/knee.parquet\nb,b/knee.parquet\n"
        "b-b-2,b/knee.parquet\n"
    )
    names = [joint.name for joint in list_joints([str(table)], _PLAIN)]
    assert names == ["a-left-elbow", "a-left-elbow-2", "b-b", "b-b-2", "b-b-2-2"]


def test_a_csv_table_names_joints_with_their_simulation_and_friction(folder: Path) -> None:
    table = folder / "joints.csv"
    table.write_text(
        "# the left arm\nname, recording, simulation, joint, friction\nleft knee, b/knee.parquet;b/knee_2.parquet, "
        "robot.xml, knee_l, \n, a/elbow.csv, , , elbow.json\n"
    )
    defaults = FleetJoint("", (), simulation=Path("other.xml"))
    knee, elbow = list_joints([str(table)], defaults)
    assert knee == FleetJoint(
        "left knee", (folder / "b/knee.parquet", folder / "b/knee_2.parquet"), folder / "robot.xml", "knee_l"
    )
    assert elbow == FleetJoint("elbow", (folder / "a/elbow.csv",), Path("other.xml"), None, folder / "elbow.json")


def test_a_toml_table_says_the_same(folder: Path) -> None:
    table = folder / "joints.toml"
    table.write_text(
        '[[joint]]\nname = "knee"\nrecording = ["b/knee.parquet", "b/knee_2.parquet"]\njoint = "k"\n'
        '[[joint]]\nrecording = "a/*.csv"\n'
    )
    knee, elbow = list_joints([str(table)], _PLAIN)
    assert knee == FleetJoint("knee", (folder / "b/knee.parquet", folder / "b/knee_2.parquet"), joint="k")
    assert elbow == FleetJoint("elbow", (folder / "a/elbow.csv",))


def test_a_recording_is_no_table(folder: Path) -> None:
    assert not is_joint_table(str(folder / "a/elbow.csv"))
    assert not is_joint_table(str(folder))
    assert not is_joint_table("*.csv")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("recording,mass\na/elbow.csv,3\n", "has the column 'mass': a table of joints has name, recording"),
        ("recording\n", "has no joint"),
        ("name,recording\nknee,\n", "joint 1, names no recording"),
    ],
)
def test_a_bad_table_says_what_it_needs(folder: Path, text: str, words: str) -> None:
    table = folder / "joints.csv"
    table.write_text(text)
    with pytest.raises(RecordingError, match=words):
        list_joints([str(table)], _PLAIN)


def test_a_toml_without_joints_is_no_table(folder: Path) -> None:
    table = folder / "loop.toml"
    table.write_text("[controller]\nkp = 3\n")
    with pytest.raises(RecordingError, match=r"needs tables \[\[joint\]\]"):
        list_joints([str(table)], _PLAIN)
