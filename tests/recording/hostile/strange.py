"""Well-formed files whose schema is not what anybody means: other types, lists of other lengths, names that repeat."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .ros import write_strange_bag

_NAMES = (
    *("time", "t_ms", "timestamp", "dt", "sec", "nanosec", "position", "q", "q_1", "q_deg", "elbow.position", "q:1"),
    *("torque", "tau", "tau_1", "current", "velocity", "joint", "name", "value", "unit", "metric", "temperature"),
    *("", "x", "a.b.c", "time_pc_pc", "posição [°]", "\x1b[2J", "l" * 300, "header", "1", "None"),
)
_WORDS = (
    "",
    "1.5",
    "1,5",
    "x",
    "nan",
    "0x1F",
    "2026-03-05T10:11:12",
    "10:11:12",
    "elbow",
    "9" * 400,
    "µ\u202e",
    "T#2s",
)
_NUMBERS = (0.0, -1.0, np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 2.0**63, 1e18, 1.7e9)


def _pick(rng: np.random.Generator, choices: Any) -> Any:
    return choices[int(rng.integers(0, len(choices)))]


def _ramp(rng: np.random.Generator, n: int) -> list[float]:
    return [float(value) for value in np.arange(n) * _pick(rng, (0.01, 1.0, 1e-9, 1e6, 0.0, -0.01))]


def _wave(rng: np.random.Generator, n: int) -> list[float]:
    return [float(value) for value in np.sin(np.arange(n) * 0.1) * _pick(rng, (1.0, 57.3, 1e-12, 1e300))]


def _wild(rng: np.random.Generator, n: int) -> list[float]:
    return [float(_pick(rng, _NUMBERS)) for _ in range(n)]


def _lists(rng: np.random.Generator, n: int) -> list[Any]:
    return [[0.1 * k] * int(rng.integers(0, 4)) for k in range(n)]


def _structures(rng: np.random.Generator, n: int) -> list[Any]:
    return [dict.fromkeys(_NAMES[: int(rng.integers(0, 3))], 0.1 * k) for k in range(n)]


def _deep(rng: np.random.Generator, n: int) -> list[Any]:
    return [{"a": [{"value": k}, {"b": None}]} if k % 2 else None for k in range(n)]


def _gaps(rng: np.random.Generator, n: int) -> list[Any]:
    return [None if rng.random() < 0.5 else 0.1 * k for k in range(n)]


_KINDS: tuple[Callable[[np.random.Generator, int], list[Any]], ...] = (
    *(_ramp, _ramp, _wave, _wave, _wave, _wild, _gaps, _lists, _structures, _deep),
    lambda rng, n: [int(value) for value in rng.integers(-(2**62), 2**62, n)],
    lambda rng, n: [bool(value) for value in rng.integers(0, 2, n)],
    lambda rng, n: [_pick(rng, _WORDS) for _ in range(n)],
    lambda rng, n: [_pick(rng, ("elbow", "wrist")) for _ in range(n)],
    lambda rng, n: [_pick(rng, (None, 1, 0.5, "x", [1.0], {"a": 1}, True)) for _ in range(n)],
)


def _make_table(rng: np.random.Generator) -> dict[str, list[Any]]:
    """Columns of values by name; those called as a time, a position and a torque are more often what they say."""
    n = int(_pick(rng, (0, 1, 2, 3, 12, 60, 60, 60)))
    names = [_pick(rng, _NAMES) for _ in range(int(rng.integers(0, 5)))]
    table: dict[str, list[Any]] = {}
    if rng.random() < 0.8:
        table = {"time": _ramp(rng, n), "position": _wave(rng, n), "torque": _wave(rng, n)}
    for name in names:
        rows = n if rng.random() < 0.9 else int(rng.integers(0, 2 * n + 2))
        table[name] = _pick(rng, _KINDS)(rng, rows)
    return table


# -- Parquet and Arrow -------------------------------------------------------------------------------------------


def _make_arrow(rng: np.random.Generator) -> Any:
    import pyarrow as pa

    kinds = (
        *(pa.float16(), pa.float32(), pa.int8(), pa.uint64(), pa.bool_(), pa.string(), pa.large_string(), pa.binary()),
        *(pa.decimal128(38, 10), pa.timestamp("ns", "UTC"), pa.timestamp("s"), pa.duration("ms"), pa.time32("s")),
        *(pa.time64("ns"), pa.date32(), pa.date64(), pa.null(), pa.list_(pa.float64()), pa.list_(pa.list_(pa.int8()))),
        *(pa.list_(pa.float32(), 2), pa.struct([("value", pa.float64()), ("unit", pa.string())])),
        *(pa.map_(pa.string(), pa.float64()), pa.dictionary(pa.int8(), pa.string()), pa.large_list(pa.string())),
    )
    arrays, names = [], []
    for name, values in _make_table(rng).items():
        wanted = _pick(rng, kinds) if rng.random() < 0.4 else None
        arrays.append(_to_arrow(pa, values, wanted))
        names.append(name)
    rows = min((len(one) for one in arrays), default=0)
    if names and rng.random() < 0.1:
        names[-1] = names[0]
    return pa.Table.from_arrays([one[:rows] for one in arrays], names=names)


def _to_arrow(pa: Any, values: list[Any], wanted: Any) -> Any:
    small = [None if value is None or value != value else 3 for value in values]
    pairs = ((values, wanted), (small, wanted), ([str(value) for value in values], wanted), (values, None))
    for content, kind in pairs:
        try:
            return pa.array(content, type=kind)
        except (pa.ArrowException, TypeError, ValueError, OverflowError):
            continue
    return pa.nulls(len(values), wanted) if wanted is not None else pa.array([str(value) for value in values])


def _write_parquet(path: Path, rng: np.random.Generator) -> None:
    from pyarrow import ArrowException, parquet

    table = _make_arrow(rng)
    options = {
        "compression": _pick(rng, ("none", "snappy", "zstd", "gzip")),
        "row_group_size": int(_pick(rng, (1, 7, 1000))),
        "use_dictionary": bool(rng.integers(0, 2)),
        "data_page_version": _pick(rng, ("1.0", "2.0")),
    }
    if rng.random() < 0.3:
        table = table.replace_schema_metadata({_pick(rng, (b"fricomp.recording", b"pandas")): _pick(rng, _METADATA)})
    try:
        parquet.write_table(table, path, **options)
    except (ArrowException, OverflowError, ValueError):  # a kind that Parquet has not
        parquet.write_table(table.select([]), path)


_METADATA = (
    *(b"{}", b"[]", b"null", b'{"joint": 1}', b'{"schema": "x"}', b'{"schema": "fricomp.recording/1", "extra": []}'),
    *(b'{"schema": "fricomp.recording/1", "encoder_resolution": "x"}', b"\xff", b'{"a":' * 3000),
)


def _write_feather(path: Path, rng: np.random.Generator) -> None:
    from pyarrow import ArrowException, feather

    table = _make_arrow(rng)
    try:
        feather.write_feather(table, str(path), compression=_pick(rng, ("uncompressed", "lz4", "zstd")))
    except (ArrowException, ValueError):  # names that repeat
        feather.write_feather(table.select([]), str(path))


# -- arrays ------------------------------------------------------------------------------------------------------


def _make_array(rng: np.random.Generator, values: list[Any]) -> Any:
    """A column as an array of some type and shape."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        return np.array([str(value)[:20] for value in values])
    array = np.nan_to_num(array, posinf=1e9, neginf=-1e9) if rng.random() < 0.5 else array
    with np.errstate(all="ignore"):
        kind = _pick(rng, (">f4", "f2", "c16", "?", "i1", "u8", "<f8", "<f8", "<f8", "U7"))
        array = array.astype(kind)
    shapes = [(-1,), (-1, 1), (1, -1), (1, 1, -1), (-1, 1, 1), *([(2, -1)] if array.size % 2 == 0 else [])]
    return array.reshape(_pick(rng, shapes)) if array.size else array.reshape(_pick(rng, ((0,), (0, 3), (3, 0))))


