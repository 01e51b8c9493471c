"""Foreign files: every format gives the same recording, every rule does what it says."""

import json
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Mapping, Recording, convert
from fricomp.recording.unit import UNITS, find_unit

TIME = np.arange(200) / 100
POSITION = np.sin(TIME)
TORQUE = np.cos(TIME)
TABLE = np.column_stack([TIME, POSITION, TORQUE])
BY_NAME = {"t": TIME, "q": POSITION, "tau": TORQUE}


def _mapping(text: str) -> Mapping:
    from tomllib import loads

    return msgspec.convert(loads(text), Mapping)


def _one(path: Path, mapping: str) -> Recording:
    (named,) = convert(path, _mapping(mapping))
    return named.recording


_NAMED = """
[channels]
time = { column = "t" }
position = { column = "q" }
torque = { column = "tau" }
"""
_NUMBERED = _NAMED.replace('"t"', "1").replace('"q"', "2").replace('"tau"', "3")


def _write_mat(path: Path) -> None:
    from scipy.io import savemat

    savemat(path, {"log": {"t": TIME[:, None], "q": POSITION, "tau": TORQUE}, "note": "text"})


def _write_text(path: Path, separator: str, header: str) -> None:
    lines = [separator.join(map(repr, row)) for row in TABLE.tolist()]
    path.write_text("\n".join([header, *lines] if header else lines) + "\n")


def _write_mcap(path: Path) -> None:
    from mcap.writer import Writer

    with path.open("wb") as stream:
        writer: Any = Writer(stream)
        writer.start()
        schema = writer.register_schema(name="state", encoding="jsonschema", data=b"{}")
        channel = writer.register_channel(topic="/state", message_encoding="json", schema_id=schema)
        for t, q, tau in TABLE.tolist():
            data = json.dumps({"t": t, "joint": {"q": q, "tau": tau}, "name": "elbow"}).encode()
            writer.add_message(channel, log_time=round(t * 1e9), publish_time=round(t * 1e9), data=data)
        writer.finish()


def _write_rosbag(path: Path, storage: str) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types: Any = store.types
    joint_state, header, stamp = (
        types["sensor_msgs/msg/JointState"],
        types["std_msgs/msg/Header"],
        types["builtin_interfaces/msg/Time"],
    )
    with Writer(path, version=9, storage_plugin=StoragePlugin[storage]) as writer:
        connection = writer.add_connection("/joint_states", joint_state.__msgtype__, typestore=store)
        for t, q, tau in TABLE.tolist():
            nanoseconds = round(t * 1e9)
            message = joint_state(
                header=header(stamp=stamp(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9), frame_id=""),
                name=["shoulder.pan", "elbow"],
                position=np.array([0.0, q]),
                velocity=np.array([]),
                effort=np.array([0.0, tau]),
            )
            writer.write(connection, nanoseconds, store.serialize_cdr(message, joint_state.__msgtype__))


_ROS = """
[source]
topic = "/joint_states"
[channels]
time = { column = "time" }
position = { column = "{joint}.position" }
torque = { column = "{joint}.effort" }
[[joints]]
name = "arm_elbow"
source = "elbow"
"""

FORMATS: dict[str, tuple[str, str]] = {
    "log.mat": ("scipy", _NAMED.replace('"t"', '"log.t"').replace('"q"', '"log.q"').replace('"tau"', '"log.tau"')),
    "log.npz": ("numpy", _NAMED),
    "log.npy": ("numpy", _NUMBERED),
    "structured.npy": ("numpy", _NAMED),
    "rows.json": ("numpy", '[source]\nrecords = "data.rows"\n' + _NUMBERED),
    "objects.json": ("numpy", _NAMED),
    "columns.json": ("numpy", _NAMED),
    "plain.csv": ("numpy", _NUMBERED),
    "header.csv": ("numpy", "[source]\nheader = true\n" + _NAMED),
    "spaces.txt": ("numpy", '[source]\ndelimiter = ""\nskip_lines = 1\n' + _NUMBERED),
    "log.bin": ("numpy", '[source]\ndtype = ">f8"\ncolumns = 3\n' + _NUMBERED),
    "log.mcap": ("mcap", _NAMED.replace('"q"', '"joint.q"').replace('"tau"', '"joint.tau"')),
    "bag_sqlite": ("rosbags", _ROS),
    "bag_mcap": ("rosbags", _ROS),
}


