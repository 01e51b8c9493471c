"""A recording that grows block by block and survives a kill, a crash and a full disk.

Each block is written, flushed and synced to disk as a whole and closed by a line
`# block: {"label": ..., "rows": ...}`. A file is therefore a valid CSV recording at any moment; what
follows the last closing line is the block that was being written when the writer was killed.
"""

import os
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, NamedTuple, Self

import msgspec

from fricomp.errors import RecordingError
from fricomp.recording.csv_file import format_preamble, format_rows
from fricomp.recording.metadata import RecordingMetadata
from fricomp.recording.recording import CHANNELS, REQUIRED_CHANNELS, Recording
from fricomp.untrusted import parse_json

_MARK = "# block: "


class Block(NamedTuple):
    """One committed block of a growing recording: rows start <= row < stop, counted from 0."""

    label: str
    start: int
    stop: int


class _Mark(msgspec.Struct):
    label: str
    rows: int


class RecordingWriter:
    """Appends blocks of samples to a CSV recording; each is on disk when `append` returns.

    Args:
        path: File to write; its folder exists.
        metadata: Written at the top of a new file.
        channels: Columns of the file, `time`, `position` and `torque` among them.
        resume: Go on after the last whole block of an existing file; an unfinished block is
            cut off. Without it an existing file is refused.

    Attributes:
        blocks: What is safely on disk.
        last_time: Time of the last sample on disk [s]; None in an empty file.

    Raises:
        RecordingError: The file cannot be written, exists already, or has other columns.
    """

    def __init__(
        self,
        path: str | Path,
        metadata: RecordingMetadata | None = None,
        channels: tuple[str, ...] = REQUIRED_CHANNELS,
        *,
        resume: bool = False,
    ) -> None:
        self._path = Path(path)
        self.channels = _order(channels)
        self.blocks: tuple[Block, ...] = ()
        self.last_time: float | None = None
        preamble = format_preamble(metadata or RecordingMetadata(), self.channels)
        try:
            if resume and self._path.exists():
                self._reopen()
            else:
                self._file: BinaryIO = self._path.open("xb")
                self._commit(preamble)
        except FileExistsError as error:
            raise RecordingError(f"{path} exists: resume it, remove it or choose another folder") from error
        except OSError as error:
            raise self._failure(error) from error

    def append(self, block: Recording, label: str = "") -> Block:
        """Write one block and wait until it is on disk.

        Args:
            block: Samples after those on disk; channels the file does not have are left out.
            label: What the block is, for `read_blocks`.

        Raises:
            RecordingError: A channel of the file is missing in the block, time does not go
                on, or the disk is full; what was on disk before stays whole.
        """
        missing = [name for name in self.channels if name not in block.channels]
        if missing:
            raise RecordingError(
                f"block {label!r} has no {missing[0]}: {self._path} records {', '.join(self.channels)}"
            )
        if self.last_time is not None and block.time[0] <= self.last_time:
            raise RecordingError(
                f"block {label!r} starts at {block.time[0]:.6g} s where the file ends at {self.last_time:.6g} s: "
                "go on in time"
            )
        mark = msgspec.json.encode(_Mark(label, len(block))).decode()
        self._commit(f"{format_rows(block, self.channels)}{_MARK}{mark}\n")
        start = self.blocks[-1].stop if self.blocks else 0
        added = Block(label, start, start + len(block))
        self.blocks = (*self.blocks, added)
        self.last_time = float(block.time[-1])
        return added

    def close(self) -> None:
        """Close the file; everything appended is on disk already."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _commit(self, text: str) -> None:
        before = self._file.tell()
        try:
            self._file.write(text.encode())
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            self._abandon(before)
            raise self._failure(error) from error
        except BaseException:  # an interrupt inside the write must not leave half a block behind
            self._abandon(before)
            raise

    def _abandon(self, length: int) -> None:
        """Cut the file back to what was whole; a fresh handle drops what the old one still buffers."""
        with suppress(OSError):  # the buffer could not be flushed: exactly what is thrown away here
            self._file.close()
        os.truncate(self._path, length)
        self._file = self._path.open("r+b")
        self._file.seek(length)

    def _reopen(self) -> None:
        content = self._path.read_bytes()
        header, rows = _scan(content, self._path)
        if header != self.channels:
            raise RecordingError(
                f"{self._path} has the columns {', '.join(header)}, the run has {', '.join(self.channels)}: "
                "resume with the run that wrote it, or choose another folder"
            )
        self.blocks = tuple(mark for mark, _ in rows)
        end = rows[-1][1] if rows else _end_of_header(content)
        if rows:
            self.last_time = self._time_of(content[:end])
        self._file = self._path.open("r+b")
        self._file.truncate(end)
        self._file.seek(end)

    def _time_of(self, content: bytes) -> float:
        """Time of the last row [s]."""
        last = next(line for line in reversed(content.splitlines()) if not line.startswith(b"#"))
        try:
            return float(last.split(b",")[self.channels.index("time")])
        except (ValueError, IndexError) as error:
            raise RecordingError(
                f"{self._path}: damaged row {last[:40].decode(errors='replace')!r}: it cannot be resumed"
            ) from error

    def _failure(self, error: OSError) -> RecordingError:
        kept = self.blocks[-1].stop if self.blocks else 0
        return RecordingError(f"cannot write {self._path}: {error.strerror or error}; {kept} rows are safe on disk")


def read_blocks(path: str | Path) -> tuple[Block, ...]:
    """Return the committed blocks of a recording that a `RecordingWriter` wrote.

    Raises:
        RecordingError: The file cannot be read.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {error.strerror or error}") from error
    if _MARK.encode() not in content:  # most files, whose lines need not be told apart
        return ()
    return tuple(block for block, _ in _scan(content, Path(path))[1])


def _scan(content: bytes, path: Path) -> tuple[tuple[str, ...], list[tuple[Block, int]]]:
    """Return the header and every committed block with the byte after its closing line."""
    header: tuple[str, ...] = ()
    blocks: list[tuple[Block, int]] = []
    position = row = 0
    for line in content.splitlines(keepends=True):
        position += len(line)
        if line.startswith(_MARK.encode()) and line.endswith(b"\n"):
            label = _decode_mark(line, path).label
            start = blocks[-1][0].stop if blocks else 0
            blocks.append((Block(label, start, row), position))
        elif not line.startswith(b"#") and not header:
            header = tuple(line.decode(errors="replace").strip().split(","))
        elif not line.startswith(b"#"):
            row += 1
    return header, blocks


def _decode_mark(line: bytes, path: Path) -> _Mark:
    try:
        return parse_json(line[len(_MARK) :], _Mark)
    except (msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path}: damaged line {line.decode(errors='replace').strip()!r}: remove it") from error


def _end_of_header(content: bytes) -> int:
    position = 0
    for line in content.splitlines(keepends=True):
        position += len(line)
        if not line.startswith(b"#"):
            break
    return position


def _order(channels: tuple[str, ...]) -> tuple[str, ...]:
    unknown = [name for name in channels if name not in CHANNELS]
    if unknown:
        raise RecordingError(f"unknown channel {unknown[0]!r}: valid are {', '.join(CHANNELS)}")
    missing = [name for name in REQUIRED_CHANNELS if name not in channels]
    if missing:
        raise RecordingError(f"channel {missing[0]!r} is not among those to write: it is required")
    return tuple(name for name in CHANNELS if name in channels)
