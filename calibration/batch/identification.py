"""`identify_batch`: the friction of thousands of joints from their plateaus, in one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray, FrictionLaw

from ..identification.estimation.form import separable_law
from ..identification.estimation.information import invert_information
from ..identification.estimation.likelihood import Noise, NoiseKind
from ..identification.estimation.observation import Observations
from ..identification.estimation.optimum import optimum_at
from ..identification.inference.verdict import BASIN_GAP, CLOSE_ENOUGH, Verdict, judge
from ..identification.status import Status
from .likelihood import (
    BatchNoise,
    Linearised,
    compute_bounded_curve,
    compute_curve,
    compute_information,
    likelihood_of,
    linearise,
)
from .points import PointBatch, observe_all, stack_points
from .projection import Basins, find_starts, scan_basins
from .refinement import refine_all

if TYPE_CHECKING:
    import torch

_FORM = separable_law("stribeck")
_CHUNK = 4_000_000  # values at once on a processor: 32 MB in each temporary array
_SHRUNK = 1e-6  # a parameter whose logarithm moves the torque by less than this share of another's is none
_EXACT = 1e-8  # noise below this share of the torque is rounding, and no distance is measured by it


@dataclass(frozen=True)
class BatchIdentification:
    """Friction of many joints; arrays are read-only, their first axis is the joint.

    Attributes:
        parameter_names: Dotted names, in the order of the columns.
        observations: The points in motion of each joint.
        values: Shape (n_joints, 8).
        covariance: Inverse Fisher information. Shape (n_joints, 8, 8).
        noise: `relative` or `absolute`, whichever was likelier. Shape (n_joints,).
        noise_level: Of the torque [1] or [N·m or N]. Shape (n_joints,).
        negative_log_likelihood: Shape (n_joints,).
        distance: From the likelihood's stationary point, in standard deviations. Shape (n_joints,).
        rival: How much less likely the next basin is [nats]; infinite where there is none. Shape (n_joints,).
    """

    parameter_names: tuple[str, ...]
    observations: tuple[Observations, ...]
    values: FloatArray
    covariance: FloatArray
    noise: np.ndarray[tuple[int], np.dtype[np.str_]]
    noise_level: FloatArray
    negative_log_likelihood: FloatArray
    distance: FloatArray
    rival: FloatArray

    def __post_init__(self) -> None:
        for values in vars(self).values():
            if isinstance(values, np.ndarray):
                values.flags.writeable = False

    def __len__(self) -> int:
        """Number of joints."""
        return len(self.values)

    @property
    def standard_deviations(self) -> FloatArray:
        """Shape (n_joints, 8)."""
        return np.asarray(np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=1, axis2=2), 0.0)))

    @property
    def status(self) -> list[Status]:
        """How each joint ended."""
        return [self.verdict(index).status for index in range(len(self))]

    def verdict(self, index: int) -> Verdict:
        """How one joint ended, in a word and in a sentence, by the same rules as alone."""
        points, distance = self.observations[index], float(self.distance[index])
        scale = points.torque_scale if self.noise[index] == "absolute" else 1.0
        kind = cast(NoiseKind, str(self.noise[index]))
        found = optimum_at(np.log(self.values[index]), _FORM, points, Noise(kind))
        found = replace(found, other_basins=(found.negative_log_likelihood + float(self.rival[index]),))
        verdict = judge(found, found, self.covariance[index], _FORM, points)
        stopped = distance > CLOSE_ENOUGH and self.noise_level[index] > _EXACT * scale
        if stopped and verdict.status is not Status.NOT_IDENTIFIABLE:
            message = f"the search stopped {distance:.2g} standard deviations from the optimum"
            return Verdict(Status.NOT_CONVERGED, message, distance)
        return verdict._replace(distance=distance)

    def law(self, index: int) -> FrictionLaw:
        """The friction law of one joint."""
        return _FORM.law(dict(zip(self.parameter_names, self.values[index].tolist(), strict=True)))


def identify_batch(
    velocity: Sequence[ArrayLike],
    torque: Sequence[ArrayLike],
    noise: Literal["auto", "relative", "absolute"] = "auto",
    *,
    device: str = "cpu",
) -> BatchIdentification:
    """Identify the eight Stribeck parameters of many joints; the optimum is that of `identify` one by one.

    Variable projection over the Stribeck velocity finds the basins, Levenberg-Marquardt ends in the likelihood's
    optimum, both in float64 for all joints together.

    Args:
        velocity: For each joint, [rad/s] or [m/s]; lengths may differ. Shapes (n_points,).
        torque: Friction torque with the sign of the velocity [N·m] or [N]. Shapes (n_points,).
        noise: `relative` to the model's torque, `absolute`, or `auto`: whichever is likelier, for each joint.
        device: Of torch, such as `cpu` or `cuda`.

    Raises:
        IdentificationError: The points of a joint cannot be used; the message says which joint and why.
        MissingExtraError: torch is not installed.
    """
    choices: dict[str, tuple[BatchNoise, ...]] = {
        "auto": ("relative", "absolute"),
        "relative": ("relative",),
        "absolute": ("absolute",),
    }
    if noise not in choices:
        raise IdentificationError(f"unknown noise {noise!r}; use {', '.join(choices)}")
    joints = observe_all(velocity, torque)
    parts = [_identify(stack_points(chunk, device), choices[noise]) for chunk in _split_into_chunks(joints, device)]
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return BatchIdentification(_FORM.names, tuple(joints), *columns)


def _split_into_chunks(joints: Sequence[Observations], device: str) -> list[Sequence[Observations]]:
    """Joints in batches that fit into the caches of a processor, or into the memory of a graphics card."""
    longest = max(points.size for points in joints)
    size = max(1, _CHUNK * (1 if device == "cpu" else 40) // (48 * longest))
    return [joints[at : at + size] for at in range(0, len(joints), size)]


class _Fit(NamedTuple):
    """Optima under one noise model."""

    logs: torch.Tensor
    likelihood: torch.Tensor
    rival: torch.Tensor


def _identify(points: PointBatch, kinds: tuple[BatchNoise, ...]) -> list[np.ndarray]:
    """The columns of `BatchIdentification` for one batch."""
    import torch

    plain = scan_basins(points, points.given)
    fits = [_fit(points, plain, kind) for kind in kinds]
    best = torch.stack([fit.likelihood for fit in fits]).argmin(dim=0)
    described = [_describe(fit, points, kind) for fit, kind in zip(fits, kinds, strict=True)]
    choice = best.cpu().numpy()
    return [np.stack(column)[choice, np.arange(len(choice))] for column in zip(*described, strict=True)]


def _fit(points: PointBatch, plain: Basins, noise: BatchNoise) -> _Fit:
    """The best optimum of each joint over its starts."""
    import torch

    starts = find_starts(points, plain, noise)
    mine = points.select(starts.joint)
    logs = refine_all(starts.logs, mine, noise)
    likelihood = likelihood_of(linearise(compute_curve(logs, mine), mine, noise).cost, mine)
    order = torch.argsort(likelihood, descending=True)  # the best of each joint is written last
    row = torch.empty(len(points.speed), dtype=torch.int64, device=logs.device)
    lowest = torch.full_like(likelihood[: len(row)], torch.inf)
    lowest = lowest.scatter_reduce(0, starts.joint, likelihood, "amin")
    winners = order[likelihood[order] == lowest[starts.joint[order]]]
    row[starts.joint[winners]] = winners
    behind = likelihood - lowest[starts.joint]
    other = torch.where(behind > BASIN_GAP, behind, torch.inf)
    rival = torch.full_like(lowest, torch.inf).scatter_reduce(0, starts.joint, other, "amin")
    return _Fit(logs[row], likelihood[row], rival)


def _describe(fit: _Fit, points: PointBatch, noise: BatchNoise) -> list[np.ndarray]:
    """Values, covariance, noise, its level, likelihood, distance and rival, as columns."""
    import torch

    curve = compute_curve(fit.logs, points)
    values = torch.exp(fit.logs)
    freedom = (points.count - values.shape[1]).clamp(min=1.0)
    error = (points.magnitude - curve.magnitude) * points.given / (curve.magnitude if noise == "relative" else 1.0)
    level = ((error**2).sum(dim=(1, 2)) / freedom).sqrt()
    inverse = _invert(compute_information(curve, level, points, noise))
    covariance = inverse * values[:, :, None] * values[:, None, :]
    distance = _measure_distance(linearise(compute_bounded_curve(fit.logs, points), points, noise), freedom)
    columns = (values, covariance, level, fit.likelihood, distance, fit.rival)
    v, c, s, nll, d, rival = (x.cpu().numpy() for x in columns)
    return [v, c, np.full(len(v), noise), s, nll, d, rival]


def _invert(information: torch.Tensor) -> torch.Tensor:
    """Inverse of scaled symmetric matrices, joints with directions without information one by one."""
    import torch

    scale = information.diagonal(dim1=1, dim2=2).clamp(min=1e-300).rsqrt()
    both = scale[:, :, None] * scale[:, None, :]
    values = torch.linalg.eigvalsh(information * both)
    inverse: torch.Tensor = torch.linalg.pinv(information * both, rtol=1e-14, hermitian=True) * both
    for k in torch.nonzero(values[:, 0] < 1e-14 * values[:, -1]).flatten().tolist():
        inverse[k] = torch.as_tensor(invert_information(information[k].cpu().numpy()), device=inverse.device)
    # Where the information is nearly singular, rounding is far above that of a single element.
    return 0.5 * (inverse + inverse.transpose(1, 2))


def _measure_distance(at: Linearised, freedom: torch.Tensor) -> torch.Tensor:
    """Length of a further Gauss-Newton step in standard deviations (Mahalanobis).

    A parameter that has shrunk to nothing, such as viscous friction that would be negative, is at its bound: its
    logarithm has no optimum to be far from.
    """
    import torch

    squares = at.normal.diagonal(dim1=1, dim2=2)
    felt = squares > _SHRUNK**2 * squares.amax(dim=1, keepdim=True)
    scale = torch.where(felt, squares.clamp(min=1e-300).rsqrt(), 0.0)
    gradient = (at.gradient * scale)[:, :, None]
    inverse: torch.Tensor = torch.linalg.pinv(
        at.normal * scale[:, :, None] * scale[:, None, :], rtol=1e-12, hermitian=True
    )
    square = (gradient.transpose(1, 2) @ inverse @ gradient)[:, 0, 0].clamp(min=0.0)
    return (square / (at.cost / freedom).clamp(min=1e-300)).sqrt()
