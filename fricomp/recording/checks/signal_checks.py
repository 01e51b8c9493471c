"""Checks of single channels: no motion, mostly rest, and spikes."""

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_position_step

_FEW_STEPS = 20  # encoder steps of travel below which only presliding can be seen
_REST_PART = 0.5  # part of the time at rest that deserves a word
_SPIKE_FACTOR = 25.0
_SPIKES_ARE = {
    "position": "identify and diagnose leave these rows out",
    "torque": "identify and diagnose leave out those that the joint does not answer by its acceleration",
}


def find_rest(recording: Recording) -> tuple[Finding, ...]:
    """No motion at all, motion of a few encoder steps, or mostly rest."""
    position = recording.position
    travel = float(np.ptp(position))
    unit = recording.metadata.position_unit
    if travel == 0:
        message = f"the joint never moves: position is {position[0]:g} {unit} throughout"
        return (Finding("no_motion", "error", message, "record a motion", column="position"),)
    step = recording.metadata.encoder_resolution or find_position_step(position)
    if step is not None and travel < _FEW_STEPS * step:
        message = f"the joint moves by {travel / step:.0f} encoder steps in all: sliding friction cannot be seen"
        return (Finding("no_sliding", "warning", message, "record a larger motion", column="position"),)
    moving = _moving(recording, travel)
    if not moving.any():
        return ()
    if 1 - moving.mean() > _REST_PART:
        message = f"the joint rests for {100 * (1 - moving.mean()):.0f} % of the {recording.duration:.4g} s"
        advice = "cut the rests, or weigh them knowingly"
        return (Finding("rest", "note", message, advice, column="position"),)
    return ()


def find_spikes(recording: Recording) -> tuple[Finding, ...]:
    """Single samples far from both neighbours."""
    found = []
    for name in ("position", "velocity", "torque", "current"):
        values = recording.channels.get(name)
        if values is None or values.size < 50 or (name == "current" and np.array_equal(values, recording.torque)):
            continue
        middle = np.median(np.stack([values[:-2], values[1:-1], values[2:]]), axis=0)
        excess = np.abs(values[1:-1] - middle)
        if not excess.any():
            continue
        limit = max(_SPIKE_FACTOR * float(np.percentile(excess[excess > 0], 75)), 0.2 * float(np.ptp(middle)))
        spikes = np.flatnonzero(excess > limit)
        if spikes.size:
            row = int(spikes[0]) + 1
            message = f"{spikes.size} single sample(s) far from their neighbours, the first {values[row]:.5g}"
            advice = _SPIKES_ARE.get(name, "remove these rows")
            found.append(Finding("spike", "warning", message, advice, row + 1, name))
    return tuple(found)


def _moving(recording: Recording, travel: float) -> NDArray[np.bool_]:
    """Blocks of 0.25 s, or of five samples, in which the joint moves by more than 1e-4 of its travel.

    It is looked at four times in a block: a swing of a block's length ends where it began.
    """
    rows = max(5, round(0.25 / recording.sample_period))
    starts = np.arange(0, len(recording) - rows, rows)
    looks = [starts + round(0.25 * part * rows) for part in range(1, 5)]
    reach = np.max([np.abs(recording.position[look] - recording.position[starts]) for look in looks], axis=0)
    step = recording.metadata.encoder_resolution or 0.0
    return np.asarray(reach > max(1e-4 * travel, 1.5 * step))
