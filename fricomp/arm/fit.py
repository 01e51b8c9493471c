"""Links, rotors and friction of a whole arm: the most probable values, and how well they are known.

    minimise  Σ_j |τ_j + δ τ'_j - (1 + g)(Y_j θ(p) + a_j r_j + F_j f_j)|² / (c_j σ_j²) + Σ (x - x_0)² / s²

over x = (p, r, f, δ, g) with all rigid parameters shared by all joints. Fitted joint by joint, they would take
friction's place and extrapolate to torques above those recorded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

from .equations import ArmEquations, EquationSums
from .friction import PLAIN, TERMS, JointForm, column_names
from .prior import ArmPrior
from .rigid.inertia import N_INERTIA, LinkCoordinates
from .rigid.simulated_arm import SimulatedArm
from .rows import ArmRows

__all__ = ["ArmFit", "ArmModel", "Glance", "fit_arm", "measure_pulls"]

_CONVERGED = 1e-8
"""Fall of the objective in a step, as part of it, below which the fit stands still."""

_WARMTH = 10.0
"""[K] over which friction may change by all of its prior: joints at work get that much warmer."""

_LEAST_LEVEL = 1e-3
"""Of a joint's widest friction torque, that its Coulomb level is taken to have at least."""

_HELD, _HELD_PART = 1e-9, 1e-6
"""Prior deviation of what is held at its mean, in its own unit; of friction, as part of what it is otherwise, since a
model is weighed from where it is not held."""

_PARTS = (1.0, 0.5, 0.25, 0.1, 0.03)
"""Of a Gauss-Newton step that are tried, longest first: inertia is quadratic in its coordinates."""


@dataclass(frozen=True)
class ArmModel:
    """What is fitted beside links within the prior, rotors, and plain friction.

    Attributes:
        forms: Friction of each joint.
        opened: Links that may be far off.
        gain: Whether all torques may have a common gain.
        rotorless: Joints without a rotor's inertia: their torques, such as those of a sensor behind the gear, asked for
            less than none.
        pinned: Numbers of joints and names of friction parameters that are held at zero, since a joint would feed
            energy in with what the recording asks for.
    """

    forms: tuple[JointForm, ...]
    opened: frozenset[int] = frozenset()
    gain: bool = False
    rotorless: frozenset[int] = frozenset()
    pinned: frozenset[tuple[int, str]] = frozenset()


