"""Positions of joints that turn without end, which encoders count within one turn: 0 to 360 degrees, or ±π."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.recording import Recording

_TURNS = (2.0 * np.pi, 360.0)
"""[rad] of a turn, and degrees that are not known to be such yet."""

_LEAST_STEP = 0.8
"""Part of a turn that a position jumps by at least where it wraps: the rest is the way of the joint in that step."""

_MOST_RANGE = 1.02
"""Part of a turn within which all of a position lies that wraps."""

_GAP = 5.0
"""Usual times between rows, from which on nobody knows how far a joint went."""


def unwrap_turns(recordings: Sequence[Recording], rotary: Sequence[bool]) -> tuple[list[Recording], tuple[str, ...]]:
    """Recordings whose positions go on where they wrapped round at a turn, and the joints of which that is so.

    Args:
        recordings: One of each joint.
        rotary: Whether each joint turns.
    """
    whole, wrapped = [], []
    for one, turns in zip(recordings, rotary, strict=True):
        turn = _find_turn(one) if turns else None
        whole.append(one if turn is None else _unwrap(one, turn))
        if turn is not None:
            wrapped.append(one.metadata.joint)
    return whole, tuple(wrapped)


def _find_turn(recording: Recording) -> float | None:
    """How far a position jumps where it wraps; None where it does not, or jumps otherwise as well."""
    position, between = np.asarray(recording.position), np.diff(recording.time)
    step = np.abs(np.diff(position))[between < _GAP * np.median(between)]
    for turn in _TURNS:
        wraps = step > _LEAST_STEP * turn
        goes_on = np.all(step[~wraps] < (1.0 - _LEAST_STEP) * turn)
        if np.any(wraps) and goes_on and np.ptp(position) < _MOST_RANGE * turn:
            return turn
    return None


def _unwrap(recording: Recording, turn: float) -> Recording:
    changed = {"position": np.unwrap(recording.position, period=turn)}
    for name in ("motor_position", "position_reference"):
        if (values := getattr(recording, name)) is not None:
            changed[name] = values + turn * np.round((changed["position"] - values) / turn)
    return recording.with_channels(**changed)
