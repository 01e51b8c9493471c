"""Logs of several topics, of JSON, protobuf and ROS messages, joined by the time of their messages."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping
from fricomp.recording.inspection.mapping_text import render_mapping
from fricomp.recording.named.log import read_named_log
from fricomp.recording.named.source import read_named_columns
from fricomp.recording.recording import Recording

pytest.importorskip("mcap_protobuf")

_START = 1_700_000_000.0
_LATE = 0.25  # of the log behind the stamps [s]

Series = dict[str, list[tuple[float, dict[str, Any]]]]
"""Messages by topic: their stamp from the start [s], and their fields."""


def _position(t: float) -> float:
    return float(0.8 * np.sin(1.3 * t))


def _series() -> Series:
    """Positions at 200 Hz, currents at 500 Hz from 1 s on, and temperatures once a second."""
    return {
        "/state": [(k / 200.0, {"position": _position(k / 200.0)}) for k in range(2000)],
        "/drive": [(1.0 + k / 500.0, {"current": 2.0 * (1.0 + k / 500.0)}) for k in range(4000)],
        "/motor": [(float(k), {"temperature": 20.0 + k}) for k in range(11)],
    }


def _in_order(series: Series) -> Iterable[tuple[float, str, dict[str, Any]]]:
    return sorted(((at, topic, one) for topic, own in series.items() for at, one in own), key=lambda each: each[0])


def _write_json(path: Path, series: Series, *, stamped: bool = True) -> Path:
    from mcap.writer import Writer

    with path.open("wb") as stream:
        writer: Any = Writer(stream)
        writer.start()
        schema = writer.register_schema("joint", "jsonschema", b"{}")
        channels = {topic: writer.register_channel(topic, "json", schema) for topic in series}
        for at, topic, fields in _in_order(series):
            content = {"time": _START + at, **fields} if stamped else fields
            logged = round((_START + at + (_LATE if stamped else 0.0)) * 1e9)
            writer.add_message(channels[topic], logged, json.dumps(content).encode(), logged)
        writer.finish()
    return path


def _schema() -> Any:
    """Files of a package with a header, a sample of one quantity each, and a state of several joints."""
    from google.protobuf import descriptor_pb2, timestamp_pb2

    files = descriptor_pb2.FileDescriptorSet()
    timestamp_pb2.DESCRIPTOR.CopyToProto(files.file.add())
    file = files.file.add(name="robot.proto", package="robot", syntax="proto3")
    file.dependency.append("google/protobuf/timestamp.proto")
    kinds = descriptor_pb2.FieldDescriptorProto
    stamp = ".google.protobuf.Timestamp"

    def add(message: Any, name: str, kind: int, type_name: str = "", *, many: bool = False) -> None:
        label = kinds.LABEL_REPEATED if many else kinds.LABEL_OPTIONAL
        message.field.add(name=name, number=len(message.field) + 1, type=kind, label=label, type_name=type_name or None)

    header = file.message_type.add(name="Header")
    add(header, "stamp", kinds.TYPE_MESSAGE, stamp)
    add(header, "frame", kinds.TYPE_STRING)
    for name, quantity in (("State", "position"), ("Drive", "current"), ("Motor", "temperature")):
        message = file.message_type.add(name=name)
        add(message, "header", kinds.TYPE_MESSAGE, ".robot.Header")
        add(message, quantity, kinds.TYPE_DOUBLE)
    joint = file.message_type.add(name="Joint")
    add(joint, "name", kinds.TYPE_STRING)
    add(joint, "position", kinds.TYPE_FLOAT)
    add(joint, "torque", kinds.TYPE_DOUBLE)
    arm = file.message_type.add(name="Arm")
    add(arm, "at", kinds.TYPE_MESSAGE, stamp)
    add(arm, "joints", kinds.TYPE_MESSAGE, ".robot.Joint", many=True)
    flat = file.message_type.add(name="Flat")
    add(flat, "at", kinds.TYPE_MESSAGE, stamp)
    add(flat, "names", kinds.TYPE_STRING, many=True)
    add(flat, "position", kinds.TYPE_DOUBLE, many=True)
    add(flat, "torque", kinds.TYPE_DOUBLE, many=True)
    add(flat, "mode", kinds.TYPE_INT32)
    return files


def _write_protobuf(path: Path, rows: Iterable[tuple[float, str, str, Callable[[Any], None]]]) -> Path:
    """Messages of a topic, by the name of their type and by what fills them."""
    from google.protobuf import descriptor_pool, message_factory
    from mcap.writer import Writer

    files, pool = _schema(), descriptor_pool.DescriptorPool()
    for one in files.file:
        pool.Add(one)
    channels: dict[str, Any] = {}
    with path.open("wb") as stream:
        writer: Any = Writer(stream)
        writer.start()
        for at, topic, kind, fill in rows:
            if topic not in channels:
                schema = writer.register_schema(f"robot.{kind}", "protobuf", files.SerializeToString())
                channels[topic] = writer.register_channel(topic, "protobuf", schema)
            message = message_factory.GetMessageClass(pool.FindMessageTypeByName(f"robot.{kind}"))()
            fill(message)
            logged = round((_START + at + _LATE) * 1e9)
            writer.add_message(channels[topic], logged, message.SerializeToString(), logged)
        writer.finish()
    return path


def _stamp(field: Any, at: float) -> None:
    field.FromNanoseconds(round((_START + at) * 1e9))


def _write_topics_in_protobuf(path: Path, series: Series) -> Path:
    kinds = {"/state": "State", "/drive": "Drive", "/motor": "Motor"}

    def filler(at: float, fields: dict[str, Any]) -> Callable[[Any], None]:
        def fill(message: Any) -> None:
            _stamp(message.header.stamp, at)
            for name, value in fields.items():
                setattr(message, name, value)

        return fill

    rows = ((at, topic, kinds[topic], filler(at, fields)) for at, topic, fields in _in_order(series))
    return _write_protobuf(path, rows)


def _write_bag(path: Path, series: Series, storage: str, current: str = "/drive") -> Path:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_HUMBLE)
    names = ("builtin_interfaces/msg/Time", "std_msgs/msg/Header", "sensor_msgs/msg/JointState")
    time, header, state = (types.types[name] for name in names)
    is_row = isinstance(series["/drive"][0][1]["current"], list)
    temperature = types.types["sensor_msgs/msg/Temperature"]
    number = types.types["std_msgs/msg/Float64MultiArray" if is_row else "std_msgs/msg/Float64"]
    layout = types.types["std_msgs/msg/MultiArrayLayout"]([], 0)
    kinds = {"/state": state, "/drive": number, "/motor": temperature}
    with Writer(path, version=9, storage_plugin=StoragePlugin[storage]) as bag:
        called = {topic: current if topic == "/drive" else topic for topic in kinds}
        open_to = {t: bag.add_connection(called[t], kind.__msgtype__, typestore=types) for t, kind in kinds.items()}
        for at, topic, fields in _in_order(series):
            nanoseconds = round((_START + at) * 1e9)
            head = header(time(nanoseconds // 10**9, nanoseconds % 10**9), "")
            if topic == "/state":
                message = state(head, ["elbow"], np.array([fields["position"]]), np.array([]), np.array([]))
            elif topic == "/drive":  # which has no stamp, so that the log counts
                value = fields["current"]
                message = number(layout, np.array(value)) if is_row else number(value)
            else:
                message = temperature(head, fields["temperature"], 0.0)
            bag.write(open_to[topic], nanoseconds, types.serialize_cdr(message, kinds[topic].__msgtype__))
    return path


_MAPPING = """
[source]
topic = "/state"
join = ["/drive", "/motor"]
[metadata]
torque_unit = "A"
[channels]
time = {{ column = "time", from_zero = true }}
position = {{ column = "{position}" }}
torque = {{ column = "{current}" }}
temperature = {{ column = "temperature" }}
"""


def _convert(path: Path, mapping: str) -> Recording:
    place = path.with_name("mapping.toml")
    place.write_text(mapping)
    (found,) = convert(path, load_mapping(place))
    return found.recording


def _is_joined(found: Recording, *, late: float = 0.0) -> None:
    """Rows from 1 to 8.998 s, each with the current and the temperature of its instant."""
    at = np.arange(200, 1800) / 200.0
    np.testing.assert_allclose(found.time, at - at[0], atol=1e-6)
    np.testing.assert_allclose(found.position, [_position(t) for t in at], atol=1e-6)
    np.testing.assert_allclose(found.torque, 2.0 * (at + late), atol=1e-5)
    assert found.temperature is not None
    np.testing.assert_allclose(found.temperature, 20.0 + at + late, atol=1e-5)


@pytest.mark.parametrize("kind", ["json", "protobuf", "SQLITE3", "MCAP"])
def test_three_topics_are_one_table(kind: str, tmp_path: Path) -> None:
    path, series = tmp_path / "log.mcap", _series()
    if kind in ("SQLITE3", "MCAP"):
        path = _write_bag(tmp_path / "bag", series, kind)
        names = {"position": "elbow.position", "current": "data"}
    else:
        (_write_json if kind == "json" else _write_topics_in_protobuf)(path, series)
        names = {"position": "position", "current": "current"}
    _is_joined(_convert(path, _MAPPING.format(**names)))


@pytest.mark.parametrize("many", [False, True])
def test_a_current_in_a_topic_of_bare_numbers_is_that_of_the_joint_beside_it(many: bool, tmp_path: Path) -> None:
    """Joint states without efforts, and a `Float64` or a row of one number that only its topic tells from others."""
    series = _series()
    series["/drive"] = [(at, {"current": [one["current"]] if many else one["current"]}) for at, one in series["/drive"]]
    path = _write_bag(tmp_path / "bag", series, "SQLITE3", current="/elbow/motor_current")
    log = read_named_log(path)
    (found,) = log.recordings
    assert found.metadata.torque_unit == "A"
    assert found.metadata.joint == "elbow"
    np.testing.assert_allclose(found.torque, 2.0 * (found.time - found.time[0] + 1.0), atol=1e-5)
    again = _convert(path, render_mapping(path, log))
    np.testing.assert_allclose(again.torque, found.torque, atol=1e-9)


@pytest.mark.parametrize("command", ["/joint_commands", "/desired/joint_states", "/elbow/target"])
def test_of_two_topics_of_joint_states_that_which_was_measured_is_taken(command: str, tmp_path: Path) -> None:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_HUMBLE)
    state, time = types.types["sensor_msgs/msg/JointState"], types.types["builtin_interfaces/msg/Time"]
    none = np.array([])
    with Writer(tmp_path / "bag", version=9) as bag:
        topics = [bag.add_connection(name, state.__msgtype__, typestore=types) for name in ("/joint_states", command)]
        for k in range(200):
            head = types.types["std_msgs/msg/Header"](time(int(_START), 5_000_000 * k), "")
            for topic, position, effort in ((topics[0], 0.1 * k, [0.23 * k]), (topics[1], -1.0, [])):
                message = state(head, ["elbow"], np.array([position]), none, np.array(effort))
                bag.write(topic, 5_000_000 * k, types.serialize_cdr(message, state.__msgtype__))
    (found,) = read_named_log(tmp_path / "bag").recordings
    np.testing.assert_allclose(found.torque, 2.3 * np.asarray(found.position), atol=1e-9)


def test_a_row_of_bare_numbers_is_asked_about_with_what_to_write(tmp_path: Path) -> None:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_HUMBLE)
    row, layout = types.types["std_msgs/msg/Float64MultiArray"], types.types["std_msgs/msg/MultiArrayLayout"]([], 0)
    with Writer(tmp_path / "bag", version=9) as bag:
        topic = bag.add_connection("/motor_log", row.__msgtype__, typestore=types)
        for k in range(200):
            message = row(layout, np.array([0.01 * k, 1.0, 0.023 * k]))
            bag.write(topic, 5_000_000 * k, types.serialize_cdr(message, row.__msgtype__))
    with pytest.raises(RecordingError, match=r"data\.3, time.* --channel position=NAME --channel torque=NAME"):
        read_named_log(tmp_path / "bag")
    (found,) = read_named_log(tmp_path / "bag", {"position": "data.1", "torque": "data.3"}).recordings
    np.testing.assert_allclose(found.torque, 2.3 * np.asarray(found.position))


def test_names_of_joints_hold_for_the_lists_of_messages_within_and_objects_say_their_own(tmp_path: Path) -> None:
    nested = {"joint_names": ["hip", "knee"], "feedback": {"positions": [0.0, 1.0], "effort": [2.0, 3.0]}}
    objects = {"joints": [{"name": "knee", "position": 1.0, "effort": 3.0}, {"name": "hip", "position": 0.0}]}
    columns = read_named_columns(_write_json(tmp_path / "a.mcap", {"/a": [(0.1 * k, nested) for k in range(9)]}))
    assert set(columns["feedback.knee.effort"]) == {3.0}
    columns = read_named_columns(_write_json(tmp_path / "b.mcap", {"/a": [(0.1 * k, objects) for k in range(9)]}))
    assert set(columns["joints.knee.position"]) == {1.0}
    assert set(columns["joints.hip.position"]) == {0.0}


def test_without_stamps_and_on_request_the_log_joins_them(tmp_path: Path) -> None:
    names = {"position": "position", "current": "current"}
    _is_joined(_convert(_write_json(tmp_path / "a.mcap", _series(), stamped=False), _MAPPING.format(**names)))
    late = {topic: [(at + 0.1 * (topic != "/state"), one) for at, one in own] for topic, own in _series().items()}
    path = _write_json(tmp_path / "b.mcap", late)
    logged = _convert(path, _MAPPING.format(**names).replace("[source]", '[source]\nclock = "log"'))
    stamped = _convert(path, _MAPPING.format(**names))
    np.testing.assert_allclose(logged.torque, stamped.torque, atol=1e-5)
    assert logged.torque[0] == pytest.approx(2.0 * (1.1 - 0.1), abs=1e-5)


def test_a_gap_of_one_topic_is_a_gap_of_the_table(tmp_path: Path) -> None:
    series = _series()
    series["/drive"] = [(at, one) for at, one in series["/drive"] if not 4.0 < at < 5.0]
    found = _convert(
        _write_json(tmp_path / "log.mcap", series), _MAPPING.format(position="position", current="current")
    )
    assert len(found) == pytest.approx(1600 - 200, abs=2)
    assert np.max(np.diff(found.time)) == pytest.approx(1.0, abs=0.01)
    np.testing.assert_allclose(found.torque, 2.0 * (found.time + 1.0), atol=1e-5)


def test_the_same_name_in_two_topics_is_told_by_its_topic(tmp_path: Path) -> None:
    series: Series = {
        "/a": [(0.1 * k, {"position": float(k), "value": 1.0}) for k in range(20)],
        "/b": [(0.1 * k, {"torque": 2.0 * k, "value": 5.0}) for k in range(20)],
    }
    columns = read_named_columns(_write_json(tmp_path / "log.mcap", series))
    assert set(columns) == {"time", "position", "torque", "value", "/b.value"}
    np.testing.assert_allclose(columns["torque"], 2.0 * columns["position"], atol=1e-5)
    assert set(columns["/b.value"]) == {5.0}


def test_topics_without_a_common_time_or_that_are_not_there_are_refused(tmp_path: Path) -> None:
    apart: Series = {
        "/a": [(0.1 * k, {"position": 1.0}) for k in range(9)],
        "/b": [(50.0 + 0.1 * k, {"torque": 1.0}) for k in range(9)],
    }
    path, names = _write_json(tmp_path / "log.mcap", apart), {"position": "position", "current": "torque"}
    mapping = _MAPPING.format(**names).replace('"/state"', '"/a"')
    with pytest.raises(RecordingError, match="no time in common"):
        _convert(path, mapping.replace('["/drive", "/motor"]', '["/b"]'))
    with pytest.raises(RecordingError, match="no topic '/drive' to read: it has /a, /b"):
        _convert(path, mapping)


def test_a_log_of_topics_needs_no_mapping_and_gets_the_one_that_reads_it(tmp_path: Path) -> None:
    path = _write_topics_in_protobuf(tmp_path / "log.mcap", _series())
    log = read_named_log(path)
    (found,) = log.recordings
    assert found.metadata.torque_unit == "A"
    np.testing.assert_allclose(found.torque, 2.0 * (found.time - found.time[0] + 1.0), atol=1e-5)
    again = _convert(path, render_mapping(path, log))
    np.testing.assert_allclose(again.torque, found.torque, atol=1e-9)
    np.testing.assert_allclose(again.position, found.position, atol=1e-9)


@pytest.mark.parametrize("kind", ["Arm", "Flat"])
def test_joints_of_a_message_are_told_apart_by_their_names(kind: str, tmp_path: Path) -> None:
    """Messages with a name each, or lists beside a list of names, in another order from time to time."""

    def filler(k: int) -> Callable[[Any], None]:
        def fill(message: Any) -> None:
            _stamp(message.at, 0.01 * k)
            for name in ("hip", "knee") if k % 3 else ("knee", "hip"):
                position, torque = 0.01 * k * (1 if name == "hip" else -2), 3.0 if name == "hip" else -4.0
                if kind == "Arm":
                    message.joints.add(name=name, position=position, torque=torque)
                else:
                    message.names.append(name)
                    message.position.append(position)
                    message.torque.append(torque)

        return fill

    path = _write_protobuf(tmp_path / "log.mcap", ((0.01 * k, "/arm", kind, filler(k)) for k in range(30)))
    columns, above = read_named_columns(path), "joints." if kind == "Arm" else ""
    np.testing.assert_allclose(columns["time"], _START + 0.01 * np.arange(30), atol=1e-6)
    np.testing.assert_allclose(columns[f"{above}hip.position"], 0.01 * np.arange(30), atol=1e-6)
    np.testing.assert_allclose(columns[f"{above}knee.position"], -0.02 * np.arange(30), atol=1e-6)
    assert set(columns[f"{above}knee.torque"]) == {-4.0}
    assert not any("name" in name for name in columns)


def test_a_damaged_message_is_one_clear_error(tmp_path: Path) -> None:
    """A file whose parts are whole, and whose message is none of its schema."""
    from mcap.writer import Writer

    path = tmp_path / "log.mcap"
    for schema_data in (_schema().SerializeToString(), b"\xff\xff"):
        with path.open("wb") as stream:
            writer: Any = Writer(stream)
            writer.start()
            schema = writer.register_schema("robot.State", "protobuf", schema_data)
            writer.add_message(writer.register_channel("/state", "protobuf", schema), 1, b"\x0a\xff\x01", 1)
            writer.finish()
        for read in (read_named_columns, read_named_log, lambda one: _convert(one, _ALONE)):
            with pytest.raises(RecordingError, match=r"log\.mcap"):
                read(path)


_ALONE = """
[channels]
time = { column = "time" }
position = { column = "position" }
torque = { column = "position" }
"""
