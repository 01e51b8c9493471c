"""Robot logs: MCAP with JSON or protobuf messages, JointState messages in rosbag2 folders, MCAP and ROS 1 bags.

Columns of a JointState topic: `time` [s] from the header's stamp, or from the log where there is none, `log_time` [s],
and for each joint `<joint>.position`, `<joint>.velocity`, `<joint>.effort`; of other messages: their fields, and `time`
from their stamp or from the log. A mapping joins topics by time; see `topic`.
"""

import itertools
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording.mapping import Source
from fricomp.recording.quantity_word import says_asked_for
from fricomp.recording.sources.bag_guard import require_plain_files, require_small_arrays
from fricomp.recording.sources.columns import Columns, columns_of_records
from fricomp.recording.sources.protobuf_message import read_stamped_message
from fricomp.recording.sources.topic import Topic, join_topics
from fricomp.untrusted import parse_json

_LONGEST_REASON = 300
"""Characters of a foreign error that are told: some repeat the file."""
_FIRST = 100
"""Messages by which it is told what a topic holds."""
_MOST_NUMBERS = 100
"""Numbers of a message from which on it is a picture or a map."""
_JOINT_STATE = ("sensor_msgs/msg/JointState", "sensor_msgs/JointState")


def read_mcap(path: Path, source: Source) -> Columns:
    """Read an MCAP file with JSON, protobuf or ROS messages.

    Raises:
        MissingExtraError: mcap, its support of protobuf, or rosbags is not installed.
        RecordingError: The file is damaged or has no such topic.
    """
    topics = read_topics(path)
    if not topics or (source.topic and source.topic not in topics):
        return read_rosbag(path, source)
    return tabulate_topics(topics, source, path)


def tabulate_topics(topics: dict[str, Topic], source: Source, path: Path) -> Columns:
    """One table of the messages: of the topics that are asked for, joined by time, or else of all, a row each.

    Args:
        topics: As read from an MCAP file.
        source: Which of them lead and join.
        path: Of the file, for messages.

    Raises:
        RecordingError: It is not said which topic leads, or one is not there.
    """
    if source.join or source.topic:
        topic = _choose_topic(set(topics) - set(source.join), source.topic, path)
        return join_topics(topics, topic, source.join, clock=source.clock)
    return _read_in_turns(topics, source.clock)


def read_topics(path: Path) -> dict[str, Topic]:
    """The JSON and protobuf messages of an MCAP file, by topic; empty where it has none, as one of ROS has.

    Raises:
        MissingExtraError: mcap or its support of protobuf is not installed.
        RecordingError: The file is damaged.
    """
    try:
        from mcap.exceptions import McapError
        from mcap.reader import make_reader
    except ImportError as error:
        raise MissingExtraError("mcap", "convert") from error
    topics: dict[str, Topic] = {}
    decode = _Decoder()
    try:
        with path.open("rb") as stream:
            for schema, channel, message in make_reader(stream).iter_messages():
                record = decode(channel.message_encoding, schema, message.data)
                if record is not None:
                    topics.setdefault(channel.topic, Topic()).add(message.log_time * 1e-9, record)
    except (McapError, msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path} is no MCAP file that can be read: {error}") from error
    return topics


class _Decoder:
    """Records of messages; the classes of protobuf are built once for each schema."""

    def __init__(self) -> None:
        self._factory: Any = None
        self._readers: dict[int, Any] = {}

    def __call__(self, encoding: str, schema: Any, data: bytes) -> dict[str, Any] | None:
        """The fields of a message; None where it is of another encoding, or no object."""
        if encoding == "json":
            found = parse_json(data)
            return found if isinstance(found, dict) else None
        if encoding != "protobuf" or schema is None:
            return None
        if schema.id not in self._readers:
            self._readers[schema.id] = self._build_reader(encoding, schema)
        read = self._readers[schema.id]
        return None if read is None else read_stamped_message(read(data))

    def _build_reader(self, encoding: str, schema: Any) -> Any:
        if self._factory is None:
            try:
                from mcap_protobuf.decoder import DecoderFactory
            except ImportError as error:
                raise MissingExtraError("mcap_protobuf", "convert") from error
            self._factory = DecoderFactory()
        return self._factory.decoder_for(encoding, schema)


def _read_in_turns(topics: dict[str, Topic], clock: str) -> Columns:
    """The messages of all topics, a row each, as they were logged; what the others say is missing in a row."""
    rows = [
        (logged, {**record, "time": at})
        for topic in topics.values()
        for logged, at, record in zip(topic.log_time, topic.find_time(clock).tolist(), topic.records, strict=True)
    ]
    return columns_of_records([record for _, record in sorted(rows, key=lambda row: row[0])])


