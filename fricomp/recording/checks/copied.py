"""A torque that is the column of another channel once more."""

import numpy as np

from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording

_OTHERS = ("position", "velocity", "acceleration", "position_reference", "velocity_reference")


def find_copied_torque(recording: Recording) -> tuple[Finding, ...]:
    """A torque that holds the very numbers of the motion: its column was named twice."""
    torque = np.asarray(recording.torque)
    if np.ptp(torque) == 0.0:
        return ()
    same = next((name for name in _OTHERS if np.array_equal(torque, recording.channels.get(name, ()))), "")
    if not same:
        return ()
    message = f"torque has the very numbers of {same} in every row: one column was taken for both"
    advice = "name the column of the torque, or of the current"
    return (Finding("copied_torque", "error", message, advice, column="torque"),)
