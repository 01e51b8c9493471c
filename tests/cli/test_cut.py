"""`--from`, `--to` and `--joint`: the part of a log that convert, identify and diagnose take."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.cli import diagnose as diagnose_command
from fricomp.cli.main import app
from fricomp.cli.option.cut import Cut
from fricomp.errors import FricompError, ParameterError
from fricomp.recording import Recording, read_recording

RATE = 200.0


def call(*arguments: object) -> Any:
    return CliRunner().invoke(app, [*map(str, arguments)], env={"COLUMNS": "200"})


def write_log(path: Path) -> Path:
    """An elbow with friction from 10 to 40 s, and another one outside of it; a wrist that is like neither."""
    time = np.arange(0.0, 60.0, 1.0 / RATE)
    position = 1.2 * np.sin(0.7 * time) + 0.5 * np.sin(2.3 * time)
    velocity = 0.84 * np.cos(0.7 * time) + 1.15 * np.cos(2.3 * time)
    acceleration = -0.588 * np.sin(0.7 * time) - 2.645 * np.sin(2.3 * time)
    inside = (time >= 10.0) & (time < 40.0)
    noise = 0.01 * np.random.default_rng(7).standard_normal((2, time.size))
    elbow = 0.1 * acceleration + np.where(inside, 0.5, 1.5) * np.sign(velocity) + 0.2 * velocity + noise[0]
    wrist = 0.02 * acceleration + 0.3 * np.sign(velocity) + noise[1]
    columns = [time, position, elbow, position, wrist]
    names = "time,elbow.position,elbow.effort,wrist.position,wrist.effort"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=names, comments="", fmt="%.9g")
    return path


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_log(tmp_path_factory.mktemp("log") / "arm.csv")


def test_one_joint_of_a_log_is_converted_in_a_part_of_its_time(log: Path, tmp_path: Path) -> None:
    out = tmp_path / "elbow.csv"
    done = call("convert", log, "--joint", "elbow", "--from", 10, "--to", 40, "--out", out)
    assert done.exit_code == 0, done.output
    recording = read_recording(out)
    assert recording.metadata.joint == "elbow"
    assert recording.time[[0, -1]] == pytest.approx([10.0, 40.0 - 1.0 / RATE])


def test_the_friction_of_the_part_and_the_joint_that_were_asked_for_is_identified(log: Path, tmp_path: Path) -> None:
    asked = ["--joint", "elbow", "--from", 10, "--to", 40, "--law", "coulomb_viscous", "--json"]
    done = call("identify", log, *asked, "--out", tmp_path / "run")
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)["parameters"]
    assert found["coulomb.coulomb_torque"]["value"] == pytest.approx(0.5, rel=0.02)
    assert found["viscous.viscous_coefficient"]["value"] == pytest.approx(0.2, rel=0.05)


def test_the_part_and_the_joint_that_were_asked_for_are_diagnosed(
    log: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[Recording] = []

    def stop_here(paths: Any, out: Path, options: Any, given: Any, *, asked: dict[Path, Recording], **_: Any) -> None:
        seen.extend(asked[path] for path in paths)
        raise FricompError("enough")

    monkeypatch.setattr(diagnose_command, "run_diagnosis", stop_here)
    done = call("diagnose", log, "--joint", "elbow", "--from", 10, "--to", 40, "--out", tmp_path / "why")
    assert str(done.exception) == "enough", done.output
    (recording,) = seen
    assert recording.metadata.joint == "elbow"
    assert recording.duration == pytest.approx(30.0 - 1.0 / RATE)


@pytest.mark.parametrize("command", ["convert", "identify", "diagnose"])
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--from", "40", "--to", "10"], "--from 40 is not before --to 10"),
        (["--joint", "elbow", "--from", "90"], "the recording spans 0..59.995 s"),
        (["--joint", "knee"], "knee"),
    ],
)
def test_what_leaves_nothing_is_refused(
    command: str, options: list[str], words: str, log: Path, tmp_path: Path
) -> None:
    done = call(command, log, *options, "--out", tmp_path / "out.csv")
    assert isinstance(done.exception, FricompError), done.output
    assert words in str(done.exception)


def test_a_table_of_friction_has_no_time(tmp_path: Path) -> None:
    table = tmp_path / "points.csv"
    table.write_text("velocity,torque\n0.1,0.3\n0.2,0.31\n")
    done = call("identify", table, "--from", 1, "--out", tmp_path / "run")
    assert "points.csv is a table of friction" in str(done.exception)


def test_a_fleet_is_not_cut(tmp_path: Path) -> None:
    for command in (["identify"], ["diagnose", "--each"]):
        done = call(*command, "a.csv", "b.csv", "--from", 1, "--out", tmp_path / "run")
        assert isinstance(done.exception, FricompError)
        assert "--from" in str(done.exception)


def test_a_part_without_an_edge_is_everything() -> None:
    recording = Recording.from_channels({"time": [0.0, 1.0], "position": [0.0, 1.0], "torque": [0.0, 1.0]})
    assert Cut().apply(recording) is recording
    with pytest.raises(ParameterError, match="is not before"):
        Cut(2.0, 2.0)


def test_a_key_that_a_mapping_does_not_have_is_refused(log: Path, tmp_path: Path) -> None:
    mapping = tmp_path / "my.toml"
    mapping.write_text('[channels]\ntime = { column = "time" }\nposition = { column = "elbow.position", sgn = -1 }\n')
    done = call("convert", log, "--mapping", mapping, "--out", tmp_path / "out.csv")
    assert isinstance(done.exception, FricompError)
    assert "sgn" in str(done.exception)