def read_rosbag(path: Path, source: Source) -> Columns:
    """Read the JointState messages of a bag, with the topics that the mapping joins to them.

    Raises:
        MissingExtraError: rosbags is not installed.
        RecordingError: The bag is damaged or has no such topic.
    """
    with _open_bag(path) as reader:
        states = {c.topic for c in reader.connections if c.msgtype in _JOINT_STATE}
        topic = source.topic if source.join and source.topic else _choose_topic(states, source.topic, path)
        topics = _read_messages(reader, (topic, *source.join))
    return join_topics(topics, topic, source.join, clock=source.clock)


def read_ros_topics(path: Path, is_wanted: Callable[[str, dict[str, Any]], bool]) -> dict[str, Topic]:
    """The messages of a bag by topic, where no joint states say the effort: it is then in another topic, if anywhere.

    Args:
        path: Of the bag.
        is_wanted: Whether a topic is read, by its name and its first message.

    Returns:
        Empty where joint states suffice, or no topic is wanted beside them.

    Raises:
        MissingExtraError: rosbags is not installed.
        RecordingError: The bag is damaged.
    """
    with _open_bag(path) as reader:
        states = {c.topic for c in reader.connections if c.msgtype in _JOINT_STATE}
        first = {c.topic: _read_messages(reader, (c.topic,), _FIRST) for c in reader.connections}
        if any(_says_effort(first[topic].get(topic, Topic())) for topic in states):
            return {}
        said = {name: own[name].records[0] for name, own in first.items() if name in own}
        wanted = [name for name, record in said.items() if is_wanted(name, record)]
        if not states and not wanted:  # whose columns are shown, so that one is named or looked at
            wanted = [name for name, record in said.items() if 1 < len(columns_of_records([record])) < _MOST_NUMBERS]
        return _read_messages(reader, wanted) if set(wanted) - states else {}


@contextmanager
def _open_bag(path: Path) -> Iterator[Any]:
    """A bag that is safe to read.

    Raises:
        MissingExtraError: rosbags is not installed.
        RecordingError: The bag is damaged, also where that shows while it is read.
    """
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.rosbag1 import ReaderError as Reader1Error
        from rosbags.rosbag2 import ReaderError as Reader2Error
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise MissingExtraError("rosbags", "convert") from error
    require_plain_files(path)
    try:
        bag = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
        for one in bag.readers:
            with one:
                require_small_arrays(path, (connection.msgdef.data for connection in one.connections))
        with bag as reader:
            yield reader
    except (AnyReaderError, Reader1Error, Reader2Error) as error:
        raise RecordingError(f"{path} is no bag that can be read: {str(error)[:_LONGEST_REASON]}") from error


def _read_messages(reader: Any, names: Collection[str], most: int | None = None) -> dict[str, Topic]:
    """The messages of these topics, or the first of them; a topic without any is left out."""
    topics: dict[str, Topic] = {}
    chosen = [c for c in reader.connections if c.topic in names]
    for connection, at, raw in itertools.islice(reader.messages(chosen), most) if chosen else ():
        message = reader.deserialize(raw, connection.msgtype)
        topics.setdefault(connection.topic, Topic()).add(at * 1e-9, _read_ros(message, connection, at * 1e-9))
    return topics


def _says_effort(states: Topic) -> bool:
    """Whether joint states say a torque: where a robot does not know it, it is left out, zero or no number."""
    efforts = [value for one in states.records for name, value in one.items() if name.endswith(".effort")]
    return any(np.isfinite(value) and value != 0.0 for value in efforts)


def _choose_topic(topics: set[str], wanted: str, path: Path) -> str:
    """The topic that is asked for; without a word on it the only one, beside those of what joints are asked for."""
    measured = {name for name in topics if not says_asked_for(name)}
    if not wanted and len(measured) == 1:
        return next(iter(measured))
    if wanted in topics:
        return wanted
    if wanted or len(topics) != 1:
        shown = ", ".join(sorted(topics)) or "none"
        line = f', such as topic = "{min(measured or topics)}" under [source]' if topics else ""
        raise RecordingError(f"{path}: choose the topic by 'topic' in the mapping{line}; it has {shown}")
    return next(iter(topics))


def _read_ros(message: Any, connection: Any, logged: float) -> dict[str, Any]:
    """The numbers of a ROS message: of joint states by joint, of others by field."""
    return _joint_record(message, logged) if connection.msgtype in _JOINT_STATE else dict(_list_fields(message))


def _list_fields(message: Any) -> Iterator[tuple[str, Any]]:
    """Fields of a message and of those in it; a stamp is in seconds."""
    for one in fields(message):
        value = getattr(message, one.name)
        if hasattr(value, "nanosec"):
            yield one.name, value.sec + 1e-9 * value.nanosec
        elif is_dataclass(value):
            yield one.name, dict(_list_fields(value))
        elif isinstance(value, np.ndarray):
            yield one.name, value.tolist()
        elif isinstance(value, list) and all(isinstance(entry, str) for entry in value):
            yield one.name, value  # whose the numbers beside them are
        elif isinstance(value, list) and all(map(is_dataclass, value)):
            yield one.name, [dict(_list_fields(entry)) for entry in value]
        elif isinstance(value, bool | int | float):
            yield one.name, value


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
