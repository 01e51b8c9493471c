"""What one of a position in units of a device is, by a velocity beside it that states its unit."""

from math import tau

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.checks.unit_checks import compare_rate
from fricomp.recording.named.column import says_counts
from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import UNKNOWN_UNIT, find_unit_words, unit_for
from fricomp.recording.validity import Samples

_ALIKE = 0.95
"""Correlation of a position with the integral of a velocity from which on they are of one motion."""


def measure_worth(time: Samples, position: Samples, velocity: Samples, name: str) -> float:
    """SI units in one of a position, which makes a velocity with a stated unit its rate; 0 where none is stated.

    Args:
        time: Shape (n_rows,) [s].
        position: Shape (n_rows,), in units of a device.
        velocity: Shape (n_rows,), in its own unit.
        name: Of the velocity.
    """
    said = find_unit_words(name, -1)
    unit = unit_for("velocity", said[0].unit) if said else UNKNOWN_UNIT
    if unit == UNKNOWN_UNIT or says_counts(name):
        return 0.0
    factor = find_unit(unit).factor if unit else 1.0
    known = np.isfinite(time) & np.isfinite(position) & np.isfinite(velocity)
    try:
        recording = Recording(
            time[known], position[known], np.zeros(int(known.sum())), velocity=factor * velocity[known]
        )
    except RecordingError:
        return 0.0
    compared = compare_rate(recording)
    return 1.0 / compared[0] if compared is not None and compared[1] > _ALIKE and compared[0] > 0.0 else 0.0


def fill_worth(line: str, worth: float, velocity: str) -> str:
    """The rule of a position in counts with what one is, or with what it hangs on.

    Args:
        line: With `VALUE_OF_ONE`.
        worth: Of one [rad]; 0 where nothing tells it.
        velocity: Name of the column that tells it.
    """
    exact = "6.2832/COUNTS_A_TURN"
    if not worth:
        return line.replace("VALUE_OF_ONE", exact)
    by = f"some {tau / worth:.0f} a turn make {velocity!r} its rate; {exact} is exact"
    return f"{line.replace('VALUE_OF_ONE', f'{worth:.5g}')}  # {by}"