@dataclass(frozen=True)
class ArmFit:
    """What was found.

    Attributes:
        arm: The simulation.
        model: What was fitted.
        x: All parameters: links, rotors, friction of joint 1, 2, ..., delay, gain. Shape (n,).
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
        return np.array([LinkCoordinates(one).inertia(q) for one, q in zip(self.arm.inertia, p, strict=True)])

    @property
    def armature(self) -> FloatArray:
        """Inertia of each rotor [kg·m²]. Shape (n_joints,)."""
        first = N_INERTIA * len(self.arm.links)
        return self.x[first : first + len(self.arm.joints)]

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
        z = _Coordinates(self.arm, self.model).expand(self.x)[:, :-2]
        first = N_INERTIA * len(self.arm.links) + 1
        rigid = np.einsum("jnk,jk->nj", equations.columns[:, :, :first], z[:, :first])
        friction = np.einsum("jnk,jk->nj", equations.columns[:, :, first:-2], z[:, first:])
        return rigid, friction

    def residuals(self, equations: ArmEquations) -> FloatArray:
        """What is left of the torques at the rows, their delay allowed for [N·m]. Shape (n, n_joints)."""
        rigid, friction = self.predict(equations)
        return np.asarray(equations.columns[:, :, -1].T + self.x[-2] * equations.columns[:, :, -2].T - rigid - friction)

    def compute_load(self, rows: ArmRows) -> FloatArray:
        """Torque that the gears transmit at any rows [N·m]: rotors lie before them. Shape (n, n_joints)."""
        return np.asarray(rows.links @ self.inertia.ravel())


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
    coordinates = _Coordinates(arm, model)
    mean, deviation = coordinates.place_prior(equations, prior)
    x = mean.copy() if start is None else coordinates.take_over(start, mean)
    x = _descend(coordinates, equations, x, mean, deviation, steps)
    H, _, cost = _linearise(coordinates, equations, x)
    scaled = H * np.outer(deviation, deviation) + np.eye(x.size)
    weights = equations.weights
    penalty = float(np.sum(((x - mean) / deviation) ** 2))
    noise = float(np.sum(equations.counts * 2.0 * np.log(weights.noise) / weights.inflation))
    return ArmFit(
        arm=arm,
        model=model,
        x=x,
        covariance=np.linalg.inv(scaled) * np.outer(deviation, deviation),
        prior_deviation=deviation,
        log_evidence=-0.5 * float(cost + noise + penalty + np.linalg.slogdet(scaled)[1]),
        cost=cost,
    )


def measure_pulls(fit: ArmFit, stretches: Sequence[EquationSums]) -> list[tuple[FloatArray, FloatArray]]:
    """How single stretches of a recording hold and pull the parameters.

    Args:
        fit: Where they pull.
        stretches: Sums over the rows of each.

    Returns:
        Half the curvature and half the downward slope of the weighted squares of each. Shapes (n, n) and (n,).
    """
    coordinates = _Coordinates(fit.arm, fit.model)
    return [_linearise(coordinates, one, fit.x)[:2] for one in stretches]


class Glance:
    """How much more probable other models make a recording, by the slope and curvature at a fit of one of them.

    One linearisation with all terms serves every model that has some of them: their evidence is exact as far as the
    equations are linear, which all of friction is.

    Args:
        equations: Of all joints.
        fit: Where they are linearised.
        prior: How far the simulation is trusted.
    """

    def __init__(self, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> None:
        whole = JointForm(tuple((term.name, k) for term in TERMS.values() for k in range(len(term.values))))
        self._coordinates = _Coordinates(fit.arm, ArmModel(tuple(whole for _ in fit.arm.joints)))
        self._equations, self._fit, self._prior = equations, fit, prior
        zero = np.zeros(self._coordinates.size)
        self._x = self._coordinates.take_over(fit, zero)
        self._H, self._g, _ = _linearise(self._coordinates, equations, self._x)
        self._now = self._measure(fit.model)

    @property
    def n_links(self) -> int:
        """Number of links."""
        return len(self._fit.arm.links)

    def measure_gain(self, model: ArmModel) -> float:
        """Logarithm of the Bayes factor of a model against the one that was fitted."""
        return self._measure(model) - self._now

    def solve(self, model: ArmModel) -> ArmFit:
        """The fit of a model, as far as the equations are linear; its evidence is beside the others of this glance."""
        own = _Coordinates(self._fit.arm, model)
        mean, deviation = own.place_prior(self._equations, self._prior)
        at = self._find(own)
        scaled = self._H[np.ix_(at, at)] * np.outer(deviation, deviation) + np.eye(at.size)
        pull = deviation * self._g[at] - (self._x[at] - mean) / deviation
        spread = np.linalg.inv(scaled) * np.outer(deviation, deviation)
        x = self._x[at] + deviation * np.linalg.solve(scaled, pull)
        evidence = self._measure(model)
        return replace(self._fit, model=model, x=x, covariance=spread, prior_deviation=deviation, log_evidence=evidence)

    def _measure(self, model: ArmModel) -> float:
        own = _Coordinates(self._fit.arm, model)
        mean, deviation = own.place_prior(self._equations, self._prior)
        at = self._find(own)
        away = (self._x[at] - mean) / deviation
        scaled = self._H[np.ix_(at, at)] * np.outer(deviation, deviation) + np.eye(at.size)
        pull = deviation * self._g[at] - away
        gain = float(pull @ np.linalg.solve(scaled, pull)) - float(away @ away)
        return 0.5 * (gain - float(np.linalg.slogdet(scaled)[1]))

    def _find(self, own: _Coordinates) -> NDArray[np.intp]:
        """Places of a model's parameters among all."""
        rigid = self._coordinates.n_inertial + len(self._fit.arm.joints)
        at = list(range(rigid))
        for form, whole, place in zip(
            own.model.forms, self._coordinates.model.forms, self._coordinates.places, strict=True
        ):
            every = {name: k for k, name in enumerate(whole.columns)}
            at += [place.start + every[name] for name in form.columns]
        return np.array([*at, self._coordinates.size - 2, self._coordinates.size - 1])


