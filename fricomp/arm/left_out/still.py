"""Joints of a log that stood still: nothing is said of them, and the others move about them as they stood."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.recording import Recording

_LEAST_TRAVEL, _LEAST_SHARE = 5e-3, 0.02
"""[rad] or [m], and part of the longest travel of any joint, below which a joint stands still: it sways in its gear or
against its controller, and its torque may be that of a brake."""


def find_still(recordings: Sequence[Recording]) -> dict[str, float]:
    """Joints that stood still, with their positions [rad] or [m]: they only sway, and may hold by a brake."""
    still: dict[str, float] = {}
    for motion in ("rotary", "linear"):
        travel = {
            one.metadata.joint: float(np.ptp(np.quantile(one.position, (0.005, 0.995))))
            for one in recordings
            if one.metadata.motion == motion
        }
        least = max(_LEAST_TRAVEL, _LEAST_SHARE * max(travel.values(), default=0.0))
        still |= {
            one.metadata.joint: float(np.median(one.position))
            for one in recordings
            if travel.get(one.metadata.joint, np.inf) < least
        }
    return still
