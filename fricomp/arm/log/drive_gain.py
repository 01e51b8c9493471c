"""Torques of joints whose currents were recorded: what one ampere is worth, gear included."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording import Recording

_TORQUES = ("N·m", "N")


def find_drive_gain(recording: Recording) -> float | None:
    """Torque of one ampere as the metadata say it [N·m/A] or [N/A]; None where they do not.

    `drive_gain` is that of the joint; `torque_constant` is that of the motor, and takes the gear ratio beside it.
    """
    extra, ratio = recording.metadata.extra, recording.metadata.gear_ratio
    gain, constant = extra.get("drive_gain"), extra.get("torque_constant")
    if isinstance(gain, int | float):
        return float(gain)
    return float(constant) * ratio if isinstance(constant, int | float) and ratio is not None else None


def take_given_gains(recordings: Sequence[Recording], gains: Mapping[str, float]) -> list[Recording]:
    """The recordings of the joints that a gain is given for in N·m or N, the others as they are."""
    named = (gains.get(one.metadata.joint) if one.metadata.torque_unit == "A" else None for one in recordings)
    return [one if gain is None else _convert(one, gain) for one, gain in zip(recordings, named, strict=True)]


def take_torques(recordings: Sequence[Recording], gains: Mapping[str, float]) -> list[Recording]:
    """The recordings with torques in N·m or N, those in amperes times their gains.

    Args:
        recordings: One of each joint.
        gains: By joint, before what the metadata say [N·m/A] or [N/A].

    Raises:
        RecordingError: A gain is of no joint or no positive number, or a joint in amperes has none.
    """
    names = [one.metadata.joint for one in recordings]
    for name, gain in gains.items():
        if name not in names or not 0.0 < gain < np.inf:
            raise RecordingError(
                f"--gain {name}={gain:g}: give a positive gain [N·m/A] of one of the joints {', '.join(names)}"
            )
    missing = [one.metadata.joint for one in recordings if _needs(one) and _gain_of(one, gains) is None]
    if missing:
        units = sorted({one.metadata.torque_unit for one in recordings if one.metadata.joint in missing})
        line = " ".join(f"--gain {name}=..." for name in missing)
        raise RecordingError(
            f"the torque of {', '.join(missing)} is in {' and '.join(units)}, and an arm's dynamics need N·m: say the "
            f"torque constant times the gear ratio [N·m/A], by {line}, or as drive_gain in the metadata"
        )
    return [_convert(one, _gain_of(one, gains)) if _needs(one) else one.on_joint_side() for one in recordings]


def _needs(recording: Recording) -> bool:
    return recording.metadata.torque_unit not in _TORQUES


def _gain_of(recording: Recording, gains: Mapping[str, float]) -> float | None:
    if recording.metadata.torque_unit != "A":
        return None
    given = gains.get(recording.metadata.joint)
    return find_drive_gain(recording) if given is None else given


def _convert(recording: Recording, gain: float | None) -> Recording:
    assert gain is not None
    channels = {"torque": gain * np.asarray(recording.torque)}
    if recording.torque_command is not None:
        channels["torque_command"] = gain * np.asarray(recording.torque_command)
    unit = "N·m" if recording.metadata.motion == "rotary" else "N"
    current = np.asarray(recording.torque) if recording.current is None else np.asarray(recording.current)
    return recording.with_channels(**channels, current=current).with_metadata(torque_unit=unit, torque_side="joint")