def _write(path: Path) -> None:
    structured = np.array([tuple(row) for row in TABLE], dtype=[("t", "f8"), ("q", "f8"), ("tau", "f8")])
    objects = [dict(zip(BY_NAME, row, strict=True)) for row in TABLE.tolist()]
    writers: dict[str, Any] = {
        "log.mat": lambda: _write_mat(path),
        "log.npz": lambda: np.savez(path, t=TIME, q=POSITION, tau=TORQUE),
        "log.npy": lambda: np.save(path, TABLE),
        "structured.npy": lambda: np.save(path, structured),
        "rows.json": lambda: path.write_text(json.dumps({"data": {"rows": TABLE.tolist()}})),
        "objects.json": lambda: path.write_text(json.dumps(objects)),
        "columns.json": lambda: path.write_text(json.dumps({name: v.tolist() for name, v in BY_NAME.items()})),
        "plain.csv": lambda: _write_text(path, ",", ""),
        "header.csv": lambda: _write_text(path, ", ", "t, q, tau"),
        "spaces.txt": lambda: _write_text(path, "  ", "% seconds rad Nm"),
        "log.bin": lambda: path.write_bytes(TABLE.astype(">f8").tobytes()),
        "log.mcap": lambda: _write_mcap(path),
        "bag_sqlite": lambda: _write_rosbag(path, "SQLITE3"),
        "bag_mcap": lambda: _write_rosbag(path, "MCAP"),
    }
    writers[path.name]()


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_gives_the_same_samples(tmp_path: Path, name: str) -> None:
    package, mapping = FORMATS[name]
    pytest.importorskip(package)
    path = tmp_path / name
    _write(path)
    recording = _one(path, mapping)
    assert np.abs(recording.time - TIME).max() < 1e-9
    assert np.array_equal(recording.position, POSITION)
    assert np.array_equal(recording.torque, TORQUE)


@pytest.mark.parametrize("name", [name for name in FORMATS if name not in {"bag_sqlite", "bag_mcap", "log.bin"}])
def test_damaged_files_are_one_clear_error(tmp_path: Path, name: str) -> None:
    package, mapping = FORMATS[name]
    pytest.importorskip(package)
    path = tmp_path / name
    path.write_bytes(b"\x00\x01 this is not what the suffix says")
    with pytest.raises(RecordingError, match=name):
        convert(path, _mapping(mapping))


@pytest.mark.parametrize("name", ["log.mat", "log.npz", "log.npy", "objects.json", "log.mcap"])
@pytest.mark.parametrize("part", [0.0, 0.01, 0.4, 0.99])
def test_truncated_files_are_one_clear_error(tmp_path: Path, name: str, part: float) -> None:
    package, mapping = FORMATS[name]
    pytest.importorskip(package)
    path = tmp_path / name
    _write(path)
    content = path.read_bytes()
    path.write_bytes(content[: int(part * len(content))])
    with pytest.raises(RecordingError, match=name):
        convert(path, _mapping(mapping))


def test_bag_without_the_topic_lists_those_it_has(tmp_path: Path) -> None:
    pytest.importorskip("rosbags")
    _write_rosbag(tmp_path / "bag", "SQLITE3")
    with pytest.raises(RecordingError, match="it has /joint_states"):
        convert(tmp_path / "bag", _mapping(_ROS.replace('"/joint_states"', '"/other"')))


def _rule(tmp_path: Path, position: str, torque: str = "{ column = 3 }", metadata: str = "") -> Recording:
    _write_text(tmp_path / "log.csv", ",", "")
    lines = ["[metadata]", metadata, "[channels]", "time = { column = 1 }", f"position = {position}"]
    return _one(tmp_path / "log.csv", "\n".join([*lines, f"torque = {torque}"]))


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        ('{ column = 2, unit = "deg" }', POSITION * np.pi / 180),
        ("{ column = 2, scale = 3.0, sign = -1, offset = 1.5 }", 1.5 - 3 * POSITION),
        ("{ column = 2, times = 3 }", POSITION * TORQUE),
        ('{ column = 2, plus = "torque" }', POSITION + TORQUE),
        ("{ column = 2, from_zero = true }", POSITION - POSITION[0]),
        ("{ constant = 0.25 }", np.full(200, 0.25)),
        ("{ rate = 50 }", np.arange(200) / 50),
    ],
)
def test_rules_of_a_channel(tmp_path: Path, rule: str, expected: np.ndarray[Any, Any]) -> None:
    assert _rule(tmp_path, rule).position == pytest.approx(expected, abs=1e-15)


def test_integral_of_a_channel(tmp_path: Path) -> None:
    recording = _rule(tmp_path, '{ integral_of = "torque" }')
    assert recording.position == pytest.approx(np.sin(TIME), abs=1e-5)


