"""The curve that fills: fitted anew to the plateaus that there are, beside the page, by least squares."""

import threading
from typing import Any

import numpy as np

__all__ = ["LiveCurve"]

_FEWEST = 5
"""Plateaus of a direction from which on its curve is drawn: one more than its parameters."""
_DRAWN = 60
"""Points of the curve that is drawn."""


class LiveCurve:
    """The newest fit; while one is made, points that come are for the next."""

    def __init__(self) -> None:
        self._points: list[tuple[float, float]] = []
        self._wanted = threading.Event()
        self.newest: dict[str, list[list[float]]] | None = None
        threading.Thread(target=self._fit_forever, daemon=True).start()

    def add(self, point: dict[str, Any]) -> None:
        """Take a plateau; one that is rejected counts for nothing."""
        if point["verdict"] == "steady":
            self._points.append((point["velocity"], point["torque"]))
            self._wanted.set()

    def forget(self) -> None:
        """Begin anew."""
        self._points, self.newest = [], None

    def _fit_forever(self) -> None:
        while self._wanted.wait():
            self._wanted.clear()
            self.newest = fit_curve(list(self._points)) or self.newest


def fit_curve(points: list[tuple[float, float]]) -> dict[str, list[list[float]]] | None:
    """Velocity, torque and half of the 95 % band of each direction; None where the points do not say it.

    Args:
        points: Velocity [rad/s] or [m/s] and friction torque [N·m] or [N] of each plateau.
    """
    from fricomp.calibration import identify
    from fricomp.calibration.identification.report.chart import REACH
    from fricomp.errors import FricompError

    velocity, torque = (np.array(column) for column in zip(*points, strict=True))
    if min(np.sum(velocity > 0.0), np.sum(velocity < 0.0)) < _FEWEST:
        return None
    try:
        found = identify(velocity, torque, method="least_squares")
    except FricompError:
        return None
    drawn = {}
    for name, sign in (("forward", 1.0), ("reverse", -1.0)):
        speeds = np.abs(velocity[velocity * sign > 0.0])
        at = sign * np.geomspace(speeds.min(), speeds.max(), _DRAWN)
        reach = REACH * np.asarray(found.torque_deviation(at))
        drawn[name] = np.column_stack([at, np.asarray(found.model.torque(at)), reach]).tolist()
    return drawn
