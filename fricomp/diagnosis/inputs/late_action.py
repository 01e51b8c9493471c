"""A torque that acts long after its stamp: a command of a slow bus, or a log that stamps the position late."""

from __future__ import annotations

from collections.abc import Sequence

from fricomp.recording import Recording
from fricomp.recording.checks.joint_fit import fit_joint
from fricomp.recording.checks.torque_causes import find_delay

from .settings import INPUT


def find_late_action(recordings: Sequence[Recording], usual: float) -> float:
    """How long after its stamp the torque of these recordings may act [s]; 0 where that is usual.

    The joint is taken as rigid here, so only a delay that explains most of what such a joint leaves counts. Whether it
    is one, or a lag that looks alike from afar, is for a search from both ends.

    Args:
        recordings: Of one joint.
        usual: Time by which a torque may act late without any flaw [s].
    """
    longest = max(recordings, key=lambda one: one.duration)
    delay = find_delay(longest)
    if delay is None or delay <= usual:
        return 0.0
    at_once, moved = fit_joint(longest), fit_joint(longest, delay=delay)
    if at_once is None or moved is None:
        return 0.0
    return delay if moved.residual < INPUT.late_left * at_once.residual else 0.0
