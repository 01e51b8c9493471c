"""What each block of a sweep's recording is: its label says so, and the file alone is enough to go on or to judge."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import msgspec

from fricomp.errors import RecordingError
from fricomp.recording import Recording, RecordingWarning, read_blocks, read_recording
from fricomp.untrusted import parse_json

from .breakaway import BreakawayRamp
from .point import SettledPart

Kind = Literal["tare", "sign_check", "warm_up", "plateau", "breakaway", "motion"]


class BlockLabel(msgspec.Struct, frozen=True, omit_defaults=True):
    """The label of one block, written as JSON.

    Attributes:
        kind: What it is.
        number: Of the plateau or the breakaway, from 0; -1 for others.
        velocity: Asked for on a plateau, signed [rad/s] or [m/s].
        start: When a plateau had settled [s].
        stop: When it ended [s].
        settled: Whether settling was seen.
        is_first_again: Whether the plateau only repeats the first speed.
        direction: Of a breakaway, +1 or -1.
        is_cut: Whether a motion was stopped before its end.
    """

    kind: Kind
    number: int = -1
    velocity: float = 0.0
    start: float = 0.0
    stop: float = 0.0
    settled: bool = True
    is_first_again: bool = False
    direction: int = 0
    is_cut: bool = False

    def encode(self) -> str:
        """The text that stands in the file."""
        return msgspec.json.encode(self).decode()


@dataclass(frozen=True)
class SweepData:
    """The blocks of a sweep.

    Attributes:
        blocks: Labels and samples, in order of time.
    """

    blocks: tuple[tuple[BlockLabel, Recording], ...] = ()

    def with_block(self, label: BlockLabel, samples: Recording) -> SweepData:
        """These blocks and one more."""
        return SweepData((*self.blocks, (label, samples)))

    def of_kind(self, kind: Kind) -> tuple[tuple[BlockLabel, Recording], ...]:
        """The blocks of one kind."""
        return tuple(block for block in self.blocks if block[0].kind == kind)

    def has(self, kind: Kind, number: int) -> bool:
        """Whether this plateau or breakaway is there already."""
        return any(label.number == number for label, _ in self.of_kind(kind))

    @property
    def next_plateau(self) -> int:
        """The lowest number above those of all plateaus."""
        return 1 + max((label.number for label, _ in self.of_kind("plateau")), default=-1)

    def settled_parts(self) -> tuple[SettledPart, ...]:
        """The settled part of every plateau."""
        parts = []
        for label, samples in self.of_kind("plateau"):
            inside = (samples.time >= label.start) & (samples.time <= label.stop)
            if inside.sum() >= 2:
                part = SettledPart(
                    label.number, label.velocity, samples.rows(inside), label.settled, label.is_first_again
                )
                parts.append(part)
        return tuple(parts)

    def ramps(self) -> tuple[tuple[BreakawayRamp, Recording], ...]:
        """The breakaway ramps."""
        return tuple(
            (
                BreakawayRamp(float(samples.position[0]), label.direction, abs(label.velocity), number=label.number),
                samples,
            )
            for label, samples in self.of_kind("breakaway")
        )


def load_sweep(path: str | os.PathLike[str]) -> SweepData:
    """The blocks of a sweep's recording, whole ones only.

    Raises:
        RecordingError: The file cannot be read, or was not written by a sweep.
    """
    blocks = read_blocks(os.fspath(path))
    if not blocks:
        return SweepData()
    with warnings.catch_warnings():  # a block that a kill has cut short is left out below anyway
        warnings.simplefilter("ignore", RecordingWarning)
        recording = read_recording(os.fspath(path))
    return SweepData(tuple(_label_blocks(path, recording, blocks)))


def _label_blocks(
    path: str | os.PathLike[str], recording: Recording, blocks: Iterable[tuple[str, int, int]]
) -> Iterable[tuple[BlockLabel, Recording]]:
    for text, start, stop in blocks:
        try:
            label = parse_json(text, BlockLabel)
        except msgspec.DecodeError as error:
            raise RecordingError(f"{os.fspath(path)} was not written by a sweep: block {text!r}: {error}") from error
        yield label, recording.rows(slice(start, stop))
