"""Positions without a unit that can be nothing but degrees, by what they do."""

from collections.abc import Mapping, MutableMapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

from .column import ColumnMeaning

_TURN, _HALF = 360.0, 180.0
_RADIAN = np.pi / _HALF
_NEAR = 0.2
"""Part of a turn by which a step may differ from a whole one, as the joint moves on in it."""
_SAME = 0.2
"""Relative error within which a velocity is the rate of a position."""
_TWO_TURNS = 4.0 * np.pi
"""Travel above which few joints of an arm are [rad], and where none of them rests."""
_RESTS = 0.01
"""Part of the largest travel of a log's joints below which one holds still."""
_FEWEST_JOINTS = 3
_POSITIONS = ("position", "position_reference")
_VELOCITIES = ("velocity", "velocity_reference")


def read_wrapped_degrees(
    table: MutableMapping[str, Samples], own: MutableMapping[str, tuple[str, ColumnMeaning]]
) -> bool:
    """Turn a position into rad whose name states no unit and that goes round from 360 to 0 or from 180 to -180.

    A velocity without a unit goes with it where it is the rate of the degrees.

    Args:
        table: Channels of a joint; shape (n_rows,) each.
        own: Column and meaning of each; the unit is written into those that were turned.

    Returns:
        Whether it was one.
    """
    position = table["position"]
    if own["position"][1].unit or not own["position"][0] or not _wraps(position):
        return False
    step = np.diff(position)
    with np.errstate(divide="ignore", invalid="ignore"):  # stamps that come twice
        rate = (step - _TURN * np.round(step / _TURN)) / np.diff(table["time"])
    for channel in (*_POSITIONS, *_VELOCITIES):
        if channel not in table or own[channel][1].unit or not own[channel][0]:
            continue
        if channel in _VELOCITIES and not _is_rate(table[channel][1:], rate):
            continue
        unit = "deg" if channel in _POSITIONS else "deg/s"
        table[channel] = table[channel] * _RADIAN
        own[channel] = (own[channel][0], replace(own[channel][1], unit=unit))
    return True


def _wraps(position: Samples) -> bool:
    way = np.ptp(position)
    if way <= _HALF or _TURN < way < np.inf:  # of a missing number neither is so
        return False
    finite = position[np.isfinite(position)]
    steps = np.abs(np.diff(finite))
    far = steps[steps > _HALF]
    if not far.size or np.ptp(finite) > _TURN:
        return False
    return bool(np.all(np.abs(far - _TURN) < _NEAR * _TURN))


def _is_rate(velocity: Samples, rate: Samples) -> bool:
    """Whether a velocity is a rate, slope and all."""
    known = np.isfinite(velocity) & np.isfinite(rate)
    square = float(rate[known] @ rate[known])
    return square > 0.0 and abs(float(velocity[known] @ rate[known]) / square - 1.0) < _SAME


def refuse_arm_in_degrees(
    path: Path,
    recordings: Sequence[Recording],
    sources: Mapping[str, Mapping[str, tuple[str, ColumnMeaning]]],
) -> None:
    """Refuse to take for rad what the joints of an arm cover, and where one of them rests, if that is many turns.

    Raises:
        RecordingError: No unit is stated, and it is.
    """
    travel = [float(np.ptp(one.position)) for one in recordings]
    rests = [one for one, way in zip(recordings, travel, strict=True) if way < _RESTS * max(travel)]
    farthest = max((float(np.max(np.abs(one.position))) for one in rests), default=0.0)
    k = int(np.argmax(travel))
    column, meaning = sources[recordings[k].metadata.joint]["position"]
    is_arm = len(recordings) >= _FEWEST_JOINTS and recordings[k].metadata.motion == "rotary"
    if not is_arm or meaning.unit or meaning.certainty >= 3 or min(travel[k], 2.0 * farthest) < _TWO_TURNS:
        return
    raise RecordingError(
        f"{path}: {column!r} states no unit and covers {travel[k]:.4g}, and a joint that rests is at {farthest:.4g}, "
        f"in rad many turns. Say in a mapping which it is, such as position = {{ column = {column!r}, unit = "
        "\"deg\" } ('fricomp convert LOG --inspect --out log.toml' begins one), or --channel position=NAME for rad"
    )