def _write_mat(path: Path, rng: np.random.Generator) -> None:
    from scipy.io import savemat
    from scipy.sparse import csc_matrix

    content: dict[str, Any] = {}
    for number, (name, values) in enumerate(_make_table(rng).items()):
        array = _make_array(rng, values)
        key = name if name.isidentifier() and name.isascii() and len(name) < 31 else f"v{number}"
        cells = np.empty(len(values), dtype=object)
        cells[:] = [_pick(rng, (1.0, "x", np.eye(2), np.empty(0))) for _ in values]
        signals = [{"label": name[:20], "values": array}, {"label": "", "values": array[:1]}]
        content[key] = _pick(
            rng,
            (
                *(array, array, array, array, cells, signals, {"Time": array, "Data": array}, {"signals": signals}),
                *(csc_matrix(np.eye(3)), {"a": {"b": {"values": array}}}, [signals], [{"values": 1.0}], "elbow", 0.0),
                *(
                    [{"label": 3.0, "values": cells}],
                    [{"value": array}, {"values": array}],
                    {"signals": {"values": array}},
                ),
            ),
        )
    savemat(path, content, do_compression=bool(rng.integers(0, 2)), oned_as=_pick(rng, ("row", "column")))


def _write_npz(path: Path, rng: np.random.Generator) -> None:
    arrays: dict[str, Any] = {}
    for name, values in _make_table(rng).items():
        array = _make_array(rng, values)
        fields = np.zeros(len(values), dtype=[("position", "f8", (2,)), ("q", [("a", "i2"), ("b", "U3")])])
        dates = np.arange(len(values)).astype(_pick(rng, ("M8[ns]", "m8[ms]", "M8[Y]")))
        many: Any = np.empty(len(values), dtype=object)
        arrays[name.replace("/", "_") or "empty"] = _pick(rng, (array, array, array, array, fields, dates, many))
    arrays.pop("file", None)
    np.savez(path, **arrays)


