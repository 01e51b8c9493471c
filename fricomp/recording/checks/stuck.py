"""Channels that keep one value while the joint moves: stuck, at their limit, or of a drive that is off."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.quantum import measure_quantum, read_at_rest
from fricomp.recording.checks.timing_checks import GAP_PERIODS
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_CHANNELS = ("velocity", "acceleration", "current", "load_torque", "torque", "position")
_FEWEST_STEPS = 20  # encoder steps of travel below which a channel cannot be told to be stuck
_STUCK_TIME = 0.25  # [s]
_STUCK_ROWS = 20
_IDLE_TIME = 2.0  # [s] of a torque of exactly zero in motion; a held reading is no drive that is off
_STUCK_TRAVEL = 0.05  # part of the travel covered while the channel stands still
_STUCK_SHARE = 0.02  # step of a channel over its deviation, above which it may keep a value for long
_BEYOND_LAG = 2.0  # usual distances from the reference, that it must move while the position stays


def find_stuck(recording: Recording) -> tuple[Finding, ...]:
    """A channel that keeps one value, bit for bit, while the joint goes on moving."""
    found = []
    for name, runs in _stuck_channels(recording).items():
        if runs:
            found.append(_describe_stuck(recording, name, *runs[0]))
    return tuple(found)


def find_stuck_rows(recording: Recording) -> NDArray[np.bool_]:
    """Rows in which position or torque is stuck or at its limit while the joint goes on moving. Shape (n_samples,)."""
    rows = np.zeros(len(recording), dtype=bool)
    for runs in _stuck_channels(recording, ("position", "torque")).values():
        for start, stop in runs:
            rows[start : stop + 1] = True
    return rows


def find_idle_rows(recording: Recording) -> NDArray[np.bool_]:
    """Rows of long stretches in which the torque is exactly zero while the joint moves: its drive is off then.

    Another motor or a hand moves the joint, and what friction takes is not in the torque. Shape (n_samples,).
    """
    rows = np.zeros(len(recording), dtype=bool)
    if recording.metadata.torque_kind == "commanded":
        return rows
    for start, stop in _stuck_channels(recording, ("torque",)).get("torque", []):
        if recording.torque[start] == 0.0 and recording.time[stop] - recording.time[start] > _IDLE_TIME:
            rows[start : stop + 1] = True
    return rows if np.count_nonzero(~rows) > _STUCK_ROWS else np.zeros(len(recording), dtype=bool)


def _stuck_channels(recording: Recording, wanted: Sequence[str] = _CHANNELS) -> dict[str, list[tuple[int, int]]]:
    """First and last rows of each stretch in which a channel is stuck, by channel; of those that are wanted alone."""
    travel = float(np.ptp(recording.position))
    if travel < _FEWEST_STEPS * (recording.metadata.encoder_resolution or 0.0) or travel == 0:
        return {}
    kept = {"torque"} if recording.metadata.torque_kind == "commanded" else set[str]()
    return {
        name: _find_stuck(
            recording, name, _claimed_motion(recording) if name == "position" else recording.position, travel
        )
        for name in wanted
        if name not in kept
    }


def _find_stuck(recording: Recording, name: str, motion: Samples | None, travel: float) -> list[tuple[int, int]]:
    """First and last rows of each stretch in which a channel is stuck though it could have shown the motion."""
    values = recording.channels.get(name)
    if values is None or motion is None:
        return []
    coarse = name != "position" and measure_quantum(values) > _STUCK_SHARE * float(np.std(values))
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values) != 0) + 1])
    stops = np.concatenate([starts[1:], [values.size]]) - 1
    duration = recording.time[stops] - recording.time[starts]
    found = []
    for run in np.flatnonzero((duration >= _STUCK_TIME) & (stops - starts >= _STUCK_ROWS)):
        start, stop = int(starts[run]), int(stops[run])
        moved = float(np.ptp(motion[start : stop + 1]))
        explained = abs(values[start]) * duration[run] if name == "velocity" else 0.0
        usual = _usual_lag(recording, start, stop) if motion is recording.position_reference else 0.0
        extreme = abs(values[start]) == np.abs(values).max() > 0
        if coarse and not (extreme and name == "torque"):
            continue
        if moved > max(_STUCK_TRAVEL * travel, _BEYOND_LAG * usual) and abs(moved - explained) > 0.25 * moved:
            found.append((start, stop))
    return found


def _claimed_motion(recording: Recording) -> Samples | None:
    """Motion as another channel than position tells it [as position].

    A velocity counts as far as it is beyond what it reads at rest: a register has counts and a code may have no zero.
    """
    if recording.velocity is None:
        return recording.position_reference
    at_rest = read_at_rest(recording)
    velocity = recording.velocity - at_rest.bias
    velocity = np.where(np.abs(velocity) > at_rest.width, velocity, 0.0)
    step = np.minimum(np.diff(recording.time), GAP_PERIODS * recording.sample_period)  # nothing is claimed over gaps
    return np.concatenate([[0.0], np.cumsum(velocity[:-1] * step)])


def _usual_lag(recording: Recording, start: int, stop: int) -> float:
    """How far the joint lags behind its reference elsewhere: a soft loop stays that long in stiction [as position]."""
    assert recording.position_reference is not None
    lag = np.delete(np.abs(recording.position_reference - recording.position), slice(start, stop + 1))
    return float(np.quantile(lag, 0.95)) if lag.size else 0.0


def _describe_stuck(recording: Recording, name: str, start: int, stop: int) -> Finding:
    values = recording.channels[name]
    duration = recording.time[stop] - recording.time[start]
    message = f"{name} stays at {values[start]:.5g} for {duration:.3g} s"
    if name == "position":
        teller = "velocity" if recording.velocity is not None else "position_reference"
        message += f" while {teller} says that the joint moves"
        return Finding("stuck", "warning", message, "one of the two is wrong: check both", start + 1, name)
    message += " while the joint moves"
    if abs(values[start]) == np.abs(values).max() > 0:
        return Finding("saturated", "warning", message, "it may be at its limit: drive less", start + 1, name)
    return Finding("stuck", "warning", message, "check the sensor or leave these rows out", start + 1, name)
