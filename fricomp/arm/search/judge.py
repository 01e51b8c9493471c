"""What more a joint's torque may hold, once its own columns have taken what they can of what a fit leaves."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from ..coordinates import place_parameters
from ..equations import N_LAST, ArmEquations
from ..fit import ArmFit
from ..friction import TERMS

_RANK = 1e-6
"""Part of the largest singular value below which a direction of a joint's columns is rounding."""


class Estimate(NamedTuple):
    """Factors on columns that were fitted together.

    Attributes:
        values: Shape (n_columns,).
        covariance: Shape (n_columns, n_columns).
    """

    values: FloatArray
    covariance: FloatArray

    @property
    def deviations(self) -> FloatArray:
        """Standard deviations. Shape (n_columns,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))


class JointJudge:
    """Weighs columns against what a fit leaves of one joint; links, rotor and friction of it may be anything.

    Args:
        equations: Of all joints.
        fit: Of these equations.
        joint: Number of the joint.
        left: What the fit leaves of the joint [N·m] or [N]. Shape (n,).
        term: In whose place columns are weighed, where the fit has it: one of one parameter.
        delay: Whether the delay of all torques may be anything as well; else it is that of the fit.
    """

    def __init__(
        self,
        equations: ArmEquations,
        fit: ArmFit,
        joint: int,
        left: FloatArray,
        *,
        term: str | None = None,
        delay: bool = True,
    ) -> None:
        coordinates, columns = place_parameters(fit.arm, fit.model), equations.columns[joint]
        own = coordinates.columns[joint]
        form = dict(fit.model.forms[joint].terms)
        if term in form:
            place, names = fit.find_friction(joint)
            (name,) = TERMS[term].names(form[term])
            at = names.index(name)
            own = np.delete(own, at)
            left = left + fit.x[place.start + at] * equations.friction_of(joint, [name])[:, 0]
        links = np.arange(coordinates.n_inertial + 1)
        shared = np.arange(columns.shape[1] - N_LAST, columns.shape[1] - (1 if delay else 2))
        weights = equations.weights
        self._root = np.sqrt(weights.rows[:, joint] / (weights.inflation[joint] * weights.noise[joint] ** 2))
        base = columns[:, np.concatenate([links, own, shared])] * self._root[:, None]
        size = np.linalg.norm(base, axis=0)
        vectors, strength, _ = np.linalg.svd(base[:, size > 0.0] / size[size > 0.0], full_matrices=False)
        self._base = vectors[:, strength > _RANK * strength[0]]
        self._left = self._take_off(left * self._root)

    def measure_gains(self, columns: FloatArray, spread: float = np.inf) -> FloatArray:
        """Half of what the weighted squares fall by with each column times a positive factor. Shape (n_columns,).

        Args:
            columns: Shape (n, n_columns).
            spread: Standard deviation of the factor about one; any is as good as another by default.
        """
        seen = self._take_off(columns * self._root[:, None])
        along, size = np.maximum(seen.T @ self._left, 0.0), np.einsum("ij,ij->j", seen, seen)
        sure = spread**-2.0
        factor = (along + sure) / np.maximum(size + sure, 1e-300)
        return np.asarray(factor * along - 0.5 * factor**2 * size - 0.5 * sure * (factor - 1.0) ** 2)

    def estimate(self, columns: FloatArray) -> Estimate:
        """Factors on columns together, as the weighted squares have them. Shape (n, n_columns)."""
        seen = self._take_off(columns * self._root[:, None])
        covariance = np.asarray(np.linalg.pinv(seen.T @ seen), dtype=np.float64)
        return Estimate(covariance @ (seen.T @ self._left), covariance)

    def _take_off(self, columns: FloatArray) -> FloatArray:
        return np.asarray(columns - self._base @ (self._base.T @ columns))


class JointJudges:
    """The judges of all joints by one fit, each made once.

    Args:
        equations: Of all joints.
        fit: Of these equations.
    """

    def __init__(self, equations: ArmEquations, fit: ArmFit) -> None:
        left = fit.residuals(equations)
        self.get = cache(lambda joint, term: JointJudge(equations, fit, joint, left[:, joint], term=term))
