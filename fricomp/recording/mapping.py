"""Mapping files: how a foreign file becomes recordings, written in TOML.

    [source]
    format = "text"
    delimiter = ","

    [metadata]
    torque_unit = "A"

    [channels]
    time = { column = 1, from_zero = true }
    position = { column = 2, unit = "deg", sign = -1 }
    torque = { column = 3, unit = "mA" }

A mapping makes one recording of each of its `[[files]]` for each of its `[[joints]]`; where it names no file
it fits any source. What a file or a joint says about a channel or a fact replaces what
the whole mapping says.
"""

import re
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from fricomp.errors import RecordingError
from fricomp.recording.recording import CHANNELS, REQUIRED_CHANNELS
from fricomp.untrusted import convert_table, parse_toml, read_whole

Format = Literal["text", "mat", "npz", "npy", "json", "binary", "mcap", "rosbag2", "parquet", "hdf5"]
Column = Annotated[int, Meta(ge=1)] | str
_Positive = Annotated[float, Meta(gt=0.0)]
_FOLDER = Path(__file__).parent / "mappings"


class Condition(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Keep the rows where `column` equals this value."""

    column: Column
    equals: float


class Source(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How to read the file.

    Attributes:
        format: Kind of file; empty decides by the suffix.
        delimiter: Between the cells of a text file; empty is any white space.
        decimal: Decimal mark of a text file; empty takes a comma as one wherever it is not the delimiter.
        header: The first line of a text file names its columns.
        skip_lines: Lines of a text file before the header or the first row.
        dtype: Number format of a binary file, as numpy writes it.
        columns: Numbers in one row of a binary file.
        records: Where the rows of a JSON file are, keys joined by dots.
        topic: Topic of an MCAP or rosbag2 file; empty is the only JointState topic.
        join: Topics whose columns are read at the instants of `topic`, on straight lines between their messages.
        clock: Time of messages: `stamp`, their own where they have one; `log`, when they were logged.
    """

    format: Format | None = None
    delimiter: str = ","
    decimal: Literal["", ".", ","] = ""
    header: bool = False
    skip_lines: Annotated[int, Meta(ge=0)] = 0
    dtype: str = "<f8"
    columns: Annotated[int, Meta(ge=1)] = 1
    records: str = ""
    topic: str = ""
    join: tuple[str, ...] = ()
    clock: Literal["stamp", "log"] = "stamp"


class ChannelRule(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where a channel comes from. Worked through in the order of the attributes, `from_zero` last.

    Attributes:
        column: Number counted from 1 (an integer), name, or path with dots (text); `name:3` is the third column
            of a matrix; `{joint}` stands for the joint's name in the source.
        joint_step: Columns from one joint to the next, for a numbered column.
        constant: The same value in every row.
        rate: Rows a second [Hz]; only for time, where the source has no clock.
        integral_of: Another channel whose integral over time this one is, from zero.
        signed_bits: The source stores a signed number of so many bits as an unsigned one.
        sign_bit: The source stores the size of a number, with its sign in this bit, counted from 0.
        nanoseconds: Only for time, whose column holds whole seconds since some day: that of the rest of its stamp. The
            first row is then at its rest.
        microseconds: The same where the rest is in microseconds.
        milliseconds: The same where the rest is in milliseconds.
        times: Another column to multiply by.
        unit: Unit of the source by name.
        scale: Factor.
        sign: 1 or -1.
        offset: Added [SI].
        signed_range: As `signed_bits` where the numbers have been scaled before: what half this range and more stands
            for is less by it [SI].
        delay: The value acts or was read so long after its stamp [s]; it is moved there. Not for time.
        spread: Only for time, whose stamps are held over several rows: the rows between are spread evenly.
        steps: Only for time, whose column holds the time since the row before: it is added up.
        from_zero: Subtract the first value.
        unwrap: Period at which the value jumps back [SI]; jumps of more than half are undone.
        plus: Another channel to add.
    """

    column: Column | None = None
    joint_step: int = 0
    constant: float | None = None
    rate: _Positive | None = None
    integral_of: str | None = None
    signed_bits: Annotated[int, Meta(ge=1, le=64)] | None = None
    sign_bit: Annotated[int, Meta(ge=1, le=63)] | None = None
    nanoseconds: Column | None = None
    microseconds: Column | None = None
    milliseconds: Column | None = None
    times: Column | None = None
    unit: str | None = None
    scale: float = 1.0
    sign: Literal[1, -1] = 1
    offset: float = 0.0
    signed_range: _Positive | None = None
    delay: float = 0.0
    spread: bool = False
    steps: bool = False
    from_zero: bool = False
    unwrap: _Positive | None = None
    plus: str | None = None

    def __post_init__(self) -> None:
        origins = [self.column, self.constant, self.rate, self.integral_of]
        if sum(origin is not None for origin in origins) != 1:
            raise ValueError("give exactly one of column, constant, rate, integral_of")


class FileRule(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One file of a set, or one part of it.

    Attributes:
        name: Name of the recording.
        file: Path in the folder of the set.
        joints: Names of the joints to take from it; empty is all.
        rows: First and last row, counted from 1.
        where: Keep only the rows that meet this.
        source: How to read it, where it is of another kind than the other files.
        metadata: Facts about it.
        channels: Channels that are different in this file.
    """

    name: str
    file: str
    joints: tuple[str, ...] = ()
    rows: tuple[int, int] | None = None
    where: Condition | None = None
    source: Source | None = None
    metadata: dict[str, Any] = {}
    channels: dict[str, ChannelRule] = {}


class JointRule(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One joint of a source that holds several.

    Attributes:
        name: Name of the joint.
        source: Its name in the source; empty is the same.
        metadata: Facts about it.
        channels: Channels that are different for this joint.
    """

    name: str
    source: str = ""
    metadata: dict[str, Any] = {}
    channels: dict[str, ChannelRule] = {}


class Mapping(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Everything a mapping file says.

    Attributes:
        source: How to read the files.
        metadata: Facts about every recording.
        channels: Where every channel comes from.
        files: Files of a known set.
        joints: Joints in each file.
        rows: First and last row, counted from 1, of a source that is no file of the set.
        skip_bad_rows: Leave out rows that hold no number or whose time does not advance.
        resample_rate: Samples a second of the result [Hz]; None keeps the rows as they are.
    """

    channels: dict[str, ChannelRule]
    source: Source = Source()
    metadata: dict[str, Any] = {}
    files: tuple[FileRule, ...] = ()
    joints: tuple[JointRule, ...] = ()
    rows: tuple[int, int] | None = None
    skip_bad_rows: bool = False
    resample_rate: _Positive | None = None


def list_mappings() -> tuple[str, ...]:
    """Return the names of the mappings that come with the package, sorted."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


_QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'|#.*")
_PLACEHOLDER = re.compile(r"=\s*([^\s,={}]*[A-Z]{4}[^\s,={}]*|[\d.]+/[\d.*/()]+)")
"""A word in capitals, as a mapping that is proposed has them, or a quotient, which TOML does not work out."""


def load_mapping(name_or_path: str | Path) -> Mapping:
    """Load a mapping by the name of one in the package, or from a TOML file.

    Raises:
        RecordingError: No such mapping, or it says something that a mapping cannot say.
    """
    import tomllib

    try:
        return _parse_mapping(parse_toml(text := _read_mapping(name_or_path)))
    except tomllib.TOMLDecodeError as error:
        raise RecordingError(f"mapping {name_or_path}: {_find_placeholder(text) or error}") from error
    except (msgspec.ValidationError, UnicodeDecodeError) as error:
        raise RecordingError(f"mapping {name_or_path}: {error}") from error


def _find_placeholder(text: str) -> str:
    """What to do with the first value that is still to be said or worked out; empty where all are values."""
    for number, line in enumerate(text.splitlines(), start=1):
        found = _PLACEHOLDER.search(_QUOTED.sub('""', line))
        if found and re.fullmatch(r"[\d.eE+*/()-]+", found.group(1)):
            return f"line {number}: TOML works nothing out: write the number that {found.group(1)} is in its place"
        if found:
            return f"line {number}: write what {found.group(1)} stands for in its place, a number or a column's name"
    return ""


def set_row_rate(mapping: Mapping, row_rate: float) -> Mapping:
    """The mapping with a time of so many rows a second [Hz] everywhere."""
    clock = {"time": ChannelRule(rate=row_rate)}
    replace = msgspec.structs.replace

    def counted(rules: tuple[FileRule, ...] | tuple[JointRule, ...]) -> tuple[Any, ...]:
        return tuple(replace(one, channels={**one.channels, **clock}) for one in rules)

    channels = {**mapping.channels, **clock}
    return replace(mapping, channels=channels, files=counted(mapping.files), joints=counted(mapping.joints))


def _read_mapping(name_or_path: str | Path) -> str:
    if str(name_or_path) in list_mappings():
        return (_FOLDER / f"{name_or_path}.toml").read_text(encoding="utf-8")
    try:
        return read_whole(name_or_path).decode("utf-8-sig")
    except OSError as error:
        raise RecordingError(
            f"no mapping {str(name_or_path)!r} ({error.strerror}): give a TOML file or one of "
            f"{', '.join(list_mappings())}"
        ) from error


def _parse_mapping(content: dict[str, Any]) -> Mapping:
    mapping = convert_table(content, Mapping)
    named = [mapping.channels, *(f.channels for f in mapping.files), *(joint.channels for joint in mapping.joints)]
    for channels in named:
        for name in channels:
            if name not in CHANNELS:
                raise msgspec.ValidationError(f"unknown channel {name!r}: valid are {', '.join(CHANNELS)}")
    shared = {name for channels in named for name in channels}
    missing = [name for name in REQUIRED_CHANNELS if name not in shared]
    if missing:
        raise msgspec.ValidationError(f"channel {missing[0]!r} is missing: {', '.join(REQUIRED_CHANNELS)} are required")
    return mapping
