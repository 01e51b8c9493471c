"""Whoever watches a sweep: what it is shown, and the friction point that one plateau alone tells."""

from typing import Any, Protocol

import numpy as np

from fricomp.adapters import JointAdapter
from fricomp.recording import Recording

from .analysis.analysis import measure_offset
from .analysis.block import BlockLabel, SweepData
from .analysis.point import measure_points, without_transient
from .analysis.steadiness import REASONS


class SweepWatch(Protocol):
    """What a page that shows a sweep offers; neither call waits for anybody."""

    def attach(self, adapter: JointAdapter, joint: int = 0) -> None:
        """Show the joints of an adapter that is open, and one of them first."""

    def show_block(self, label: BlockLabel, samples: Recording) -> None:
        """Show what a block of the recording tells."""


def measure_live_point(data: SweepData) -> dict[str, Any] | None:
    """What the last plateau tells while the sweep goes on: velocity, friction torque, and whether it will be used.

    Lag of the torque signal, gravity where no model says it, and a fit of the inertia come at the end of a sweep only.

    Args:
        data: The plateau, and the zero of the torque sensor where it was measured.

    Returns:
        `velocity` [rad/s] or [m/s], `torque` and `deviation` [N·m] or [N], `verdict`, `reason` in words, and whether
        the torque is `preliminary`, nothing taken off for gravity; None where the plateau holds no samples.
    """
    parts = data.settled_parts()
    if not parts:
        return None
    samples = parts[-1].samples
    (point,) = measure_points(
        [without_transient(parts[-1])],
        offset=measure_offset(data).value,
        lag=0.0,
        quantum=samples.metadata.encoder_resolution or 0.0,
        torque_limit=float(samples.metadata.extra.get("torque_limit", np.inf)),
    )
    return {
        "velocity": point.velocity,
        "torque": point.torque,
        "deviation": point.deviation,
        "verdict": point.verdict,
        "reason": REASONS.get(point.verdict, ""),
        "preliminary": samples.load_torque is None,
    }
