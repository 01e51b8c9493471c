"""The picture of a friction model: torque over velocity."""

from collections.abc import Callable

import numpy as np

from fricomp.laws import Scalar
from fricomp.report import Chart, Line, Panel

_POINTS = 400
_SLOWEST = 1e-4
"""Slowest speed drawn as a fraction of the fastest [1]: dense near rest, where the curve bends."""


def friction_chart(torque: Callable[[Scalar], Scalar], fastest: float, units: tuple[str, str]) -> Chart:
    """Friction torque over the velocity, with the step at rest left open.

    Args:
        torque: Friction torque at velocities.
        fastest: Speed up to which it is drawn [rad/s] or [m/s].
        units: Of position and of torque.
    """
    speed = np.geomspace(_SLOWEST * fastest, fastest, _POINTS)
    lines = tuple(Line(sign * speed, np.asarray(torque(sign * speed)), color=0) for sign in (-1.0, 1.0))
    panel = Panel(lines, f"velocity [{units[0]}/s]", f"friction torque [{units[1]}]")
    return Chart("friction-model", "Friction", (panel,))
