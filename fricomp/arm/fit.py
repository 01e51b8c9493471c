"""Links, rotors and friction of a whole arm: the most probable values, and how well they are known.

    minimise  Σ_j |τ_j + δ τ'_j - (1 + g)(Y_j θ(p) + a_j r_j + F_j f_j + L_j t)|² / (c_j σ_j²) + Σ (x - x_0)² / s²

over x = (p, r, f, t, δ, g) with all rigid parameters shared by all joints. Fitted joint by joint, they would take
friction's place and extrapolate to torques above those recorded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.laws import FloatArray

from .coordinates import ArmModel, place_parameters
from .equation_sums import EquationSums
from .equations import N_LAST, ArmEquations
from .prior import ArmPrior
from .prior.sizes import PriorSizes
from .rigid.inertia import N_INERTIA
from .rigid.simulated_arm import SimulatedArm
from .rows import ArmRows
from .squares import Linearised, WeightedSquares

Z95 = 1.96
"""Standard deviations of a 95 % interval to each side."""

_CONVERGED = 1e-8
"""Fall of the objective in a step, made or promised, as part of it, below which the fit stands still."""

_PARTS = (1.0, 0.5, 0.25, 0.1, 0.03)
"""Of a Gauss-Newton step that are tried, longest first: inertia is quadratic in its coordinates."""


@dataclass(frozen=True)
class ArmFit:
    """What was found.

    Attributes:
        arm: The simulation.
        model: What was fitted.
        x: All parameters: links, rotors, friction of joint 1, 2, ..., lean of gravity, delay, gain. Shape (n,).
        covariance: Of x. Shape (n, n).
        prior_deviation: Of x before the recording. Shape (n,).
        log_evidence: Of the model, up to a constant of the equations.
        cost: Weighted squares without the prior.
    """

    arm: SimulatedArm
    model: ArmModel
    x: FloatArray
    covariance: FloatArray
    prior_deviation: FloatArray
    log_evidence: float
    cost: float

    @property
    def inertia(self) -> FloatArray:
        """Ten numbers of each link. Shape (n_links, 10)."""
        p = self.x[: N_INERTIA * len(self.arm.links)].reshape(-1, N_INERTIA)
        return self.arm.all_coordinates.inertia(p)

    @property
    def armature(self) -> FloatArray:
        """Inertia of each rotor [kg·m²]. Shape (n_joints,)."""
        first = N_INERTIA * len(self.arm.links)
        return self.x[first : first + len(self.arm.joints)]

    @property
    def lean(self) -> tuple[FloatArray, FloatArray]:
        """How far gravity leans over along each level axis, and the standard deviations [rad]. Shapes (2,)."""
        at = slice(-N_LAST, -2)
        return self.x[at], np.sqrt(np.diag(self.covariance)[at])

    @property
    def delay(self) -> tuple[float, float]:
        """By how much all torques are later than the rows allow for, and its standard deviation [s]."""
        return float(self.x[-2]), float(np.sqrt(self.covariance[-2, -2]))

    @property
    def gain(self) -> tuple[float, float]:
        """Factor that all torques were measured with, and its standard deviation."""
        return 1.0 + float(self.x[-1]), float(np.sqrt(self.covariance[-1, -1]))

    def find_friction(self, joint: int) -> tuple[slice, tuple[str, ...]]:
        """Place and names of a joint's friction parameters in x."""
        names = [form.columns for form in self.model.forms]
        start = N_INERTIA * len(self.arm.links) + len(self.arm.joints) + sum(map(len, names[:joint]))
        return slice(start, start + len(names[joint])), names[joint]

    def friction(self, joint: int) -> dict[str, float]:
        """Friction parameters of a joint."""
        place, names = self.find_friction(joint)
        return dict(zip(names, self.x[place].tolist(), strict=True))

    def predict(self, equations: ArmEquations) -> tuple[FloatArray, FloatArray]:
        """Torque of links and rotors, and that of friction, at the rows [N·m]. Shapes (n, n_joints)."""
        z = place_parameters(self.arm, self.model).expand(self.x)[:, :-2]
        first = N_INERTIA * len(self.arm.links) + 1
        parts = [
            (
                one[:, :first] @ w[:first],
                one[:, first:-N_LAST] @ w[first : 2 - N_LAST],
                one[:, -N_LAST:-2] @ w[2 - N_LAST :],
            )
            for one, w in zip(equations.columns, z, strict=True)
        ]
        rigid, friction, leaning = (np.stack(each, axis=1) for each in zip(*parts, strict=True))
        return rigid + leaning, friction

    def residuals(self, equations: ArmEquations) -> FloatArray:
        """What is left of the torques at the rows, their delay allowed for [N·m]. Shape (n, n_joints)."""
        rigid, friction = self.predict(equations)
        torque = np.stack([one[:, -1] + self.x[-2] * one[:, -2] for one in equations.columns], axis=1)
        return np.asarray(torque - rigid - friction)

    def compute_load(self, rows: ArmRows) -> FloatArray:
        """Torque that the gears transmit at any rows [N·m]: rotors lie before them. Shape (n, n_joints)."""
        return np.asarray(rows.links @ self.inertia.ravel() + rows.weigh_lean(self.inertia) @ self.lean[0])


