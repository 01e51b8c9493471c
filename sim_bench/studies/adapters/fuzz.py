"""Random and damaged traffic into an enabled adapter: no crash, no foreign exception, no torque beyond the gate's."""

import gc
import random
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fricomp.adapters.link import CanFrame
from fricomp.errors import FricompError
from fricomp.joint import JointCommand, JointFeedback

from .bench import PERIOD, TORQUE_LIMIT, AdapterBench, make_bench

__all__ = ["FuzzResult", "fuzz_adapter", "resident_bytes"]

BATCH = 40
"""Frames between two control cycles: far more than a healthy bus carries."""

N_JOINTS = 2


@dataclass(frozen=True)
class FuzzResult:
    """What a fuzz run did.

    Attributes:
        protocol: Which.
        n_frames: Random or damaged frames, or pieces of text, fed in.
        n_cycles: Control cycles beside them.
        n_trips: How often the gate stopped the joints, and was cleared to go on.
        errors: Errors of the library's own that came, by type.
        foreign: Exceptions that are not the library's, by what they said; none may be.
        largest_torque: Largest torque that a drive exerted, its unit as configured.
        torque_limit: Bound it must stay under: the gate's, and one quantum.
        memory_growth: Of the process over the second half of the run [byte].
    """

    protocol: str
    n_frames: int
    n_cycles: int
    n_trips: int
    errors: dict[str, int]
    foreign: dict[str, int] = field(default_factory=dict)
    largest_torque: float = 0.0
    torque_limit: float = TORQUE_LIMIT
    memory_growth: int = 0

    @property
    def passed(self) -> bool:
        """Whether nothing foreign came and no drive got more than the limit."""
        return not self.foreign and self.largest_torque <= self.torque_limit


def fuzz_adapter(protocol: str, n_frames: int, seed: int = 1) -> FuzzResult:
    """Feed an adapter garbage between its cycles; when it stops, clear and enable again over a healthy link.

    Args:
        protocol: One of `PROTOCOLS`.
        n_frames: Frames in all.
        seed: Of the garbage and the commands.
    """
    run = _Run(protocol, seed)
    half = n_frames // 2
    run.feed(half)
    gc.collect()
    before = resident_bytes()
    run.feed(n_frames - half)
    gc.collect()
    quantum = max(joint.torque_quantum for joint in run.bench.adapter.capabilities.joints)
    return FuzzResult(
        protocol,
        run.n_frames,
        run.n_cycles,
        run.n_trips,
        dict(run.errors),
        dict(run.foreign),
        max(axis.largest_torque for axis in run.bench.axes),
        TORQUE_LIMIT + quantum,
        resident_bytes() - before,
    )


class _Run:
    def __init__(self, protocol: str, seed: int) -> None:
        self.bench: AdapterBench = make_bench(protocol, N_JOINTS)
        self.bench.start()
        self.rng = random.Random(seed)
        self.n_frames = self.n_cycles = self.n_trips = 0
        self.errors: Counter[str] = Counter()
        self.foreign: Counter[str] = Counter()
        self._identifiers: list[tuple[int, bool]] = []
        self._command, self._feedback = JointCommand(N_JOINTS), JointFeedback(N_JOINTS)

    def feed(self, n_frames: int) -> None:
        stop = self.n_frames + n_frames
        while self.n_frames < stop:
            self._guard(self._cycle)
            if not self.bench.adapter.enabled:
                self.n_trips += 1
                self._guard(self._recover)

    def _guard(self, call: Callable[[], None]) -> None:
        try:
            call()
        except FricompError as error:
            self.errors[type(error).__name__] += 1
        except Exception as error:  # exactly what must not happen; it is the result
            self.foreign[repr(error)[:200]] += 1

    def _cycle(self) -> None:
        bench, rng = self.bench, self.rng
        self.n_cycles += 1
        bench.link.incoming = self._spoil
        self._command.torque[:] = [rng.uniform(-3.0, 3.0) * TORQUE_LIMIT for _ in range(N_JOINTS)]
        bench.adapter.write(self._command)
        bench.clock.advance(PERIOD)
        bench.adapter.read_into(self._feedback)

    def _recover(self) -> None:
        bench = self.bench
        bench.link.incoming = None
        for axis in bench.axes:
            axis.position = axis.velocity = 0.0
        bench.adapter.clear_faults()
        bench.adapter.enable()
        bench.clock.advance(PERIOD)

    def _spoil(self, traffic: Any) -> Any:
        self.n_frames += BATCH
        return self._spoil_bytes(traffic) if isinstance(traffic, bytes) else self._spoil_frames(list(traffic))

    def _spoil_frames(self, frames: list[CanFrame]) -> list[CanFrame]:
        rng = self.rng
        for frame in frames:
            if len(self._identifiers) < 64 and (frame.identifier, frame.extended) not in self._identifiers:
                self._identifiers.append((frame.identifier, frame.extended))
        made: list[CanFrame] = []
        for _ in range(BATCH):
            kind = rng.random()
            if kind < 0.4 and frames:  # a true frame, damaged, cut or repeated
                frame = rng.choice(frames)
                made.append(frame._replace(data=_damage(frame.data, rng)))
            elif kind < 0.6 and self._identifiers:  # random contents under a true identifier
                identifier, extended = rng.choice(self._identifiers)
                made.append(CanFrame(identifier, rng.randbytes(rng.randrange(9)), extended))
            else:
                extended = rng.random() < 0.3
                identifier = rng.randrange(1 << (29 if extended else 11))
                made.append(CanFrame(identifier, rng.randbytes(rng.randrange(9)), extended))
        keep = [frame for frame in frames if rng.random() < 0.7]
        mixed = made + keep
        rng.shuffle(mixed)
        return mixed

    def _spoil_bytes(self, data: bytes) -> bytes:
        rng = self.rng
        pieces = [data] if rng.random() < 0.7 else []
        for _ in range(BATCH):
            kind = rng.random()
            if kind < 0.5 and data:
                start = rng.randrange(len(data))
                pieces.append(_damage(data[start : start + rng.randrange(1, 60)], rng))
            elif kind < 0.6:
                pieces.append(rng.choice((b"\n", b"OK\n", b"rcv ", b"rcv 0100 ", b"\xff\xff\xfd\x00", b"\xff\xff\xfd")))
            else:
                pieces.append(rng.randbytes(rng.randrange(40)))
        rng.shuffle(pieces)
        return b"".join(pieces)


def _damage(data: bytes, rng: random.Random) -> bytes:
    """A bit flipped, the end cut off, or as it is."""
    kind = rng.random()
    if not data or kind < 0.2:
        return data
    if kind < 0.4:
        return data[: rng.randrange(len(data))]
    changed = bytearray(data)
    changed[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def resident_bytes() -> int:
    """Memory of this process; 0 where the system does not tell it this way."""
    if not sys.platform.startswith("linux"):
        return 0
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096
