"""Bags with messages of other devices, of a second publisher, and without stamps."""

from pathlib import Path

import numpy as np
import pytest

from fricomp.recording import convert, load_mapping
from fricomp.recording.parts.parts import find_usable_parts

from .joint_log import joint_log

rosbags = pytest.importorskip("rosbags")
_START = 1_700_000_000.0
_MAPPING = """
[channels]
time = { column = "time", from_zero = true }
position = { column = "elbow.position" }
velocity = { column = "elbow.velocity" }
torque = { column = "elbow.effort" }
"""


def _write(folder: Path, kind: str, every: int) -> Path:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_HUMBLE)
    state, header, time = (
        types.types[name]
        for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    log = joint_log(10.0, 250.0, 9)
    assert log.velocity is not None
    target = folder / kind
    with Writer(target, version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        connection = bag.add_connection("/joint_states", state.__msgtype__, typestore=types)

        def put(at: float, stamp: float, names: list[str], *values: list[float]) -> None:
            stamped = time(sec=int(stamp), nanosec=round(stamp % 1 * 1e9) % 10**9)
            arrays = [np.array(one, dtype=np.float64) for one in values]
            message = state(header(stamped, ""), names, arrays[0], arrays[1], arrays[2])
            bag.write(connection, int(at * 1e9), types.serialize_cdr(message, state.__msgtype__))

        for k, (t, q, v, u) in enumerate(zip(log.time, log.position, log.velocity, log.torque, strict=True)):
            at = _START + float(t)
            put(at, 0.0 if kind == "no_stamp" else at, ["elbow"], [float(q)], [float(v)], [float(u)])
            if kind == "zeros" and k % every == 0:
                put(at + 9e-4, at + 9e-4, ["wrist", "elbow"], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0])
            if kind == "gripper" and k % every == 0:
                put(at + 9e-4, at + 9e-4, ["gripper"], [0.01], [0.0], [0.0])
    return target


@pytest.mark.parametrize(("kind", "every"), [("gripper", 1), ("gripper", 7), ("no_stamp", 1), ("zeros", 30)])
def test_the_rows_of_the_joint_are_what_is_left(tmp_path: Path, kind: str, every: int) -> None:
    (tmp_path / "elbow.toml").write_text(_MAPPING)
    (found,) = convert(_write(tmp_path, kind, every), load_mapping(tmp_path / "elbow.toml"))
    log = joint_log(10.0, 250.0, 9)
    kept = find_usable_parts(found.recording).kept
    assert abs(len(kept) - len(log)) < 5
    assert np.abs(np.diff(kept.position)).max() < 0.1
    if kind == "gripper":
        assert "other devices" in found.findings[0].message
