"""The diagnosis of a recording that is too slow for the rows of the residual: by the torque in its band."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from fricomp.errors import DiagnosisError, ParameterError, RecordingError
from fricomp.evaluation import RecordedMotion, join_motions, read_motion
from fricomp.recording import Recording

from ..inputs.given import Given
from ..record.result import Diagnosis
from .models import write_plain_model
from .search import Found, choose_effects, fit_plain_joint
from .settings import LOW_RATE
from .writing import write_answer

Progress = Callable[[str], None]


def is_low_rate(recordings: Sequence[Recording]) -> bool:
    """Whether a recording is too slow for the rows of the residual."""
    return any(recording.sample_period > LOW_RATE.longest_period for recording in recordings)


@np.errstate(over="ignore")  # friction that falls over next to no speed
def diagnose_low_rate(given: Given, remarks: Sequence[str] = (), say: Progress | None = None) -> Diagnosis:
    """Compare a plain joint with one that has an effect of those that sliding shows, by their errors on data left out.

    Args:
        given: Checked recordings, one of them too slow for the rows of the residual.
        remarks: What is to be told besides.
        say: Called with a few words before each step.

    Raises:
        DiagnosisError: The recordings are too short, or hardly move.
    """
    given, short = _leave_out_short(given)
    try:
        motion, found = _search(given, say or (lambda words: None))
    except (RecordingError, ParameterError, np.linalg.LinAlgError) as error:
        raise DiagnosisError(f"the recording cannot be explained by any joint model: {error}") from error
    return write_answer(given, motion, found, (*remarks, *short))


@np.errstate(over="ignore")
def describe_slow_motion(given: Given) -> tuple[str, ...]:
    """Say what the slow part of faster recordings shows, of which their rows say that nothing explains it: a hint and
    no name, since what the rows show besides is not in it. Nothing where it shows nothing, or is too short.

    Args:
        given: Checked recordings.
    """
    try:
        slow, _ = _leave_out_short(replace(given, recordings=tuple(map(_average, given.recordings)), whole=()))
        motion, found = _search(slow, lambda words: None)
    except (RecordingError, ParameterError, np.linalg.LinAlgError):
        return ()
    if not found.named:
        return ()
    names = " with ".join(" or ".join((one.name, *one.alike)) for one in found.named)
    unit = motion.torque_unit
    return (
        f"Careful: the slow motion alone, in the band up to {motion.band:g} Hz, is explained better by {names}: the "
        f"error on data left out falls from {found.base.rms:.3g} to {found.last.rms:.3g} {unit}. A hint and no name.",
    )


def _average(recording: Recording) -> Recording:
    """The recording in means of as many rows as make the period at which slow motion is looked at."""
    rows = max(round(LOW_RATE.slow_period / recording.sample_period), 1)
    kept = len(recording) // rows * rows
    time, position, torque = (
        np.asarray(getattr(recording, name))[:kept].reshape(-1, rows).mean(axis=1)
        for name in ("time", "position", "torque")
    )
    return Recording(time, position, torque, metadata=recording.metadata)


def _search(given: Given, tell: Progress) -> tuple[RecordedMotion, Found]:
    """The motion in its band, and what it shows."""
    band = min(read_motion(one).band for one in given.recordings)
    motion = join_motions([read_motion(one, band=band) for one in given.recordings])
    period = max(one.sample_period for one in given.recordings)
    tell("fitting the plain joint")
    plain = write_plain_model(given.recordings, motion)
    base = fit_plain_joint(plain, motion, period)
    tell("trying what sliding shows at this rate")
    found = Found(_measure_repeats(given.recordings), (base,))
    return motion, found if found.is_held else choose_effects(base, motion, period, found.repeats, given.rigid)


def _leave_out_short(given: Given) -> tuple[Given, tuple[str, ...]]:
    """The parts that are long enough for a band, and a sentence on the others; all where none is."""
    long = [k for k, one in enumerate(given.recordings) if _is_long(one)]
    if not long or len(long) == len(given.recordings):
        return given, ()
    rest = [one.duration for k, one in enumerate(given.recordings) if k not in long]
    kept = replace(
        given,
        recordings=tuple(given.recordings[k] for k in long),
        names=tuple(given.names[k] for k in long),
        loops=tuple(given.loops[k] for k in long),
    )
    return kept, (f"Left out: {len(rest)} part(s) too short for this rate, {sum(rest):.3g} s in all.",)


def _is_long(recording: Recording) -> bool:
    try:
        read_motion(recording)
    except RecordingError:
        return False
    return True


def _measure_repeats(recordings: Sequence[Recording]) -> float:
    """Part of the rows in motion whose position is that of the one before."""
    same = [np.zeros(0, dtype=bool)]
    for one in recordings:
        position = np.asarray(one.position)
        steps = np.abs(np.diff(position))
        usual = float(np.median(steps[steps > 0.0])) if steps.any() else np.inf
        near = LOW_RATE.neighbours
        moved = np.abs(position[2 * near :] - position[: -2 * near]) > usual
        same.append(steps[near - 1 : near - 1 + moved.size][moved] == 0.0)
    joined = np.concatenate(same)
    return float(np.mean(joined)) if joined.size else 0.0
