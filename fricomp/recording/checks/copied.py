"""A torque that is the column of another channel once more, or one number."""

import numpy as np

from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording

_OTHERS = ("position", "velocity", "acceleration", "position_reference", "velocity_reference")


def find_copied_torque(recording: Recording) -> tuple[Finding, ...]:
    """A torque that holds the very numbers of the motion: its column was named twice."""
    torque = np.asarray(recording.torque)
    if np.ptp(torque) == 0.0:
        return _find_constant(recording, float(torque[0]))
    same = next((name for name in _OTHERS if np.array_equal(torque, recording.channels.get(name, ()))), "")
    if not same:
        return ()
    message = f"torque has the very numbers of {same} in every row: one column was taken for both"
    advice = "name the column of the torque, or of the current"
    return (Finding("copied_torque", "error", message, advice, column="torque"),)


def _find_constant(recording: Recording, torque: float) -> tuple[Finding, ...]:
    """One torque in every row, which no joint that turns back has."""
    moved = np.diff(recording.position)
    if torque == 0.0 or not (moved.max() > 0.0 > moved.min()):
        return ()
    message = (
        f"torque is {torque:.6g} in every row while the joint moves both ways: it is a limit, a set point or a value "
        "that was logged once, and not the torque of the motion"
    )
    return (
        Finding("constant_torque", "error", message, "log the torque of each row, or the current", column="torque"),
    )
