"""All that a fit of an arm needs of some of the rows of a recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fricomp.laws import FloatArray

from .prior.sizes import TorqueSizes, measure_torques
from .rigid.simulated_arm import SimulatedArm
from .row_weights import Weights


@dataclass(frozen=True)
class EquationSums:
    """All that a fit needs of some of the rows.

    Attributes:
        arm: The simulation.
        sums: G of each joint. Shape (n_joints, n_columns, n_columns).
        counts: Rows that count, of each joint. Shape (n_joints,).
        weights: Noise and inflation of all rows.
        top_speed: Of each joint [rad/s] or [m/s]. Shape (n_joints,).
    """

    arm: SimulatedArm
    sums: FloatArray
    counts: FloatArray
    weights: Weights
    top_speed: FloatArray

    @cached_property
    def torque_sizes(self) -> TorqueSizes:
        """What priors are measured in."""
        return measure_torques(self.arm, self.sums, self.top_speed)

    @staticmethod
    def join(blocks: Sequence[EquationSums]) -> EquationSums:
        """Of several blocks together."""
        return replace(
            blocks[0],
            sums=np.sum([one.sums for one in blocks], axis=0),
            counts=np.sum([one.counts for one in blocks], axis=0),
        )