def test_unsigned_numbers_become_signed_and_wrapped_ones_continuous(tmp_path: Path) -> None:
    turning = np.linspace(0, 20, 200)
    counts = np.array([5, 65531, 0, 32768, 32767] * 40)
    np.save(tmp_path / "log.npy", np.column_stack([TIME, turning % (2 * np.pi), counts]))
    mapping = """
    [channels]
    time = { column = 1 }
    position = { column = 2, unwrap = 6.283185307179586 }
    torque = { column = 3, signed_bits = 16 }
    """
    recording = _one(tmp_path / "log.npy", mapping)
    assert recording.position == pytest.approx(turning, abs=1e-9)
    assert recording.torque[:5].tolist() == [5, -5, 0, -32768, 32767]


def test_unit_of_another_quantity_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="position is in rad, unit 'mm' is a unit of m"):
        _rule(tmp_path, '{ column = 2, unit = "mm" }')
    with pytest.raises(RecordingError, match="torque is in N·m, unit 'kip' is a unit of N"):
        _rule(tmp_path, "{ column = 2 }", '{ column = 3, unit = "kip" }')
    linear = _rule(tmp_path, '{ column = 2, unit = "in" }', '{ column = 3, unit = "kip" }', 'motion = "linear"')
    assert linear.torque == pytest.approx(4448.2216152605 * TORQUE)
    with pytest.raises(RecordingError, match="unknown unit 'furlong': valid are 1, percent"):
        find_unit("furlong")


def test_units_agree_with_each_other() -> None:
    assert UNITS["rpm"].factor == pytest.approx(UNITS["turns/s"].factor / 60)
    assert UNITS["ft·lbf"].factor == pytest.approx(1.3558179483314004)
    assert UNITS["oz·in"].factor == pytest.approx(0.00706155181422604)
    assert UNITS["kgf·cm"].factor == pytest.approx(0.0980665)
    assert 212 * UNITS["degF"].factor + UNITS["degF"].offset == pytest.approx(100)
    assert 273.15 * UNITS["K"].factor + UNITS["K"].offset == pytest.approx(0)


def test_several_joints_files_and_parts(tmp_path: Path) -> None:
    wide = np.column_stack([TIME, POSITION, 2 * POSITION, TORQUE, 2 * TORQUE, np.arange(200) < 100])
    np.save(tmp_path / "a.npy", wide)
    mapping = """
    [channels]
    time = { column = 1 }
    position = { column = 2, joint_step = 1 }
    torque = { column = 4, joint_step = 1 }
    [metadata]
    torque_unit = "A"
    extra = { site = 1 }
    [[joints]]
    name = "one"
    metadata = { gear_ratio = 50.0 }
    [[joints]]
    name = "two"
    channels = { torque = { column = 5, scale = 10.0 } }
    [[files]]
    name = "all"
    file = "set/a.npy"
    metadata = { extra = { payload = 2 } }
    [[files]]
    name = "second"
    file = "set/a.npy"
    joints = ["two"]
    rows = [11, 20]
    [[files]]
    name = "first_half"
    file = "set/a.npy"
    joints = ["one"]
    where = { column = 6, equals = 1 }
    """
    found = {named.name: named.recording for named in convert(tmp_path / "a.npy", _mapping(mapping))}
    assert list(found) == ["all/one", "all/two", "second", "first_half"]
    assert found["all/one"].metadata.gear_ratio == 50.0
    assert found["all/one"].metadata.extra == {"site": 1, "payload": 2}
    assert found["all/two"].metadata.torque_unit == "A"
    assert found["all/two"].torque == pytest.approx(20 * TORQUE)
    assert found["second"].time == pytest.approx(TIME[10:20])
    assert len(found["first_half"]) == 100
    with pytest.raises(RecordingError, match=r"knows no file 'b.npy': it has set/a.npy"):
        convert(tmp_path / "b.npy", _mapping(mapping))


def test_bad_rows_are_an_error_and_skipped_where_allowed(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("0,1,2\n0.1,x,2\n0.2,1,2\n0.2,1,2\n0.1,1,2\n0.3,nan,2\n0.4,1\n0.5,3,2\n0.6,4,5\n0.7")
    with pytest.raises(RecordingError, match="line 2, column 2: 'x' is no number; set skip_bad_rows"):
        _one(path, _NUMBERED)
    assert _one(path, "skip_bad_rows = true\n" + _NUMBERED).time.tolist() == [0.0, 0.2, 0.5, 0.6]


def test_rows_outside_the_source_and_missing_columns_are_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "log.npz", t=TIME, q=POSITION, tau=TORQUE)
    with pytest.raises(RecordingError, match=r"rows 1\.\.300 are not among the 200 rows"):
        _one(tmp_path / "log.npz", "rows = [1, 300]\n" + _NAMED)
    with pytest.raises(RecordingError, match="no column 'effort': it has t, q, tau"):
        _one(tmp_path / "log.npz", _NAMED.replace('"tau"', '"effort"'))
    with pytest.raises(RecordingError, match="no source at"):
        _one(tmp_path / "absent.npz", _NAMED)
    (tmp_path / "log.xyz").write_bytes(b"\0\1\2")
    with pytest.raises(RecordingError, match="unknown suffix; name the format"):
        _one(tmp_path / "log.xyz", _NAMED)


