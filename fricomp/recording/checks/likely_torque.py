"""Which of several columns may be the torque of a joint, by what inertia, friction and gravity explain of it."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.checks.joint_fit import fit_joint
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_EXPLAINED = 0.3
"""Part of a torque's variance that inertia, friction and gravity of the motion explain at least."""
_SAME = 0.995
"""Correlation of two columns from which on both are the position: asked for and measured, of motor and joint."""


class LikelyTorque(NamedTuple):
    """A column that a joint explains.

    Attributes:
        name: Of the column; empty where none is explained.
        explained: Part of its variance.
    """

    name: str
    explained: float


def find_likely_torque(time: Samples, position: Samples, columns: Mapping[str, Samples]) -> LikelyTorque:
    """The column that a rigid joint with friction explains best as its torque.

    Args:
        time: Shape (n_rows,) [s].
        position: Shape (n_rows,), in any unit.
        columns: By name; shape (n_rows,) each.
    """
    best = LikelyTorque("", 0.0)
    for name, values in columns.items():
        if abs(np.corrcoef(values, position)[0, 1]) > _SAME:
            continue
        try:
            fit = fit_joint(Recording(time, position, values))
        except RecordingError:
            continue
        if fit is not None and fit.can_be and fit.explained > max(best.explained, _EXPLAINED):
            best = LikelyTorque(name, fit.explained)
    return best