def _write_npy(path: Path, rng: np.random.Generator) -> None:
    columns = [_make_array(rng, values) for values in _make_table(rng).values()]
    np.save(path, _pick(rng, columns) if columns else np.empty(0), allow_pickle=True)


# -- text --------------------------------------------------------------------------------------------------------


def _make_document(rng: np.random.Generator) -> Any:
    """A table in one of the forms that documents have."""
    table = _make_table(rng)
    n = max(map(len, table.values()), default=0)
    rows = [{name: values[k] for name, values in table.items() if k < len(values)} for k in range(n)]
    series = [
        {_pick(rng, ("name", "target", "metric")): name, "values": [[k, v] for k, v in enumerate(values)]}
        for name, values in table.items()
    ]
    lists = [list(row.values()) for row in rows]
    names = [{"name": name} for name in table] if rng.random() < 0.3 else list(table)
    forms = (table, rows, rows, series, {"columns": names, "rows": lists}, {"results": [{"series": series}]}, lists)
    return _pick(rng, (*forms, {"data": {"a": rows}, "unit": "deg"}, {"schema": {"fields": names}, "data": lists}))


def _write_json(path: Path, rng: np.random.Generator) -> None:
    import json

    document = _make_document(rng)
    if path.suffix == ".jsonl" and isinstance(document, list):
        path.write_text("\n".join(map(json.dumps, document)))
    else:
        path.write_text(json.dumps(document))


def _write_csv(path: Path, rng: np.random.Generator) -> None:
    table, mark = _make_table(rng), _pick(rng, (",", ",", ";", "\t", " ", "|"))
    n = max(map(len, table.values()), default=0)
    lines = [mark.join(table)] if rng.random() < 0.9 else []
    lines += [_pick(rng, ("", "# joint: x", "[s]" + mark + "[deg]" + mark, '"'))] if rng.random() < 0.3 else []
    lines += [mark.join(str(values[k]) if k < len(values) else "" for values in table.values()) for k in range(n)]
    path.write_text("\n".join(lines), encoding=_pick(rng, ("utf-8", "utf-8-sig", "utf-16")), errors="replace")


# -- MCAP --------------------------------------------------------------------------------------------------------


def _write_mcap(path: Path, rng: np.random.Generator) -> None:
    import json

    from mcap.writer import CompressionType, Writer

    with path.open("wb") as stream:
        compression = _pick(rng, (CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD))
        writer: Any = Writer(stream, chunk_size=int(_pick(rng, (64, 4096))), compression=compression)
        writer.start()
        for topic in ("/joint", "/joint", "/imu")[: int(rng.integers(1, 4))]:
            schema = writer.register_schema("joint", "jsonschema", b"{}") if rng.random() < 0.8 else 0
            channel = writer.register_channel(topic, _pick(rng, ("json", "json", "json", "cbor", "")), schema)
            document = _make_document(rng)
            for number, row in enumerate(document if isinstance(document, list) else [document]):
                stamp = int(_pick(rng, (number * 10**7, number * 10**7, 0, 2**63 - 1)))
                message = _with_header(rng, row, number)
                writer.add_message(channel, stamp, json.dumps(message).encode(), stamp)
        writer.finish()


