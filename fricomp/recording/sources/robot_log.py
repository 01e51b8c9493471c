"""ROS logs: JointState messages in rosbag2 folders, MCAP and ROS 1 bags, and JSON messages in MCAP.

Columns of a JointState topic: `time` [s] from the header's stamp, or from the log where there is none, `log_time` [s],
and for each joint `<joint>.position`, `<joint>.velocity`, `<joint>.effort`; of JSON messages: their fields, and `time`
from the log.
"""

from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording.mapping import Source
from fricomp.recording.sources.columns import Columns, columns_of_records
from fricomp.untrusted import parse_json

_JOINT_STATE = ("sensor_msgs/msg/JointState", "sensor_msgs/JointState")


def read_mcap(path: Path, source: Source) -> Columns:
    """Read an MCAP file with JSON or ROS messages.

    Raises:
        MissingExtraError: mcap or rosbags is not installed.
        RecordingError: The file is damaged or has no such topic.
    """
    try:
        from mcap.exceptions import McapError
        from mcap.reader import make_reader
    except ImportError as error:
        raise MissingExtraError("mcap", "convert") from error
    try:
        with path.open("rb") as stream:
            records = [
                {**fields, "time": fields.get("time", message.log_time * 1e-9)}
                for _, channel, message in make_reader(stream).iter_messages(source.topic or None)
                if channel.message_encoding == "json" and isinstance(fields := parse_json(message.data), dict)
            ]
    except (McapError, msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path} is no MCAP file that can be read: {error}") from error
    return columns_of_records(records) if records else read_rosbag(path, source)


def read_rosbag(path: Path, source: Source) -> Columns:
    """Read the JointState messages of a bag.

    Raises:
        MissingExtraError: rosbags is not installed.
        RecordingError: The bag is damaged or has no such topic.
    """
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.rosbag1 import ReaderError as Reader1Error
        from rosbags.rosbag2 import ReaderError as Reader2Error
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise MissingExtraError("rosbags", "convert") from error
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            connections = [c for c in reader.connections if c.msgtype in _JOINT_STATE]
            topic = _choose_topic({c.topic for c in connections}, source.topic, path)
            chosen = [c for c in connections if c.topic == topic]
            messages = [(at * 1e-9, reader.deserialize(raw, c.msgtype)) for c, at, raw in reader.messages(chosen)]
    except (AnyReaderError, Reader1Error, Reader2Error) as error:
        raise RecordingError(f"{path} is no bag that can be read: {error}") from error
    return columns_of_records([_joint_record(message, logged) for logged, message in messages])


def _choose_topic(topics: set[str], wanted: str, path: Path) -> str:
    if wanted in topics:
        return wanted
    if wanted or len(topics) != 1:
        shown = ", ".join(sorted(topics)) or "none"
        raise RecordingError(f"{path}: choose the JointState topic by 'topic' in the mapping; it has {shown}")
    return next(iter(topics))


def _joint_record(message: Any, logged: float) -> dict[str, float]:
    """Columns of one message; its time is that of the log [s] where nobody has stamped it."""
    stamp = message.header.stamp
    stamped = stamp.sec + stamp.nanosec * 1e-9
    record = {"time": stamped if stamped > 0.0 else logged, "log_time": logged}
    for field in ("position", "velocity", "effort"):
        values = np.asarray(getattr(message, field), dtype=np.float64)  # empty where the robot does not know it
        # dots in a joint's name stay: a flat record is not taken apart again
        record.update({f"{joint}.{field}": float(v) for joint, v in zip(message.name, values, strict=False)})
    return record
