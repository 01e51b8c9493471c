"""The gear between a motor and its joint, as far as their motions show it."""

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.recording.recording import Recording

from .column import ColumnMeaning

GEARED = 1.5
"""Motor turns a turn of the joint from which on there is a gear between them."""
_WHOLE = 2e-3
"""Part by which a ratio may miss a whole number that it is taken for: a gear that twists under gravity bends it."""
_FOLLOWS = 0.9
"""Part of the power of a motor's velocity that follows the joint's position, from which on its gear is told by them."""


def find_gear(recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]]) -> float:
    """Turns of the motor a turn of the joint, by its own encoder or the velocity that is called its; 1 without both."""
    if np.ptp(recording.position) == 0.0:
        return 1.0
    if recording.motor_position is not None:
        return float(np.polyfit(recording.position, recording.motor_position, 1)[0])
    if recording.velocity is None or not _is_of_motor("velocity", own) or _is_of_motor("position", own):
        return 1.0
    rate = np.gradient(recording.position, recording.time)
    if np.corrcoef(rate, recording.velocity)[0, 1] ** 2 < _FOLLOWS:
        return 1.0
    return float(np.polyfit(rate, recording.velocity, 1)[0])


def is_motors_velocity(recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]]) -> bool:
    """Whether a recording has the velocity of its motor: by the name, or without an encoder of its own by the gear.

    Args:
        recording: Of a joint behind a gear.
        own: Column and meaning by channel.
    """
    has_encoder = recording.motor_position is not None
    return recording.velocity is not None and (not has_encoder or _is_of_motor("velocity", own))


def _is_of_motor(channel: str, own: Mapping[str, tuple[str, ColumnMeaning]]) -> bool:
    return re.search("motor|rotor|_m$", own[channel][0], re.IGNORECASE) is not None


def bring_to_joint(
    path: Path, recording: Recording, ratio: float, own: dict[str, tuple[str, ColumnMeaning]]
) -> tuple[Recording, list[str]]:
    """The recording with its motor's position on the joint's side of the gear, and what to write of it.

    Args:
        path: Of the file, for messages.
        recording: With a motor's position as it was logged.
        ratio: Turns of the motor a turn of the joint.
        own: Column and meaning of the joint by channel; the motor's gets its scale.
    """
    if recording.motor_position is None or abs(ratio) < GEARED:
        return recording, []
    whole = float(round(ratio))
    ratio = whole if abs(ratio - whole) < _WHOLE * abs(ratio) else ratio
    name, meaning = own["motor_position"]
    own["motor_position"] = name, replace(meaning, scale=1.0 / ratio)
    note = (
        f"{path.name}: {name!r} moves {ratio:.5g} times as far as the joint and was divided by that; where the ratio "
        f"is known better, write motor_position = {{ column = {name!r}, scale = 1/RATIO }} with the number worked out "
        "in a mapping."
    )
    return recording.with_channels(motor_position=np.asarray(recording.motor_position) / ratio), [note]


def say_gear(path: Path, ratio: float, own: Mapping[str, tuple[str, ColumnMeaning]]) -> list[str]:
    """What to write where a torque that is called the motor's may be that before a gear which its motion shows."""
    if abs(ratio) < GEARED or not _is_of_motor("torque", own):
        return []
    return [
        f"{path.name}: the motor moves {ratio:.4g} times as far as the joint, and {own['torque'][0]!r} is called its "
        f'torque: where that is before the gear, write torque_side = "motor" and gear_ratio = {ratio:.4g} under '
        "[metadata] of a mapping."
    ]
