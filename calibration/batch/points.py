"""Friction points of many joints as one tensor, padded to the longest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fricomp.errors import IdentificationError
from fricomp.extras import needing

from ..identification.estimation.form import LARGEST_DRY
from ..identification.estimation.observation import Observations, observe

if TYPE_CHECKING:
    import torch

BRANCH = 4
"""Parameters in a direction: Coulomb torque, static torque, Stribeck velocity, viscous coefficient."""


@dataclass(frozen=True)
class PointBatch:
    """Points of many joints; float64 on one device. The middle axis is the direction: forward, reverse.

    Attributes:
        speed: |v|; 1 where padded [rad/s] or [m/s]. Shape (n_joints, 2, n_points).
        magnitude: Friction torque times sgn(v); 0 where padded [N·m] or [N]. Shape (n_joints, 2, n_points).
        given: 1 where there is a point, else 0. Shape (n_joints, 2, n_points).
    """

    speed: torch.Tensor
    magnitude: torch.Tensor
    given: torch.Tensor

    @property
    def count(self) -> torch.Tensor:
        """Points of each joint. Shape (n_joints,)."""
        return self.given.sum(dim=(1, 2))

    @property
    def torque_scale(self) -> torch.Tensor:
        """Largest friction torque of each joint [N·m] or [N]. Shape (n_joints,)."""
        return self.magnitude.abs().amax(dim=(1, 2))

    @property
    def upper_logs(self) -> torch.Tensor:
        """Largest logarithms of the parameters, those of `SeparableLaw.upper_logs`. Shape (n_joints, 8)."""
        import torch

        most = torch.log(LARGEST_DRY * self.torque_scale.clamp(min=1e-300))
        free = torch.full_like(most, torch.inf)
        return torch.stack([most, most, free, free] * 2, dim=1)

    def select(self, index: torch.Tensor) -> PointBatch:
        """The joints at these positions, as often as they are given."""
        return PointBatch(self.speed[index], self.magnitude[index], self.given[index])


def observe_all(velocity: Sequence[ArrayLike], torque: Sequence[ArrayLike]) -> list[Observations]:
    """Check the points of every joint.

    Raises:
        IdentificationError: Lengths differ, or a joint cannot be identified; the message says which.
    """
    if len(velocity) != len(torque):
        raise IdentificationError(f"there are {len(velocity)} joints with velocities and {len(torque)} with torques")
    if not len(velocity):
        raise IdentificationError("no joint was given")
    return [_observe(index, v, tau) for index, (v, tau) in enumerate(zip(velocity, torque, strict=True))]


def _observe(index: int, velocity: ArrayLike, torque: ArrayLike) -> Observations:
    try:
        points = observe(velocity, torque)
    except IdentificationError as error:
        raise IdentificationError(f"joint {index}: {error}") from error
    for direction, number in (("forward", int(points.forward.sum())), ("reverse", int((~points.forward).sum()))):
        if number < BRANCH:
            raise IdentificationError(
                f"joint {index} has {number} points in {direction} direction and the law has {BRANCH} parameters "
                "there; measure more speeds"
            )
    return points


def stack_points(joints: Sequence[Observations], device: str) -> PointBatch:
    """One tensor for all joints.

    Raises:
        IdentificationError: torch has no such device here.
        MissingExtraError: torch is not installed.
    """
    with needing("torch", "calibrate"):
        import torch
    sides = [(points.forward, ~points.forward) for points in joints]
    shape = (len(joints), 2, max(int(side.sum()) for pair in sides for side in pair))
    speed, magnitude, given = np.ones(shape), np.zeros(shape), np.zeros(shape)
    for row, (points, pair) in enumerate(zip(joints, sides, strict=True)):
        for k, side in enumerate(pair):
            n = int(side.sum())
            speed[row, k, :n], magnitude[row, k, :n] = points.speed[side], points.magnitude[side]
            given[row, k, :n] = 1.0
    try:
        tensors = [torch.from_numpy(values).to(device) for values in (speed, magnitude, given)]
    except (RuntimeError, AssertionError) as error:  # of a device that torch was not built for, or that is not there
        raise IdentificationError(f"torch cannot use the device {device!r}: {error}") from error
    return PointBatch(*tensors)