def _with_header(rng: np.random.Generator, row: Any, number: int) -> Any:
    if not isinstance(row, dict) or rng.random() < 0.5:
        return row
    stamps = ({"sec": number, "nanosec": 1}, {"sec": "1", "nanosec": []}, number, None, "x", -1.0, {"secs": 1e300})
    return {"header": _pick(rng, ({"stamp": _pick(rng, stamps)}, [], 1, None)), **row}


def _write_protobuf(path: Path, rng: np.random.Generator) -> None:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, timestamp_pb2
    from mcap.writer import Writer

    file: Any = descriptor_pb2.FileDescriptorProto(name="joint.proto", package="own", syntax="proto3")
    file.dependency.append("google/protobuf/timestamp.proto")
    kind = file.message_type.add(name="Joint")
    for number in range(int(rng.integers(1, 8))):
        name = str(_pick(rng, ("position", "torque", "name", "stamp", "header", "values", "q", "velocity"))) + str(
            number
        )
        bare = name[:-1] if all(one.name != name[:-1] for one in kind.field) else name
        field = kind.field.add(name=bare, number=number + 1, label=int(_pick(rng, (1, 1, 3))))
        field.type = int(_pick(rng, (1, 2, 3, 5, 8, 9, 11, 11, 12)))
        if field.type == 11:
            field.type_name = str(_pick(rng, (".google.protobuf.Timestamp", ".own.Joint")))
    pool = descriptor_pool.DescriptorPool()
    stamp: Any = descriptor_pb2.FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(stamp)
    pool.Add(stamp)
    pool.Add(file)
    message: Any = message_factory.GetMessageClass(pool.FindMessageTypeByName("own.Joint"))
    files = [stamp, file] if rng.random() < 0.9 else [file]
    described = descriptor_pb2.FileDescriptorSet(file=files).SerializeToString()
    with path.open("wb") as stream:
        writer: Any = Writer(stream)
        writer.start()
        named = str(_pick(rng, ("own.Joint", "own.Joint", "own.Joint", "Joint", "")))
        schema = writer.register_schema(named, "protobuf", described)
        channel = writer.register_channel("/joint", "protobuf", schema)
        for number in range(30):
            data = bytes(_fill(rng, message(), number, 0).SerializeToString())
            cut = int(rng.integers(0, len(data) + 1)) if rng.random() < 0.02 else len(data)
            writer.add_message(channel, number * 10**7, data[:cut] + rng.bytes(len(data) - cut), number * 10**7)
        writer.finish()


def _fill(rng: np.random.Generator, message: Any, number: int, level: int) -> Any:
    """Set some of a message's fields."""
    for field in message.DESCRIPTOR.fields:
        if rng.random() < 0.1 or (field.message_type is not None and level > 2):
            continue
        times = int(rng.integers(0, 4)) if field.is_repeated else 1
        for _ in range(times):
            if field.message_type is not None:
                into = getattr(message, field.name)
                _fill(rng, into.add() if field.is_repeated else into, number, level + 1)
                continue
            value = {9: "elbow", 12: b"x", 8: True}.get(field.type, number if field.type in (3, 5) else 0.1 * number)
            if field.is_repeated:
                getattr(message, field.name).append(value)
            else:
                setattr(message, field.name, value)
    return message


STRANGE: dict[str, Callable[[Path, np.random.Generator], None]] = {
    "csv": _write_csv,
    "parquet": _write_parquet,
    "feather": _write_feather,
    "mat": _write_mat,
    "npy": _write_npy,
    "npz": _write_npz,
    "json": _write_json,
    "jsonl": _write_json,
    "mcap": _write_mcap,
    "protobuf": _write_protobuf,
    "rosbag2": lambda path, rng: write_strange_bag(path, rng, "sqlite3"),
    "rosbag2-mcap": lambda path, rng: write_strange_bag(path, rng, "mcap"),
}
"""What writes a file of each format, another one for each state of the generator of random numbers."""
