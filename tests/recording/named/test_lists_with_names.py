"""Lists whose entries a LeRobot data set names in its meta/info.json: one joint each, and a resting one as well."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.fleet.joint import find_recordings
from fricomp.recording.file import read_content
from fricomp.recording.intake import Intake, read_source
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

pyarrow = pytest.importorskip("pyarrow")
JOINTS = ["waist", "elbow"]
LOG = joint_log(12.0, 100.0, 4)
Table = np.ndarray[tuple[int, int], np.dtype[np.float64]]


def _beside_rest(values: object, rest: float) -> Table:
    """Entries of a joint that rests and of one that moves. Shape (n_rows, 2)."""
    return np.stack([np.full(len(LOG), rest), np.asarray(values)], axis=1)


def _write_episodes(folder: Path, lists: Mapping[str, Table], names: object) -> Path:
    """A file of two episodes, each with its own clock, as version 3 keeps them."""
    from pyarrow import parquet

    half = len(LOG) // 2
    time = np.concatenate([LOG.time[:half], LOG.time[half:] - LOG.time[half]])
    columns = {name: values.tolist() for name, values in lists.items()}
    path = folder / "data" / "chunk-000" / "file-000.parquet"
    path.parent.mkdir(parents=True)
    parquet.write_table(pyarrow.table({**columns, "timestamp": time}), path)
    (folder / "meta").mkdir()
    features = {name: {"names": names} for name in lists}
    (folder / "meta" / "info.json").write_text(json.dumps({"features": features}))
    return path


def _write_state(folder: Path) -> Path:
    lists = {
        "observation.state": _beside_rest(LOG.position, 0.4),
        "observation.velocity": _beside_rest(LOG.velocity, 0.0),
        "observation.effort": _beside_rest(LOG.torque, 0.1),
    }
    return _write_episodes(folder, lists, {"motors": JOINTS})


def test_named_entries_are_a_joint_each_and_rest_where_they_rest(tmp_path: Path) -> None:
    waist, elbow = read_named_log(_write_state(tmp_path)).recordings
    assert [waist.metadata.joint, elbow.metadata.joint] == JOINTS
    assert np.asarray(elbow.position) == pytest.approx(np.asarray(LOG.position))
    assert np.asarray(waist.position) == pytest.approx(np.full(len(LOG), 0.4))  # no integral, which begins at zero


def test_what_is_noted_of_one_joint_is_told_with_it_alone(tmp_path: Path) -> None:
    for one in read_source(_write_state(tmp_path), Intake()):
        (said,) = [str(finding) for finding in one.findings if "starts again" in str(finding)]
        assert f", {one.recording.metadata.joint}: " in said


def test_a_list_that_is_asked_for_is_found_by_the_names_of_its_entries(tmp_path: Path) -> None:
    lists = {
        "observation.state": _beside_rest(LOG.position, 0.4),
        "observation.effort": _beside_rest(LOG.torque, 0.1),
    }
    path = _write_episodes(tmp_path, lists, JOINTS)
    content = read_content(path, channels={"position": "observation.state"}, joint="elbow")
    assert np.asarray(content.recording.torque) == pytest.approx(np.asarray(LOG.torque))


def test_the_action_of_a_policy_is_what_its_joint_was_asked_for(tmp_path: Path) -> None:
    names = {"observation.state": ["elbow.pos", "elbow.effort"], "action": ["elbow.pos"]}
    state = np.stack([LOG.position, LOG.torque], axis=1)
    path = _write_episodes(tmp_path, {"observation.state": state, "action": 1.01 * state[:, :1]}, [])
    info = {"features": {name: {"names": entries} for name, entries in names.items()}}
    (tmp_path / "meta" / "info.json").write_text(json.dumps(info))
    (recording,) = read_named_log(path).recordings
    assert np.asarray(recording.channels["position_reference"]) == pytest.approx(1.01 * np.asarray(LOG.position))


def test_the_folder_of_a_data_set_is_answered_with_one_of_its_files(tmp_path: Path) -> None:
    file = _write_state(tmp_path / "set")
    with pytest.raises(RecordingError, match=f"give one of them, such as .*{file.name}"):
        read_source(tmp_path / "set", Intake())
    with pytest.raises(RecordingError, match=f"give one of them, such as .*{file.name}"):
        find_recordings([str(tmp_path / "set")])