def fit_arm(
    arm: SimulatedArm,
    equations: ArmEquations | EquationSums,
    model: ArmModel,
    prior: ArmPrior,
    start: ArmFit | None = None,
    *,
    steps: int = 40,
) -> ArmFit:
    """Fit links, rotors and friction together.

    Args:
        arm: Simulation that is departed from.
        equations: Of all joints.
        model: What is fitted.
        prior: How far the simulation is trusted.
        start: A fit of another model to begin with.
        steps: Most Gauss-Newton steps; two tell how good a model is that differs from `start` by one term.
    """
    coordinates = place_parameters(arm, model)
    mean, deviation = coordinates.place_prior(PriorSizes.of(equations.torque_sizes, prior), prior)
    x = mean.copy() if start is None else coordinates.take_over(start.model, start.x, mean)
    x, seen = _descend(WeightedSquares(coordinates, equations), x, (mean, deviation), steps)
    scaled = seen.curvature * np.outer(deviation, deviation) + np.eye(x.size)
    weights = equations.weights
    penalty = float(np.sum(((x - mean) / deviation) ** 2))
    noise = float(np.sum(equations.counts * 2.0 * np.log(weights.noise) / weights.inflation))
    return ArmFit(
        arm=arm,
        model=model,
        x=x,
        covariance=np.linalg.inv(scaled) * np.outer(deviation, deviation),
        prior_deviation=deviation,
        log_evidence=-0.5 * float(seen.cost + noise + penalty + np.linalg.slogdet(scaled)[1]),
        cost=seen.cost,
    )


def measure_pulls(fit: ArmFit, stretches: Sequence[EquationSums]) -> list[tuple[FloatArray, FloatArray]]:
    """How single stretches of a recording hold and pull the parameters.

    Args:
        fit: Where they pull.
        stretches: Sums over the rows of each.

    Returns:
        Half the curvature and half the downward slope of the weighted squares of each. Shapes (n, n) and (n,).
    """
    coordinates = place_parameters(fit.arm, fit.model)
    return [WeightedSquares(coordinates, one).linearise(fit.x)[:2] for one in stretches]


def _descend(
    squares: WeightedSquares,
    x: FloatArray,
    prior: tuple[FloatArray, FloatArray],
    steps: int,
) -> tuple[FloatArray, Linearised]:
    """Parameters where the objective is least, and the squares about them; `prior` is its mean and deviation."""
    mean, deviation = prior

    def judge(there: FloatArray, cost: float) -> float:
        return cost + float(np.sum(((there - mean) / deviation) ** 2))

    seen = squares.linearise(x)
    value = judge(x, seen.cost)
    for _ in range(steps):
        scaled = seen.curvature * np.outer(deviation, deviation) + np.eye(x.size)
        pull = deviation * seen.pull - (x - mean) / deviation
        step = np.linalg.solve(scaled, pull)
        if pull @ step <= _CONVERGED * abs(value):
            break
        step *= deviation
        there, best = x, value
        for part in _PARTS:
            there = x + part * step
            best = judge(there, squares.measure(there))
            if best < value:
                break
        if not best < value:
            break
        x, fall, value = there, value - best, best
        seen = squares.linearise(x)
        if fall <= _CONVERGED * abs(value):
            break
    return x, seen
