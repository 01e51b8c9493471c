"""The model that is written, held against all of a long recording, of which the search saw stretches alone."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.evaluation import RecordedMotion, compute_missing_torque, find_friction_change, read_motion
from fricomp.model import FrictionModel
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..inputs.checks import PART_OF
from ..inputs.track import FloatArray
from .settings import DELIVERY


class _Window(NamedTuple):
    start: float
    end: float
    error: float
    searched: bool
    rows: int


def look_over_whole(
    model: FrictionModel, whole: Sequence[Recording], searched: Sequence[Recording], band: float, *, complete: bool
) -> list[str]:
    """What a model leaves where nothing was searched, and whether friction changes over the time, in sentences.

    Args:
        model: As it is written.
        whole: All that is usable, on the joint's side; empty where all of it was searched, of which nothing is said.
        searched: Stretches of it.
        band: Upper end of the band of torque errors [Hz].
        complete: Whether the model holds all that was named; what it leaves at times says nothing where it does not.
    """
    if not whole:
        return []
    windows, said = list[_Window](), list[str]()
    for number in dict.fromkeys(one.metadata.extra[PART_OF] for one in whole):
        parts = [one for one in whole if one.metadata.extra[PART_OF] == number]
        spans = [(one.time[0], one.time[-1]) for one in searched if one.metadata.extra[PART_OF] == number]
        motions = [motion for part in parts if (motion := _read(part, band)) is not None]
        left = [compute_missing_torque(model, motion) for motion in motions]
        windows += [one for m, each in zip(motions, left, strict=True) for one in _list_windows(m, each, spans)]
        said += _describe_change(motions, left)
    unit = whole[0].metadata.torque_unit
    return [*_describe_rest(windows, unit), *(_describe_event(windows, unit) if complete else ()), *said]


def _read(part: Recording, band: float) -> RecordedMotion | None:
    try:
        return read_motion(part, band=band)
    except RecordingError:  # it rests, or is too short: it says nothing
        return None


def _find_clear_motion(motion: RecordedMotion) -> list[NDArray[np.bool_]]:
    """Rows of each part in which the joint is not about to stick. Shapes (n,)."""
    speeds = [np.abs(part.smooth_velocity) for part in motion.parts]
    top = float(np.quantile(np.concatenate(speeds), 0.98))
    return [
        part.moves & (speed > DELIVERY.clearly_moves * top) for part, speed in zip(motion.parts, speeds, strict=True)
    ]


def _list_windows(
    motion: RecordedMotion, left: Sequence[FloatArray], spans: Sequence[tuple[float, float]]
) -> list[_Window]:
    """The error in each stretch of time in which the joint moves."""
    found = []
    for part, each, clearly in zip(motion.parts, left, _find_clear_motion(motion), strict=True):
        size = max(1, round(DELIVERY.window / part.dt))
        for first, last in pairwise(range(0, part.time.size + size, size)):
            moves = clearly[first:last]
            if np.count_nonzero(moves) < DELIVERY.window_moves * size:
                continue
            start = float(part.time[first])
            middle = start + 0.5 * size * part.dt
            seen = any(begin <= middle <= end for begin, end in spans)
            error = compute_rms(each[first:last][moves])
            found.append(_Window(start, start + size * part.dt, error, seen, int(np.count_nonzero(moves))))
    return found


def _describe_rest(windows: Sequence[_Window], unit: str) -> list[str]:
    seen, rest = ([one for one in windows if one.searched is side] for side in (True, False))
    if not seen or not rest:
        return []
    errors = [
        float(np.sqrt(np.average([one.error**2 for one in side], weights=[one.rows for one in side])))
        for side in (rest, seen)
    ]
    times = [sum(one.end - one.start for one in side) for side in (rest, seen)]
    said = (
        f"Careful: of a long recording {times[1]:.4g} s were searched, in stretches from all of its time; in the other "
        f"{times[0]:.4g} s friction.json leaves {errors[0]:.3g} {unit} of the torque of a joint that slides, in these "
        f"{errors[1]:.3g} {unit}."
    )
    return [said]


def _describe_event(windows: Sequence[_Window], unit: str) -> list[str]:
    """A few windows in which far more is left than in the others."""
    usual = float(np.median([one.error for one in windows]))
    loud = [one for one in windows if one.error > DELIVERY.stands_out * usual]
    if not 0 < len(loud) <= DELIVERY.most_standing_out * len(windows):
        return []
    first, last, most = loud[0].start, max(one.end for one in loud), max(one.error for one in loud)
    return [
        f"Careful: between {first:.4g} and {last:.4g} s it leaves up to {most:.3g} {unit}, mostly elsewhere "
        f"{usual:.3g} {unit}: something acts there that does not act at other times. Diagnose what is before and "
        "after without it (fricomp convert --from, --to)."
    ]


def _describe_change(motions: Sequence[RecordedMotion], left: Sequence[Sequence[FloatArray]]) -> list[str]:
    rows = [
        (part.time[rows], each[rows], part.torque[rows], part.smooth_velocity[rows])
        for motion, parts in zip(motions, left, strict=True)
        for part, each, rows in zip(motion.parts, parts, _find_clear_motion(motion), strict=True)
    ]
    if not rows:
        return []
    change = find_friction_change(*map(np.concatenate, zip(*rows, strict=True)))
    return [] if change is None else [f"Careful: {change.describe(motions[0].torque_unit)}."]