def _descend(
    coordinates: _Coordinates,
    equations: ArmEquations | EquationSums,
    x: FloatArray,
    mean: FloatArray,
    deviation: FloatArray,
    steps: int,
) -> FloatArray:
    def judge(there: FloatArray) -> float:
        return _cost(coordinates, equations, there) + float(np.sum(((there - mean) / deviation) ** 2))

    value = judge(x)
    for _ in range(steps):
        H, g, _ = _linearise(coordinates, equations, x)
        scaled = H * np.outer(deviation, deviation) + np.eye(x.size)
        step = deviation * np.linalg.solve(scaled, deviation * g - (x - mean) / deviation)
        there, best = x, value
        for part in _PARTS:
            there = x + part * step
            best = judge(there)
            if best < value:
                break
        if not best < value:
            break
        x, fall, value = there, value - best, best
        if fall <= _CONVERGED * abs(value):
            break
    return x


def _cost(coordinates: _Coordinates, equations: ArmEquations | EquationSums, x: FloatArray) -> float:
    z, weights = coordinates.expand(x), equations.weights
    return float(np.sum(np.einsum("jk,jkl,jl->j", z, equations.sums, z) / (weights.noise**2 * weights.inflation)))


def _linearise(
    coordinates: _Coordinates, equations: ArmEquations | EquationSums, x: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Half the curvature and half the downward slope of the weighted squares, and their sum."""
    z, slopes, weights = coordinates.expand(x), coordinates.slopes(x), equations.weights
    H, g, cost = np.zeros((x.size, x.size)), np.zeros(x.size), 0.0
    scale = 1.0 / (weights.noise**2 * weights.inflation)
    for j, slope in enumerate(slopes):
        pulled = equations.sums[j] @ slope
        H += scale[j] * (slope.T @ pulled)
        g -= scale[j] * (pulled.T @ z[j])
        cost += scale[j] * float(z[j] @ equations.sums[j] @ z[j])
    return H, g, cost


class _Coordinates:
    """How the parameters x of a model stand in the columns of each joint."""

    def __init__(self, arm: SimulatedArm, model: ArmModel) -> None:
        self.arm, self.model = arm, model
        self.links = [LinkCoordinates(one) for one in arm.inertia]
        self.n_inertial = N_INERTIA * len(arm.links)
        every = {name: k for k, name in enumerate(column_names())}
        first = self.n_inertial + 1
        self.columns = [np.array([first + every[name] for name in form.columns]) for form in model.forms]
        sizes = np.cumsum([self.n_inertial + len(arm.joints), *(len(c) for c in self.columns)])
        self.places = [slice(int(a), int(b)) for a, b in pairwise(sizes)]
        self.size, self.width = int(sizes[-1]) + 2, first + len(every) + 2

    def expand(self, x: FloatArray) -> FloatArray:
        """Weights of the columns whose sum is what is left, with its sign turned. Shape (n_joints, n_columns)."""
        z = np.zeros((len(self.arm.joints), self.width))
        p = x[: self.n_inertial].reshape(-1, N_INERTIA)
        z[:, : self.n_inertial] = np.concatenate([link.inertia(q) for link, q in zip(self.links, p, strict=True)])
        z[:, self.n_inertial] = x[self.n_inertial : self.n_inertial + len(self.arm.joints)]
        for j, (columns, place) in enumerate(zip(self.columns, self.places, strict=True)):
            z[j, columns] = x[place]
        z[:, :-2] *= 1.0 + x[-1]
        z[:, -2], z[:, -1] = -x[-2], -1.0
        return z

    def slopes(self, x: FloatArray) -> list[FloatArray]:
        """Derivative of each joint's weights by x. Shapes (n_columns, size)."""
        p = x[: self.n_inertial].reshape(-1, N_INERTIA)
        inertial = np.zeros((self.n_inertial, self.n_inertial))
        for i, (link, q) in enumerate(zip(self.links, p, strict=True)):
            at = slice(N_INERTIA * i, N_INERTIA * (i + 1))
            inertial[at, at] = link.jacobian(q)
        z, result = self.expand(x), []
        for j, (columns, place) in enumerate(zip(self.columns, self.places, strict=True)):
            slope = np.zeros((self.width, self.size))
            slope[: self.n_inertial, : self.n_inertial] = inertial
            slope[self.n_inertial, self.n_inertial + j] = 1.0
            slope[columns, np.arange(place.start, place.stop)] = 1.0
            slope *= 1.0 + x[-1]
            slope[:-2, -1] = z[j, :-2] / (1.0 + x[-1])
            slope[-2, -2] = -1.0
            result.append(slope)
        return result

    def take_over(self, fit: ArmFit, mean: FloatArray) -> FloatArray:
        """Parameters of another fit, in the places that they have here."""
        x = mean.copy()
        rigid = self.n_inertial + len(self.arm.joints)
        x[:rigid], x[-2:] = fit.x[:rigid], fit.x[-2:]
        for j, place in enumerate(self.places):
            before = fit.friction(j)
            x[place] = [before.get(name, 0.0) for name in self.model.forms[j].columns]
        return x

    def place_prior(self, equations: ArmEquations | EquationSums, prior: ArmPrior) -> tuple[FloatArray, FloatArray]:
        """Mean and standard deviation of x before the recording. Shapes (size,)."""
        arm, mean, deviation = self.arm, np.zeros(self.size), np.ones(self.size)
        wide = [prior.opened if i in self.model.opened else prior.links for i in range(len(arm.links))]
        deviation[: self.n_inertial] = np.repeat(wide, N_INERTIA)
        mean[self.n_inertial : self.n_inertial + len(arm.joints)] = arm.armature
        for j, place in enumerate(self.places):
            sums = equations.sums[j]
            own = abs(float(sums[self.n_inertial, : self.n_inertial] @ arm.inertia.ravel()))
            own /= max(float(sums[self.n_inertial, self.n_inertial]), 1e-12)
            deviation[self.n_inertial + j] = prior.rotors * max(own + arm.armature[j], 1e-9)
            if j in self.model.rotorless:
                mean[self.n_inertial + j], deviation[self.n_inertial + j] = 0.0, _HELD
            ones = max(float(sums[self.n_inertial + 2, self.n_inertial + 2]), 1.0)  # of the column of the offset
            typical = prior.friction * np.sqrt(max(float(sums[-1, -1]) / ones, 1e-18))
            speed, level = float(equations.top_speed[j]), self._guess_level(sums, j, typical)
            by_level = {"stribeck": prior.stribeck * level, "spring_torque": prior.spring * level}
            deviation[place] = [
                by_level.get(name.split(".")[0], 0.0) or _size_column(name, typical, speed, prior)
                for name in self.model.forms[j].columns
            ]
            held = [(j, name) in self.model.pinned for name in self.model.forms[j].columns]
            deviation[place] *= np.where(held, _HELD_PART, 1.0)
        deviation[-2], deviation[-1] = prior.delay, prior.gain if self.model.gain else _HELD
        return mean, deviation

    def _guess_level(self, sums: FloatArray, joint: int, typical: float) -> float:
        """Coulomb level of a joint beside its simulated torque times a factor [N·m] or [N]."""
        some = np.zeros((sums.shape[0], 1 + len(PLAIN)))
        some[: self.n_inertial, 0] = self.arm.inertia.ravel()
        some[self.n_inertial, 0] = self.arm.armature[joint]
        some[self.n_inertial + 1 : self.n_inertial + 1 + len(PLAIN), 1:] = np.eye(len(PLAIN))
        found = np.linalg.lstsq(some.T @ sums @ some, some.T @ sums[:, -1], rcond=None)[0]
        return max(abs(float(found[1 + PLAIN.index("coulomb")])), _LEAST_LEVEL * typical)


def _size_column(name: str, torque: float, speed: float, prior: ArmPrior) -> float:
    """Prior deviation of a friction parameter, from a typical torque [N·m] and the joint's top speed [rad/s]."""
    if name.startswith("torque_delay"):
        return prior.delay
    if name.startswith("torque_gain_error"):
        return prior.gain
    if name.startswith("thermal_friction"):
        return torque / _WARMTH / (speed if ".viscous" in name else 1.0)
    if name.startswith("load_coulomb"):
        return prior.load_friction
    if name.startswith("load_quadratic"):
        return prior.load_friction / max(torque / prior.friction, 1e-9)
    if name.startswith("viscous"):
        return torque / speed
    return torque / speed**2 if name.startswith("quadratic_drag") else torque
