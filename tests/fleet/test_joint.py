"""Which joints are meant by files, folders, patterns and tables."""

from pathlib import Path

import pytest

from fricomp.errors import RecordingError
from fricomp.fleet import FleetJoint, is_joint_table, list_joints

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
        ("recording,recording\na/elbow.csv,b/elbow.csv\n", "has the column 'recording' twice"),
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


def test_tables_as_spreadsheets_write_them_are_read(folder: Path) -> None:
    table = folder / "joints.csv"
    table.write_text('"recording", "name"\n"a/elbow.csv","left"\n', encoding="utf-8-sig")
    assert is_joint_table(str(table))
    assert [(joint.name, joint.recordings) for joint in list_joints([str(table)], _PLAIN)] == [
        ("left", (folder / "a/elbow.csv",))
    ]
    toml = folder / "joints.toml"
    toml.write_text('[[joint]]\nrecording = "a/elbow.csv"\n', encoding="utf-8-sig")
    assert [joint.name for joint in list_joints([str(toml)], _PLAIN)] == ["elbow"]


def test_a_folder_gives_its_recordings_and_no_other_tables(folder: Path) -> None:
    (folder / "b/joints.csv").write_text("recording\nelbow.csv\n")
    for name in ("HIP.CSV", "wrist.pq", "fleet.parquet", "fleet.json", "notes.txt"):
        (folder / "b" / name).touch()
    names = [joint.name for joint in list_joints([str(folder / "b")], _PLAIN)]
    assert names == ["HIP", "elbow", "knee", "knee_2", "wrist"]
    (folder / "b/rows").mkdir()
    (folder / "b/rows/knee.parquet").touch()
    names = [joint.name for joint in list_joints([str(folder / "b/**/*.parquet")], _PLAIN)]
    assert names == ["knee", "knee_2"]


def test_a_pattern_that_matches_nothing_leaves_the_other_rows(folder: Path) -> None:
    table = folder / "joints.csv"
    table.write_text("name,recording\nhip,c/*.csv\nelbow,a/*.csv\n")
    hip, elbow = list_joints([str(table)], _PLAIN)
    assert (hip.recordings, elbow.recordings) == ((folder / "c/*.csv",), (folder / "a/elbow.csv",))


@pytest.mark.parametrize("text", ["recording = 5", "recording = [5]"])
def test_a_recording_that_is_no_path_is_refused(folder: Path, text: str) -> None:
    (folder / "joints.toml").write_text(f"[[joint]]\n{text}\n")
    with pytest.raises(RecordingError, match=r"joint 1: recording is .*5.*: give a path"):
        list_joints([str(folder / "joints.toml")], _PLAIN)


@pytest.mark.parametrize("name", ["fleet.html", "rows", "a\0b", "n" * 245])
def test_a_name_that_no_folder_can_have_is_refused(folder: Path, name: str) -> None:
    (folder / "joints.csv").write_text(f"name,recording\n{name},a/elbow.csv\n")
    with pytest.raises(RecordingError, match="no folder can be called after the joint"):
        list_joints([str(folder / "joints.csv")], _PLAIN)
