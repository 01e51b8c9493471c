"""Files that anybody may have made: text that would be obeyed, and content that would exhaust the machine."""

import io
import re
import resource
import shutil
import sqlite3
import subprocess
import sys
import zipfile
import zlib
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np
import onnx
import pyarrow
import pytest
from onnx import helper
from pyarrow import parquet
from typer.testing import CliRunner

from fricomp.adapters.configuration import read_table
from fricomp.adapters.odrive.endpoint import read_endpoints
from fricomp.arm.record import load_arm_record
from fricomp.calibration.table import read_friction_table
from fricomp.cli.main import app
from fricomp.cli.terminal import console, plain
from fricomp.control.compensation.network_file import open_network
from fricomp.diagnosis import read_controller
from fricomp.diagnosis.inputs.rigid import read_simulation
from fricomp.diagnosis.record.record_file import load_diagnosis
from fricomp.errors import FricompError
from fricomp.export import render_c_header
from fricomp.laws import FrictionLaw, Stribeck, StribeckCurve
from fricomp.model import FrictionModel, load_model, save_model
from fricomp.recording import convert, load_mapping, read_recording
from fricomp.recording.mapping import Source
from fricomp.recording.named.source import read_named_columns
from fricomp.recording.sources import read_columns
from fricomp.report import Chart, Check, Line, Panel, ReportPage, Section, Table, draw_png, write_report
from fricomp.simulation_file import read_specification
from fricomp.untrusted import convert_table, parse_json, parse_toml
from fricomp.whole_file import write_whole

from .recording.hostile.ros import load_types, write_bag

HOSTILE = 'el"bow\\\n*/ int injected; /* ??/\n\x1b]0;owned\x07 \u202e[bold]$x_{ </script><script>alert(1)</script>'
DEEP = 100_000


def _model(joint: str = HOSTILE) -> FrictionModel:
    return FrictionModel(FrictionLaw((Stribeck(StribeckCurve(0.2, 0.5, 0.05, 0.1)),)), joint=joint)


# -- text that would be obeyed -------------------------------------------------------------------------------


