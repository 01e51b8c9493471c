"""A recording cut into its usable parts: what is left out, why, and what is left.

The order matters: a counter is unwrapped before anything is called a jump, others' rows are left out before the rate
is told, held rows and long rests before the clock, whose grid is laid through each part between
them. Nothing is invented: rows are left out or given a better stamp, never filled in.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.new_zero import join_zeros
from fricomp.recording.checks.position_size import find_sign_bit, turn_sizes
from fricomp.recording.checks.quantum import ONE_TURN, TURN_IN_DEGREES
from fricomp.recording.checks.register import Register, find_fold, find_register, read_signed, unfold
from fricomp.recording.checks.stuck import find_idle_rows, find_stuck_rows
from fricomp.recording.checks.timing_checks import find_gap_length, locate_rate_change
from fricomp.recording.clock import Clock, mend_clock
from fricomp.recording.parts.bursts import spread_bursts
from fricomp.recording.parts.holds import find_stale_rows, thin_held_rows
from fricomp.recording.parts.missing import count_missing_rows
from fricomp.recording.parts.rests import find_rests
from fricomp.recording.parts.silent import find_silent_rows
from fricomp.recording.parts.strays import find_wild_torque, follow_motion, unwrap_position
from fricomp.recording.recording import Recording
from fricomp.recording.resampling import resample
from fricomp.recording.validity import Samples

Rows = NDArray[np.bool_]
SHORTEST_PART = 1.0
"""Length below which a part is left out: slow and fast motion and a reversal do not fit into it [s]."""
_BRIDGED = 0.03
"""Gap that is no cut [s], where all of them are short: a straight line over it is off by less than a low-pass sees."""
_MOST_BRIDGED = 0.05
"""Part of the time that may be bridged."""
_MOST_STUCK = 0.5
"""Part of the rows above which stuck ones are not left out."""
_FEWEST = 25
"""Rows below which a part is left out."""


@dataclass(frozen=True)
class LeftOut:
    """Rows that were left out for one reason.

    Attributes:
        reason: What they are, in the plural: "rows of another publisher or outliers of position".
        rows: How many.
        duration: Time that they took [s].
    """

    reason: str
    rows: int
    duration: float


@dataclass(frozen=True)
class UsableParts:
    """What of a recording can be used.

    Attributes:
        source: The recording as it is.
        kept: All rows that stay, in one recording with gaps.
        parts: The same between the gaps, in order; those that are too short are left out here alone.
        left_out: What was left out, by reason.
        clock: What its stamps are worth.
        changes: Sentences on what was done to the rows that stay.
        rows: Rows of the source.
        duration: Of the source [s].
    """

    source: Recording
    kept: Recording
    parts: tuple[Recording, ...]
    left_out: tuple[LeftOut, ...]
    clock: Clock
    changes: tuple[str, ...]
    rows: int
    duration: float

    @property
    def sentences(self) -> tuple[str, ...]:
        """What was left out and how much is left, in one sentence, and what was done to the rest."""
        used = sum(part.duration for part in self.parts)
        if not self.left_out and len(self.parts) == 1:
            return self.changes
        what = "; ".join(f"{one.rows} {one.reason} ({one.duration:.3g} s)" for one in self.left_out)
        rows = sum(map(len, self.parts))
        count = "one part" if len(self.parts) == 1 else f"{len(self.parts)} parts"
        said = f"Used: {used:.4g} of {self.duration:.4g} s in {count}, {rows} of {self.rows} rows"
        return (f"{said}{'; left out: ' + what if what else ''}.", *self.changes)


def find_usable_parts(recording: Recording) -> UsableParts:
    """Cut a recording into its usable parts; one without flaws is its own only part, unchanged.

    What is not mended here, such as a flipped sign, is told by `check_recording` of the parts.
    """
    spread, bursts = spread_bursts(recording)
    unwrapped = _unwrap_position(spread)
    if unwrapped is None:
        return _leave_whole(recording)  # the checks say what to write: a velocity may be in either unit
    whole, turned = unwrapped
    whole, zeroed = join_zeros(whole)
    whole, unfolded = _read_true_torque(whole)
    whole, jumps, strays = _leave_strays(whole)
    whole, missing = count_missing_rows(whole)
    whole, thinned, rests = _leave_rests(whole)
    whole, begins, clock, slowed = _even_rate(whole, jumps)
    stuck = find_stuck_rows(whole)
    if stuck.mean() > _MOST_STUCK:  # then it is what was recorded, and the checks say what it looks like
        stuck[:] = False
    idle = find_idle_rows(whole) | find_silent_rows(whole)
    useless = (
        _tell("rows in which the drive gives no torque while the joint is moved", whole, idle),
        _tell("rows of stuck or saturated stretches", whole, stuck & ~idle),
    )
    kept, parts, short = _cut(whole, ~(stuck | idle), begins)
    left_out = tuple(one for one in (*strays, rests, *useless, short) if one.rows)
    arrived = () if bursts is None else (bursts.sentence,)
    counted = () if missing is None else (missing.sentence,)
    changes = (*arrived, *turned, *zeroed, *unfolded, *counted, *thinned, *slowed)
    return UsableParts(recording, kept, parts, left_out, clock, changes, len(recording), recording.duration)


def _unwrap_position(recording: Recording) -> tuple[Recording, tuple[str, ...]] | None:
    """The recording with a counter of turns unwrapped, and a sentence on it; None where it counts degrees or turns.

    A size with its sign in a bit of its register is read as signed.
    """
    signed = find_sign_bit(np.asarray(recording.position))
    if signed is not None:
        read = turn_sizes(np.asarray(recording.position), *signed)
        said = f"Position: a size with its sign in bit {signed[0]} of its register; it was read as signed"
        return recording.with_channels(position=read), (f"{said} (sign_bit in a mapping does it for good).",)
    whole, wrap = unwrap_position(recording)
    if wrap is None:
        return whole, ()
    if recording.metadata.motion == "rotary" and wrap.period in (ONE_TURN, TURN_IN_DEGREES):
        return None
    unit = recording.metadata.position_unit
    return whole, (f"Position: it wraps round {wrap.times} time(s), and was unwrapped by {wrap.period:.6g} {unit}.",)


def _read_true_torque(whole: Recording) -> tuple[Recording, tuple[str, ...]]:
    """The recording with the torque as it was before it was stored in too small a register, and sentences on it."""
    changes, unit = [], whole.metadata.torque_unit
    whole, register = _read_signed_torque(whole)
    if register is not None:
        changes.append(
            f"Torque: a signed number of {register.bits} bits that was read as an unsigned one; it was read as signed "
            f"(signed_range = {register.span:.6g} [{unit}] in a mapping does it for good)."
        )
    span = find_fold(whole)
    if span is not None:
        whole = whole.with_channels(torque=unfold(np.asarray(whole.torque), span))
        changes.append(
            f"Torque: it is larger than its register holds, and was unfolded by {span:.6g} {unit} (unwrap = "
            f"{span:.6g} in a mapping does it for good)."
        )
    return whole, tuple(changes)


def _leave_strays(whole: Recording) -> tuple[Recording, Samples, tuple[LeftOut, ...]]:
    """The recording without rows of others and outliers, times at which it jumps [s], and what was left out."""
    followed = follow_motion(whole)
    jumps = np.asarray(whole.time)[followed.cuts]
    others = _tell("rows of another publisher or outliers of position", whole, ~followed.keep)
    whole = _select(whole, followed.keep)
    wild = find_wild_torque(whole)
    failed = _tell("rows whose reading of torque failed and was logged as 0", whole, wild.failed)
    outliers = _tell("rows with an outlier of torque", whole, wild.outliers)
    whole = _select(whole, ~wild.rows)
    stale = find_stale_rows(whole)
    repeats = _tell("rows that repeat the one before while the joint moves", whole, stale)
    return _select(whole, ~stale), jumps, (others, failed, outliers, repeats)


def _leave_rests(whole: Recording) -> tuple[Recording, tuple[str, ...], LeftOut]:
    """The recording without rows that repeat the one before, a sentence on them, and without long rests."""
    thinned, hold = thin_held_rows(whole)
    changes: tuple[str, ...] = ()
    if hold is not None:
        changes = (
            f"Rate: {hold.left_out} of {len(whole)} rows repeat the one before; the readings come at "
            f"{1.0 / thinned.sample_period:.4g} Hz, which was used.",
        )
        whole = thinned
    rests = find_rests(whole)
    return _select(whole, ~rests), changes, _tell("rows of long rests", whole, rests)


def _even_rate(whole: Recording, jumps: Samples) -> tuple[Recording, Rows, Clock, tuple[str, ...]]:
    """The recording with even stamps of one rate, its rows after a jump, what its clock is worth, and sentences."""
    even, clock = mend_clock(whole)
    changes = (clock.sentence,) if clock.mended else ()
    rates = locate_rate_change(even)
    if rates is None or rates.mixed:
        return even, _mark_jumps(whole, jumps), clock, changes
    even = resample(even, rates.slow)
    said = f"Rate: it changes from {rates.fast:.4g} to {rates.slow:.4g} Hz; all was brought to the latter."
    return even, _mark_jumps(even, jumps), clock, (*changes, said)


def _mark_jumps(recording: Recording, jumps: Samples) -> Rows:
    """The first row at or after each of these times [s]."""
    rows = np.zeros(len(recording), dtype=bool)
    rows[np.minimum(np.searchsorted(recording.time, jumps), len(recording) - 1)] = bool(jumps.size)
    return rows


def _leave_whole(recording: Recording) -> UsableParts:
    """The recording as it is."""
    clock = Clock(recording.sample_period, 0.0, 0.0, mended=False)
    return UsableParts(recording, recording, (recording,), (), clock, (), len(recording), recording.duration)


def _read_signed_torque(recording: Recording) -> tuple[Recording, Register | None]:
    """The recording with a torque that has its signs, where the steps of the torque tell what it was stored in."""
    register = find_register(recording)
    if register is None or not register.sure or recording.torque.max() < -recording.torque.min():
        return recording, None
    return recording.with_channels(torque=read_signed(np.asarray(recording.torque), register.span)), register


def _tell(reason: str, recording: Recording, rows: Rows) -> LeftOut:
    count = int(np.count_nonzero(rows))
    return LeftOut(reason, count, count * recording.sample_period)


def _select(recording: Recording, keep: Rows) -> Recording:
    return recording if keep.all() or np.count_nonzero(keep) < 2 else recording.rows(keep)


def _cut(recording: Recording, keep: Rows, jumps: Rows) -> tuple[Recording, tuple[Recording, ...], LeftOut]:
    """All rows that stay, the parts that are long enough, and what is too short."""
    if np.count_nonzero(keep) < 2:
        keep = np.ones(len(recording), dtype=bool)
    rows = np.flatnonzero(keep)
    step = np.diff(recording.time[rows])
    gaps = step > find_gap_length(recording)
    short = gaps & (step <= _BRIDGED)
    if np.sum(step[short]) <= _MOST_BRIDGED * recording.duration:
        gaps &= ~short
    begins = np.concatenate([[False], gaps]) | jumps[rows]
    edges = [0, *np.flatnonzero(begins[1:]) + 1, rows.size]
    spans = [rows[a:b] for a, b in pairwise(edges)]
    if len(spans) == 1:
        kept = _select(recording, keep)
        return kept, (kept,), LeftOut("", 0, 0.0)
    long = [span for span in spans if _is_long(recording, span)]
    if not long:
        long = [max(spans, key=len)]
    others = [span for span in spans if not any(span is one for one in long)]
    time = sum(float(recording.time[span[-1]] - recording.time[span[0]]) for span in others)
    parts = tuple(_part(recording, span) for span in long if span.size >= 2)
    kept = recording.rows(np.concatenate(long)) if sum(map(len, long)) >= 2 else recording
    return kept, parts or (recording,), LeftOut("rows of parts too short", sum(map(len, others)), time)


def _is_long(recording: Recording, span: NDArray[np.intp]) -> bool:
    return bool(span.size >= _FEWEST and recording.time[span[-1]] - recording.time[span[0]] >= SHORTEST_PART)


def _part(recording: Recording, span: Sequence[int] | NDArray[np.intp]) -> Recording:
    return recording.rows(np.asarray(span, dtype=np.intp))
