"""Bags of ROS 2, whole ones and strange ones: lists that disagree, other messages, definitions that nobody means."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

_JOINT_STATE = "sensor_msgs/msg/JointState"
_OTHERS = ("geometry_msgs/msg/WrenchStamped", "std_msgs/msg/Float64MultiArray", "sensor_msgs/msg/Imu")
_DEFINITIONS = (
    "float64 position\nfloat64[3] torque\nstring name\n",
    "string[7] names\nown/Part[] parts\n" + "=" * 80 + "\nMSG: own/Part\nfloat64 value\n",
    "own/Joint[] joints\n",
    "float32[<=4] q\nbool on\nuint8[] data\nint64 K=3\n",
)


@cache
def load_types() -> Any:
    """The messages of ROS 2 that everybody has."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_HUMBLE)


def _open(path: Path, storage: str) -> Any:
    from rosbags.rosbag2 import StoragePlugin, Writer

    return Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()])


def write_bag(path: Path, storage: str) -> None:
    """Write a bag with the states of one joint."""
    store = load_types()
    with _open(path, storage) as bag:
        connection = bag.add_connection("/joint_states", _JOINT_STATE, typestore=store)
        for number in range(20):
            values = np.array([0.1 * number])
            bag.write(connection, number * 10**9, _make_state(number, ["elbow"], values, values, values))


def _make_state(stamp: int, names: list[str], *values: Any) -> Any:
    store = load_types()
    time, header, state = (
        store.types[name] for name in ("builtin_interfaces/msg/Time", "std_msgs/msg/Header", _JOINT_STATE)
    )
    head = header(stamp=time(sec=stamp, nanosec=0), frame_id="")
    return store.serialize_cdr(state(head, names, *values), _JOINT_STATE)


def write_strange_bag(path: Path, rng: np.random.Generator, storage: str) -> None:
    """Write a bag whose messages are well formed and not what anybody means."""
    from rosbags.typesys import get_types_from_msg

    with _open(path, storage) as bag:
        for topic in ("/joint_states", "/joint_states", "/other", "/none")[: int(rng.integers(1, 5))]:
            kind = _JOINT_STATE if rng.random() < 0.7 else str(rng.choice([*_OTHERS, "own/msg/Joint"]))
            store = load_types()
            if kind == "own/msg/Joint":
                from rosbags.typesys import Stores, get_typestore

                store = get_typestore(Stores.EMPTY)
                store.register(get_types_from_msg(str(rng.choice(_DEFINITIONS)), kind))
            try:
                connection = bag.add_connection(topic, kind, typestore=store)
            except Exception:  # the same topic with the same type, or a definition without an end
                continue
            for number in range(int(rng.choice([0, 1, 2, 30])) if topic != "/none" else 0):
                for data in _make_messages(rng, number):
                    bag.write(connection, int(rng.choice([number * 10**7, number * 10**7, 0, 2**62])), data)


def _make_messages(rng: np.random.Generator, number: int) -> Iterator[bytes]:
    names = [str(name) for name in rng.choice(["elbow", "wrist", "", "a.b", "é"], int(rng.integers(0, 4)))]
    values = [np.full(int(rng.integers(0, 5)), rng.choice([0.1 * number, np.nan, np.inf, 1e308])) for _ in range(3)]
    data = bytes(_make_state(int(rng.choice([number, number, 0, -number])), names, *values))
    if rng.random() < 0.1:
        data = data[: int(rng.integers(0, len(data)))] + rng.bytes(int(rng.integers(0, 20)))
    yield data
