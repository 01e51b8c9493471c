"""Friction that is another one at the end of a recording than at its beginning: wear, heat, a brake that drags."""

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

_WINDOWS = 24
"""Windows of time: six each begin and end, whose scatter says what chance makes."""
_FEWEST_ROWS = 20
"""Fewest rows of a window."""
_LEAST = 0.05
"""Part of the friction from which a change matters: as much as a curve is off by then."""
_CERTAIN = 4.0
"""Standard deviations from which a change is no chance."""


class FrictionChange(NamedTuple):
    """What friction changes by over a recording.

    Attributes:
        torque: From its first to its last quarter [N·m] or [N]; positive where friction rises.
        part: The same over the friction.
    """

    torque: float
    part: float

    def describe(self, unit: str) -> str:
        """In words that follow a colon."""
        way = "rises" if self.torque > 0.0 else "falls"
        size = f"{abs(self.torque):.3g} {unit} ({100.0 * abs(self.part):.2g} %)"
        return (
            f"over the recording friction {way} by {size}, from its first quarter to its last: what is printed is of "
            "all of it. Warming, wear or a brake that drags do that; take the beginning and the end apart (fricomp "
            "convert --from, --to) to see both"
        )


def find_friction_change(
    time: FloatArray, left: FloatArray, torque: FloatArray, velocity: FloatArray
) -> FrictionChange | None:
    """What of the torque that a model leaves opposes the motion more at the end than at the beginning; None for little.

    Args:
        time: Of rows in which the joint moves [s]. Shape (n,), like all of them.
        left: Torque that a model leaves [N·m] or [N].
        torque: All of it.
        velocity: [rad/s] or [m/s].
    """
    edges = np.linspace(time.min(), time.max(), _WINDOWS + 1) if time.size else np.zeros(_WINDOWS + 1)
    window = np.clip(np.digitize(time, edges) - 1, 0, _WINDOWS - 1)
    count = np.bincount(window, minlength=_WINDOWS)
    if count.min() < _FEWEST_ROWS:
        return None
    sign = np.sign(velocity)
    level = np.bincount(window, weights=left * sign, minlength=_WINDOWS) / count
    quarter = _WINDOWS // 4
    change = float(np.mean(level[-quarter:]) - np.mean(level[:quarter]))
    chance = float(np.std(np.diff(level))) / np.sqrt(2.0) * np.sqrt(2.0 / quarter)
    friction = abs(float(np.mean(torque * sign)))  # gravity and inertia take out as much as they bring in
    if abs(change) < max(_LEAST * friction, _CERTAIN * chance) or friction == 0.0:
        return None
    return FrictionChange(change, change / friction)
