"""The columns of a rigid joint, for what shares no code with the diagnosis: baselines and injected effects."""

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]

N_BODY = 3
"""Columns of inertia and gravity, which come first."""


def build_joint_columns(q: Samples, v: Samples, a: Samples, width: float) -> Samples:
    """Inertia, gravity, offset and a Stribeck curve for each direction.

    Args:
        q: Position [rad] or [m]. Shape (n_samples,), like the others.
        v: Velocity [rad/s] or [m/s].
        a: Acceleration [rad/s²] or [m/s²].
        width: Stribeck velocity of both curves [rad/s] or [m/s].

    Returns:
        Shape (n_samples, 10).
    """
    columns = [a, np.sin(q), np.cos(q), np.ones_like(q)]
    for side in (v > 0.0, v < 0.0):
        sign = np.where(side, np.sign(v), 0.0)
        columns += [sign, sign * np.exp(-((v / width) ** 2)), np.where(side, v, 0.0)]
    return np.stack(columns, axis=1)