@pytest.mark.parametrize("ending", ["", "\\", "*", "?", "/", "??"])
def test_a_joint_name_adds_no_symbol_to_the_header(ending: str, tmp_path: Path) -> None:
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("no gcc: apt-get install gcc")
    (tmp_path / "friction.h").write_text(render_c_header(_model(HOSTILE + ending), prefix="joint", any_status=True))
    (tmp_path / "main.c").write_text('#include "friction.h"\n')
    flags = ["-std=c99", "-Werror", "-Wall", "-Wno-unused-function", "-trigraphs", "-c", "main.c", "-o", "main.o"]
    subprocess.run([compiler, *flags], cwd=tmp_path, check=True)
    symbols = subprocess.run(["nm", "main.o"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert "injected" not in symbols


def test_the_terminal_is_sent_no_escapes_of_a_joint_name(tmp_path: Path) -> None:
    save_model(_model(), tmp_path / "friction.json")
    call = ["check-loop", str(tmp_path / "friction.json"), "--inertia", "0.1", "--bandwidth", "5"]
    said = CliRunner().invoke(app, call, env={"COLUMNS": "300"}).output
    assert "\\x1b]0;owned" in said
    assert not set(said) & {"\x1b", "\x07", "\u202e"}


def test_colours_of_our_own_still_reach_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm-256color")
    screen, stream = console(), io.StringIO()
    screen.file, screen._force_terminal, screen._color_system = stream, True, screen._color_system
    screen.print("elbow\x1b[2J", style="bold")
    assert "elbow\\x1b[2J" in stream.getvalue()
    assert plain("tab\tand line\n") == "tab\tand line\n"


@pytest.mark.usefixtures("drawn_charts")
def test_a_page_and_a_picture_show_a_name_as_it_is(tmp_path: Path) -> None:
    line = Line(np.arange(3.0), np.arange(3.0), HOSTILE)
    chart = Chart("curve", HOSTILE, (Panel((line,), HOSTILE, HOSTILE, HOSTILE),), caption=HOSTILE)
    blocks = (chart, Table((HOSTILE,), ((HOSTILE,),)), Check(HOSTILE, "passed", HOSTILE), HOSTILE)
    page = ReportPage(HOSTILE, (HOSTILE,), (Section(HOSTILE, blocks),), HOSTILE, {HOSTILE: HOSTILE})
    text = write_report(page, tmp_path / "report.html").read_text()
    assert "&lt;script&gt;alert(1)" in text
    assert re.search(r"<script>\s*alert", text) is None
    assert draw_png(chart, tmp_path / "curve.png").read_bytes().startswith(b"\x89PNG")


# -- content that would exhaust the machine ------------------------------------------------------------------


@pytest.mark.parametrize("text", ["[" * DEEP, '{"a":' * DEEP, "9" * 5000, "\udcff"])
def test_json_that_no_parser_takes_is_an_error_of_the_parser(text: str) -> None:
    with pytest.raises(msgspec.DecodeError):
        parse_json(text.encode("utf-8", "surrogateescape"), dict[str, float])


@pytest.mark.parametrize(
    "text",
    [
        f"a = {'[' * DEEP}",
        f"a = {'9' * 5000}",
        f"a = {'{b=' * DEEP}",
        f"a{'.a' * DEEP} = 1",
        "'a'" + ' . "a"' * DEEP + " = 1",
        f"x = {{a{'.a' * DEEP} = 1}}",
    ],
)
def test_toml_that_no_parser_takes_is_an_error_of_the_parser(text: str) -> None:
    with pytest.raises(ValueError, match=r"nested too deeply|digits"):
        parse_toml(text)


def read_settings(path: Path) -> None:
    """What `fricomp calibrate --settings` does first."""
    result = CliRunner().invoke(app, ["calibrate", "--settings", str(path), "--dry-run"])
    assert result.exception is not None
    raise result.exception


WHOLE: tuple[Callable[[Path], object], ...] = (
    load_model, load_diagnosis, load_arm_record, read_table, read_controller, load_mapping, read_endpoints,
    read_settings, open_network, read_specification,
)  # fmt: skip
"""Readers of small files, each as one piece."""


@pytest.mark.parametrize(
    "content",
    ["[" * DEEP, '{"endpoints":' * DEEP, f"a = {'[' * DEEP}", f"a = {'9' * 5000}", f'{{"schema": {"9" * 5000}}}'],
)
@pytest.mark.parametrize("read", [*WHOLE, read_recording, read_friction_table])
def test_every_reader_of_text_refuses_it(read: Callable[[Path], object], content: str, tmp_path: Path) -> None:
    path = tmp_path / "hostile.csv"
    path.write_text(content)
    with pytest.raises(FricompError, match=r"hostile\.csv"):
        read(path)


@pytest.mark.parametrize("read", WHOLE)
def test_a_file_without_end_is_not_read_to_its_end(read: Callable[[Path], object], tmp_path: Path) -> None:
    path = tmp_path / "endless.csv"
    with path.open("wb") as file:
        file.truncate(2**42)  # takes no place on the disk
    with pytest.raises(FricompError, match=r"endless\.csv.*(?i:file too large)"):
        read(path)


@pytest.mark.parametrize("read", [load_model, read_endpoints, load_mapping])
def test_a_path_that_no_file_can_have_is_one_that_is_not_there(read: Callable[[Path], object]) -> None:
    with pytest.raises(FricompError):
        read(Path("a\0b"))


def test_a_simulation_without_a_joint_is_refused_as_one_joint(tmp_path: Path) -> None:
    (tmp_path / "bare.urdf").write_text('<robot name="bare"><link name="a"/></robot>')
    with pytest.raises(FricompError, match=r"bare\.urdf has no joint"):
        read_simulation(tmp_path / "bare.urdf")


def test_links_in_a_circle_are_refused_as_inputs_and_as_results(tmp_path: Path) -> None:
    circle = tmp_path / "circle.csv"
    circle.symlink_to(circle)
    (tmp_path / "points.csv").write_text("velocity,torque\n1,1\n")
    for arguments in (["identify", str(circle)], ["identify", str(tmp_path / "points.csv"), "--out", str(circle)]):
        result = CliRunner().invoke(app, arguments)
        assert isinstance(result.exception, FricompError | OSError | SystemExit), result.exception
        assert result.exit_code


def _header(shape: str) -> bytes:
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


def _write_npz(path: Path, member: bytes) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("array.npy", member)


def _write_mat(path: Path) -> None:
    packed = zlib.compressobj(9)
    step = packed.compress(bytes(2**24))
    pieces = [step, *(packed.compress(bytes(2**24)) for _ in range(80)), packed.flush()]
    data = b"".join(pieces)
    path.write_bytes(
        b"MATLAB 5.0".ljust(124) + b"\x00\x01IM" + (15).to_bytes(4, "little") + len(data).to_bytes(4, "little") + data
    )


def _write_parquet(path: Path) -> None:
    column = pyarrow.DictionaryArray.from_arrays(np.zeros(70_000_000, dtype=np.int8), [0.0])
    parquet.write_table(pyarrow.table({"time": column, "position": column, "torque": column}), path)


BOMBS: dict[str, Callable[[Path], None]] = {
    "terabytes.npy": lambda path: write_whole(path, _header("(1000000000000, 7)") + bytes(64)),
    "negative.npy": lambda path: write_whole(path, _header("(-1, 7)") + bytes(64)),
    "terabytes.npz": lambda path: _write_npz(path, _header("(1000000000000, 7)") + bytes(64)),
    "bomb.mat": _write_mat,
}


@pytest.mark.parametrize("name", BOMBS)
def test_a_file_that_claims_more_than_it_has_is_refused_before_memory_is_taken(name: str, tmp_path: Path) -> None:
    BOMBS[name](tmp_path / name)
    with pytest.raises(FricompError, match=name):
        read_columns(tmp_path / name, Source(), [1])


def test_a_parquet_file_of_constants_without_end_is_refused(tmp_path: Path) -> None:
    _write_parquet(tmp_path / "bomb.parquet")
    with pytest.raises(FricompError, match=r"bomb.parquet claims 70000000 rows"):
        read_recording(tmp_path / "bomb.parquet")


def _network(path: Path, *nodes: onnx.NodeProto, external: bool = False) -> None:
    size = helper.make_tensor("size", onnx.TensorProto.INT64, (1,), [10**12])
    if external:
        size.external_data.add(key="location", value="/etc/passwd")
        size.data_location = onnx.TensorProto.EXTERNAL
    state = helper.make_tensor_value_info("state", onnx.TensorProto.FLOAT, (1, 2))
    torque = helper.make_tensor_value_info("torque", onnx.TensorProto.FLOAT, (1, 1))
    graph = helper.make_graph(list(nodes), "network", [state], [torque], [size])
    path.write_bytes(helper.make_model(graph).SerializeToString())


def test_a_network_that_makes_tensors_of_any_size_is_refused_before_it_is_loaded(tmp_path: Path) -> None:
    path = tmp_path / "bomb.onnx"
    _network(path, helper.make_node("ConstantOfShape", ["size"], ["torque"]))
    with pytest.raises(FricompError, match=r"bomb.onnx is no friction network: it has a node ConstantOfShape"):
        open_network(path)
    _network(path, helper.make_node("Identity", ["size"], ["torque"]), external=True)
    with pytest.raises(FricompError, match=r"bomb.onnx takes weights from other files"):
        open_network(path)
    path.write_bytes(b"\x0a\xff\xff")
    with pytest.raises(FricompError, match=r"cannot read the network .*bomb.onnx"):
        open_network(path)


def test_a_hostile_source_is_one_sentence_of_convert(tmp_path: Path) -> None:
    (tmp_path / "deep.json").write_text("[" * DEEP)
    (tmp_path / "map.toml").write_text('[channels]\ntime.column = "t"\nposition.column = "q"\ntorque.column = "i"\n')
    with pytest.raises(FricompError, match=r"deep.json is no JSON: it is nested too deeply"):
        list(convert(tmp_path / "deep.json", load_mapping(tmp_path / "map.toml")))


# -- little files of large tables, and of endless work -----------------------------------------------------------

_OWN_NAMES = [{f"q_{k}": 1.0} for k in range(6000)]
_LONG_AND_WIDE: dict[str, str] = {
    "own_names.json": msgspec.json.encode(_OWN_NAMES).decode(),
    "own_words.json": msgspec.json.encode([{f"q_{k}": "x"} for k in range(6000)]).decode(),
    "own_names.jsonl": "\n".join(msgspec.json.encode(row).decode() for row in _OWN_NAMES),
    "short_rows.csv": ",".join(f"q_{k}" for k in range(300)) + "\n" + ("1," * 299 + "1\n") * 60 + "1\n" * 60_000,
    "one_list.csv": "time,q\n" + '1,"[1]"\n' * 6000 + '2,"[' + "1 " * 6000 + ']"\n',
    "labels.txt": "".join(f"q{k}=1 t{k}=2\n" for k in range(6000)),
    "elements.xml.txt": "".join(f'<a{k} x="1" y="2" z="3"/>\n' for k in range(3000)),
    "messages.txt": "".join(f"---\nposition:\n- {k}\nq_{k}: 1.0\n" for k in range(6000)),
}


@pytest.mark.parametrize("name", _LONG_AND_WIDE)
def test_rows_that_each_have_names_of_their_own_are_no_log(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(_LONG_AND_WIDE[name])
    with pytest.raises(FricompError, match="values in all: that is no log"):
        read_named_columns(tmp_path / name)


def test_one_long_list_among_short_ones_is_no_column(tmp_path: Path) -> None:
    lists = [[1.0]] * 6000 + [[1.0] * 6000]
    parquet.write_table(pyarrow.table({"time": np.arange(6001.0), "q": lists}), tmp_path / "a.parquet")
    with pytest.raises(FricompError, match="6001 rows would have 6000 columns"):
        read_named_columns(tmp_path / "a.parquet")


@pytest.mark.parametrize(
    "line",
    [" " * 30_000 + "x", "1" + " " * 30_000 + "x", "a" * 30_000 + "!", "can" * 10_000 + "!", "a1" * 15_000 + "!"],
)
def test_a_line_without_end_is_looked_at_in_one_pass(line: str, tmp_path: Path) -> None:
    wave = "\n".join(f"{0.01 * k:.2f},{k},{-k}" for k in range(60))
    for text in (f"time,position,torque\n{line}\n{wave}\n", f"{line}\n" * 3, f"time,position,{line}\n{wave}\n"):
        (tmp_path / "log.txt").write_text(text)
        with suppress(FricompError):
            assert read_named_columns(tmp_path / "log.txt")


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux alone")
def test_a_reader_that_takes_more_memory_than_a_log_needs_is_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    word = pyarrow.DictionaryArray.from_arrays(np.zeros(300_000, dtype=np.int8), ["x" * 10_000])
    parquet.write_table(pyarrow.table({"t": word, "q": word}), tmp_path / "words.parquet")
    monkeypatch.setattr("fricomp.untrusted._LEAST_LIMIT", 2**26)
    before = resource.getrlimit(resource.RLIMIT_DATA)
    with pytest.raises(FricompError, match=r"words.parquet claims more content than there is memory"):
        read_named_columns(tmp_path / "words.parquet")
    assert resource.getrlimit(resource.RLIMIT_DATA) == before


_WITHOUT_END = (
    "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x FROM n) SELECT x AS schema_version FROM n WHERE x > 1"
)


@pytest.mark.parametrize(
    "change",
    [
        f"DROP TABLE schema; CREATE VIEW schema AS {_WITHOUT_END}",
        "CREATE TABLE more(id INTEGER, data BLOB AS\n(zeroblob(1000000000)))",
        "ALTER TABLE topics RENAME TO old; CREATE TABLE topics(id, name, type, serialization_format, "
        "offered_qos_profiles, type_description_hash); INSERT INTO topics SELECT old.* FROM old, messages",
    ],
)
def test_a_bag_that_is_computed_without_end_is_refused(change: str, tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", "sqlite3")
    with closing(sqlite3.connect(tmp_path / "bag" / "bag.db3")) as base:
        base.executescript(change)
    for path in (tmp_path / "bag", tmp_path / "bag" / "bag.db3"):
        with pytest.raises(FricompError, match=r"bag.db3 computes its tables, or has topics twice"):
            read_columns(path, Source(), [1])


def test_a_bag_with_messages_of_a_thousand_million_names_is_refused(tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", "sqlite3")
    with closing(sqlite3.connect(tmp_path / "bag" / "bag.db3")) as base, base:
        base.execute("UPDATE message_definitions SET encoded_message_definition = 'string[1000000000] name'")
    with pytest.raises(FricompError, match=r"defines a message with 1000000000 fixed entries"):
        read_columns(tmp_path / "bag", Source(), [1])


def test_a_bag_that_unpacks_without_end_is_refused_before_the_disk_is_filled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, Writer
    from zstandard import compress

    monkeypatch.setattr("fricomp.untrusted._LEAST_LIMIT", 2**24)
    bag = Writer(tmp_path / "bag", version=9)
    bag.set_compression(CompressionMode.FILE, CompressionFormat.ZSTD)
    with bag:
        bag.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=load_types())
    (file,) = (tmp_path / "bag").glob("*.zstd")
    with pytest.raises(FricompError, match="there is no topic"):  # unpacked, and empty
        read_columns(tmp_path / "bag", Source(), [1])
    file.write_bytes(compress(bytes(2**25)))
    with pytest.raises(FricompError, match="unpacks into more than 16777216 bytes"):
        read_columns(tmp_path / "bag", Source(), [1])


class _Entry(msgspec.Struct, forbid_unknown_fields=True):
    mark: Literal["dot", "cross"] = "dot"
    size: float | None = None


class _Table(msgspec.Struct, forbid_unknown_fields=True):
    name: str = ""
    one: _Entry | None = None
    many: tuple[_Entry, ...] = ()
    called: dict[str, _Entry] = {}


@pytest.mark.parametrize(
    ("table", "valid"),
    [
        ({"nome": ""}, "valid are name, one, many, called"),
        ({"one": {"sise": 1}}, "valid are mark, size"),
        ({"many": [{}, {"mark": "ring"}]}, "valid are 'dot', 'cross'"),
        ({"called": {"a": {"mark": "ring"}}}, "valid are 'dot', 'cross'"),
    ],
)
def test_a_table_is_refused_with_what_could_stand_in_it(table: dict[str, Any], valid: str) -> None:
    assert convert_table({"many": [{"mark": "dot"}]}, _Table).many == (_Entry(),)
    with pytest.raises(msgspec.ValidationError) as refused:
        convert_table(table, _Table)
    assert sorted(str(refused.value).partition("; ")[2].replace("valid are ", "").split(", ")) == sorted(
        valid.replace("valid are ", "").split(", ")
    )


def test_a_table_of_another_kind_is_refused_as_it_is() -> None:
    with pytest.raises(msgspec.ValidationError, match="Expected str, got int - at"):
        convert_table({"name": 3}, _Table)