def test_resampling_rate_of_a_mapping_is_used(tmp_path: Path) -> None:
    np.savez(tmp_path / "log.npz", t=TIME, q=POSITION, tau=TORQUE)
    recording = _one(tmp_path / "log.npz", "resample_rate = 500\n" + _NAMED)
    assert recording.sample_period == pytest.approx(1 / 500)


@pytest.mark.parametrize("dtype", ["nonsense", "O", "U0", "f8,f8"])
def test_a_binary_format_that_is_no_number_is_refused(tmp_path: Path, dtype: str) -> None:
    (tmp_path / "log.bin").write_bytes(TABLE.tobytes())
    with pytest.raises(RecordingError, match=r"write (it|one) as numpy does"):
        _one(tmp_path / "log.bin", f'[source]\ndtype = "{dtype}"\ncolumns = 3\n{_NUMBERED}')


def test_facts_beside_the_others_are_a_table(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="metadata extra is 'x': give an object"):
        _rule(tmp_path, "{ column = 2 }", metadata='extra = "x"')


def test_a_number_is_a_place_and_a_text_a_name(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("t,0,1,2,3\n0,10,11,12,13\n1,20,21,22,23\n")
    rules = "[channels]\ntime = { column = 1 }\nposition = { column = 2 }\n"
    recording = _one(path, "[source]\nheader = true\n" + rules + 'torque = { column = "2" }')
    assert (recording.position.tolist(), recording.torque.tolist()) == ([10.0, 20.0], [12.0, 22.0])


def test_names_without_a_header_line_are_found_or_refused_with_what_to_set(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    _write_text(path, ",", "t, q, tau")
    (found,) = convert(path, _mapping(_NAMED))
    assert found.recording.position == pytest.approx(POSITION)
    _write_text(path, ",", "t, q, other")
    with pytest.raises(RecordingError, match=r"no column is called .*: set header = true"):
        convert(path, _mapping(_NAMED))


def test_a_scaled_number_that_was_read_as_unsigned_is_read_by_its_range(tmp_path: Path) -> None:
    torque = 0.00269 * np.mod(np.array([3.0, -5.0, 0.0, -200.0]), 2**16)
    np.savez(tmp_path / "log.npz", t=np.arange(4) / 50.0, q=np.zeros(4), tau=1e3 * torque)
    rule = 'tau = { column = "tau", unit = "mNm", signed_range = 176.29 }'
    text = _NAMED.replace('torque = { column = "tau" }', rule.replace("tau =", "torque ="))
    assert "signed_range" in text
    found = _one(tmp_path / "log.npz", text)
    assert found.torque == pytest.approx([0.00269 * k for k in (3, -5, 0, -200)], abs=2e-3)


@pytest.mark.parametrize("known", [True, False])
def test_a_folder_of_files_is_read_by_one_mapping(tmp_path: Path, *, known: bool) -> None:
    files = "".join(f'[[files]]\nname = "{n}"\nfile = "raw/log_{n}.csv"\n' for n in "ab") if known else ""
    for name in "ab":
        np.savetxt(tmp_path / f"log_{name}.csv", TABLE, delimiter=",")
    (tmp_path / "README.md").write_text("Logs of one afternoon.")
    found = convert(tmp_path, _mapping(f'{files}[source]\nformat = "text"\ndelimiter = ","\n{_NUMBERED}'))
    assert [one.name for one in found] == (["a", "b"] if known else ["log_a", "log_b"])
    assert all(np.allclose(one.recording.position, POSITION) for one in found)


def test_a_folder_without_any_file_of_the_mapping_is_refused_with_those_it_knows(tmp_path: Path) -> None:
    (tmp_path / "other.csv").write_text("1,2,3\n")
    with pytest.raises(RecordingError, match=r"no file that the mapping knows: it has log\.csv"):
        convert(tmp_path, _mapping(f'[[files]]\nname = "a"\nfile = "log.csv"\n{_NUMBERED}'))


def test_a_sign_in_a_bit_of_its_own_is_read(tmp_path: Path) -> None:
    counts = np.array([5, 1024 + 5, 0, 1023, 1024 + 1000] * 40)
    np.save(tmp_path / "log.npy", np.column_stack([TIME, np.sin(TIME), counts]))
    rules = "time = { column = 1 }\nposition = { column = 2 }\ntorque = { column = 3, sign_bit = 10, scale = 0.5 }\n"
    recording = _one(tmp_path / "log.npy", f"[channels]\n{rules}")
    assert recording.torque[:5].tolist() == [2.5, -2.5, 0.0, 511.5, -500.0]
