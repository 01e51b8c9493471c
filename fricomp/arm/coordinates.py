"""How the parameters of an arm's model stand in the columns of its equations, and what is known of them beforehand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

from .equations import N_LAST, ArmEquations, EquationSums, count_columns, find_reached
from .friction import GEARS, PLAIN, TERMS, JointForm, column_names
from .prior import ArmPrior
from .rigid.inertia import N_INERTIA
from .rigid.simulated_arm import SimulatedArm

_WARMTH = 10.0
"""[K] over which friction may change by all of its prior: joints at work get that much warmer."""

_LEAST_LEVEL = 1e-3
"""Of a joint's widest friction torque, that its Coulomb level is taken to have at least."""

_HELD, _HELD_PART = 1e-9, 1e-6
"""Prior deviation of what is held at its mean, in its own unit; of friction, as part of what it is otherwise, since a
model is weighed from where it is not held."""

_NUMBERS = {name: k for k, name in enumerate(column_names())}
"""Number of each column of friction by its name."""

_REACHING = {name: term.filled for term in TERMS.values() if term.filled in GEARS for name in term.names(0)}
"""Parameters that the other joints feel, each by one column, and what that is made of."""

_WHOLE = frozenset(term.name for term in TERMS.values() if term.whole)
"""Terms whose one parameter is a share that should be one."""


@dataclass(frozen=True)
class ArmModel:
    """What is fitted beside links within the prior, rotors, and plain friction.

    Attributes:
        forms: Friction of each joint.
        opened: Links that may be far off.
        tilted: Whether gravity may lean over, as it does where the base of the arm is not level.
        gain: Whether all torques may have a common gain.
        prompt: Whether the time by which all torques are late is held where the rows have it.
        rotorless: Joints without a rotor's inertia: their torques, such as those of a sensor behind the gear, asked for
            less than none.
        pinned: Numbers of joints and names of friction parameters that are held at zero, since a joint would feed
            energy in with what the recording asks for.
    """

    forms: tuple[JointForm, ...]
    opened: frozenset[int] = frozenset()
    tilted: bool = False
    gain: bool = False
    prompt: bool = False
    rotorless: frozenset[int] = frozenset()
    pinned: frozenset[tuple[int, str]] = frozenset()

    @classmethod
    def build_plain(cls, joints: int) -> ArmModel:
        """Nothing beside plain friction in this many joints."""
        return cls((JointForm(),) * joints)


class Linearised(NamedTuple):
    """The weighted squares about some parameters.

    Attributes:
        curvature: Half of it. Shape (size, size).
        pull: Half the downward slope. Shape (size,).
        cost: The squares themselves.
    """

    curvature: FloatArray
    pull: FloatArray
    cost: float


@dataclass(frozen=True)
class PriorSizes:
    """What the prior of each joint is measured in, as the simulation and the recording have it. Shapes (n_joints,).

    Attributes:
        rotor: A rotor's inertia as far as it may be off: all that is stated and that the torques allow [kg·m²] or [kg].
        torque: A friction torque as wide as the prior lets it be [N·m] or [N].
        level: Coulomb friction beside the simulated torque [N·m] or [N].
        speed: Top speed [rad/s] or [m/s].
    """

    rotor: FloatArray
    torque: FloatArray
    level: FloatArray
    speed: FloatArray


class Coordinates:
    """How the parameters x of a model stand in the columns of each joint.

    x holds links, rotors, friction of joint 1, 2, ..., lean of gravity, delay, gain; squares are those of the weights

        z_j = [(1 + g) (θ(p), r_j, f_j, t), -δ, -1]

    times the columns of joint j. Columns that a model does not have are never multiplied.

    Args:
        arm: The simulation.
        model: What is fitted.
    """

    def __init__(self, arm: SimulatedArm, model: ArmModel) -> None:
        self.arm, self.model = arm, model
        self.links = arm.all_coordinates
        self.n_inertial = N_INERTIA * len(arm.links)
        sizes = np.cumsum([self.n_inertial + len(arm.joints), *(len(form.columns) for form in model.forms)])
        self.places = [slice(int(a), int(b)) for a, b in pairwise(sizes)]
        self.size, self.width = int(sizes[-1]) + N_LAST, count_columns(self.n_inertial + 1, len(arm.joints))

    @cached_property
    def columns(self) -> list[NDArray[np.intp]]:
        """Columns of friction that act in each joint: its own, and those of others that reach it."""
        return [np.array([column for _, column in pairs]) for pairs in self._felt]

    @cached_property
    def felt(self) -> list[NDArray[np.intp]]:
        """Places of their parameters."""
        return [np.array([at for at, _ in pairs]) for pairs in self._felt]

    @cached_property
    def _felt(self) -> list[list[tuple[int, int]]]:
        return [self._list_felt(j) for j in range(len(self.arm.joints))]

    def _list_felt(self, joint: int) -> list[tuple[int, int]]:
        """Friction parameters that act in a joint, with their columns there: its own, and what reaches it of others."""
        count, first = len(self.arm.joints), self.n_inertial + 1
        own = [self.places[joint].start + k for k in range(len(self.model.forms[joint].columns))]
        pairs = list(zip(own, (first + _NUMBERS[name] for name in self.model.forms[joint].columns), strict=True))
        for j, (form, place) in enumerate(zip(self.model.forms, self.places, strict=True)):
            if j != joint:
                pairs += [
                    (place.start + k, find_reached(first, joint, j, count, _REACHING[name]))
                    for k, name in enumerate(form.columns)
                    if name in _REACHING
                ]
        return pairs

    def expand(self, x: FloatArray) -> FloatArray:
        """Weights of the columns whose sum is what is left, with its sign turned. Shape (n_joints, n_columns)."""
        z = np.zeros((len(self.arm.joints), self.width))
        p = x[: self.n_inertial].reshape(-1, N_INERTIA)
        z[:, : self.n_inertial] = self.links.inertia(p).ravel()
        z[:, self.n_inertial] = x[self.n_inertial : self.n_inertial + len(self.arm.joints)]
        for j, (columns, felt) in enumerate(zip(self.columns, self.felt, strict=True)):
            z[j, columns] = x[felt]
        z[:, -N_LAST:-2] = x[-N_LAST:-2]
        z[:, :-2] *= 1.0 + x[-1]
        z[:, -2], z[:, -1] = -x[-2], -1.0
        return z

    def measure_cost(self, equations: ArmEquations | EquationSums, x: FloatArray) -> float:
        """Weighted squares of what is left."""
        z, scale = self.expand(x), _scale(equations)
        return float(sum(scale[j] * (one @ equations.sums[j] @ one) for j, one in enumerate(z)))

    def linearise(self, equations: ArmEquations | EquationSums, x: FloatArray) -> Linearised:
        """The weighted squares and their slopes at x.

        Links enter all joints by the same derivative, so that it is taken once, of what the joints add up to.
        """
        z, scale, gain, cost = self.expand(x), _scale(equations), 1.0 + float(x[-1]), 0.0
        H, g, n = np.zeros((self.size, self.size)), np.zeros(self.size), self.n_inertial
        for j, (at, taken) in enumerate(self._places_felt):
            own, weights = equations.sums[j].take(taken, 0).take(taken, 1), z[j, taken]
            slope = np.full(at.size, gain)
            slope[-1] = -1.0  # of the delay, which no gain changes
            along = weights / gain  # what grows with the gain
            along[-2:] = 0.0
            left, gained = scale[j] * (own @ weights), scale[j] * (own @ along)
            H[:n, :n] += scale[j] * gain**2 * own[:n, :n]
            H[:n, at[n:]] += scale[j] * gain * slope[n:] * own[:n, n:-1]
            H[np.ix_(at[n:], at[n:])] += scale[j] * np.outer(slope[n:], slope[n:]) * own[n:-1, n:-1]
            H[at, -1] += slope * gained[:-1]
            H[-1, -1] += along @ gained
            g[at] -= slope * left[:-1]
            g[-1] -= along @ left
            cost += float(weights @ left)
        H[-1, self.n_inertial :] = H[self.n_inertial :, -1]
        self._turn_links(H, g, x)
        return Linearised(H, g, cost)

    @cached_property
    def _places_felt(self) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
        """Places of all parameters that a joint feels but the gain, and their columns with that of the torque."""
        links, n = np.arange(self.n_inertial), self.n_inertial
        shared, last = (np.arange(size - N_LAST, size - 1) for size in (self.size, self.width))
        return [
            (
                np.concatenate([links, [n + j], felt, shared]),
                np.concatenate([links, [n], columns, last, [self.width - 1]]),
            )
            for j, (columns, felt) in enumerate(zip(self.columns, self.felt, strict=True))
        ]

    def _turn_links(self, H: FloatArray, g: FloatArray, x: FloatArray) -> None:
        """From the inertia of links to their coordinates, in place; of H what is above the blocks of links is given."""
        p = x[: self.n_inertial].reshape(-1, N_INERTIA)
        turns = np.swapaxes(self.links.jacobian(p), 1, 2)
        shape = (len(p), N_INERTIA, -1)
        H[: self.n_inertial] = (turns @ H[: self.n_inertial].reshape(shape)).reshape(self.n_inertial, -1)
        own = H[: self.n_inertial, : self.n_inertial].T
        H[: self.n_inertial, : self.n_inertial] = (turns @ own.reshape(shape)).reshape(self.n_inertial, -1)
        H[self.n_inertial :, : self.n_inertial] = H[: self.n_inertial, self.n_inertial :].T
        g[: self.n_inertial] = (turns @ g[: self.n_inertial].reshape(shape)).ravel()

    def take_over(self, model: ArmModel, x: FloatArray, mean: FloatArray) -> FloatArray:
        """Parameters x of another model, in the places that they have here; of what it lacks, those of `mean`."""
        result, other = mean.copy(), Coordinates(self.arm, model)
        rigid = self.n_inertial + len(self.arm.joints)
        result[:rigid], result[-N_LAST:] = x[:rigid], x[-N_LAST:]
        for form, place, before, there in zip(self.model.forms, self.places, model.forms, other.places, strict=True):
            known = dict(zip(before.columns, x[there].tolist(), strict=True))
            result[place] = [known.get(name, 0.0) for name in form.columns]
        if self.model.prompt:
            result[-2] = 0.0
        return result

    def place_prior(self, sizes: PriorSizes, prior: ArmPrior) -> tuple[FloatArray, FloatArray]:
        """Mean and standard deviation of x before the recording. Shapes (size,)."""
        arm, mean, deviation = self.arm, np.zeros(self.size), np.ones(self.size)
        wide = [prior.opened if i in self.model.opened else prior.links for i in range(len(arm.links))]
        deviation[: self.n_inertial] = np.repeat(wide, N_INERTIA)
        rotors = slice(self.n_inertial, self.n_inertial + len(arm.joints))
        mean[rotors] = arm.armature
        deviation[rotors] = sizes.rotor
        for j in self.model.rotorless:
            mean[self.n_inertial + j], deviation[self.n_inertial + j] = 0.0, _HELD
        for j, place in enumerate(self.places):
            typical, speed, level = float(sizes.torque[j]), float(sizes.speed[j]), float(sizes.level[j])
            deviation[place] = _size_columns(self.model.forms[j].columns, typical, speed, level, prior)
            if self.model.pinned:
                held = [(j, name) in self.model.pinned for name in self.model.forms[j].columns]
                deviation[place] *= np.where(held, _HELD_PART, 1.0)
        deviation[-N_LAST:-2] = prior.tilt if self.model.tilted else _HELD
        deviation[-2] = _HELD if self.model.prompt else prior.delay
        deviation[-1] = prior.gain if self.model.gain else _HELD
        return mean, deviation


def measure_sizes(arm: SimulatedArm, equations: ArmEquations | EquationSums, prior: ArmPrior) -> PriorSizes:
    """What the priors of the joints are measured in; no model changes it, so that it is measured once."""
    known: dict[ArmPrior, PriorSizes] = equations.__dict__.setdefault("_sizes", {})
    if prior not in known:
        known[prior] = _measure_sizes(arm, equations, prior)
    return known[prior]


def _measure_sizes(arm: SimulatedArm, equations: ArmEquations | EquationSums, prior: ArmPrior) -> PriorSizes:
    n, sums = N_INERTIA * len(arm.links), equations.sums
    squares = np.maximum(sums[:, n, n], 1e-12)  # of the acceleration
    rotor = np.maximum(prior.rotors * (arm.armature + np.sqrt(sums[:, -1, -1] / squares)), 1e-9)
    ones = np.maximum(sums[:, n + 2, n + 2], 1.0)  # of the column of the offset
    typical = prior.friction * np.sqrt(np.maximum(sums[:, -1, -1] / ones, 1e-18))
    return PriorSizes(rotor, typical, _guess_levels(arm, sums, typical), equations.top_speed)


def _scale(equations: ArmEquations | EquationSums) -> FloatArray:
    """Weight of the squares of each joint. Shape (n_joints,)."""
    return np.asarray(1.0 / (equations.weights.noise**2 * equations.weights.inflation))


def _guess_levels(arm: SimulatedArm, sums: FloatArray, typical: FloatArray) -> FloatArray:
    """Coulomb level of each joint beside its simulated torque times a factor [N·m] or [N]."""
    n, last = arm.inertia.size, arm.inertia.size + 1 + len(PLAIN)
    some = np.zeros((len(sums), last, 1 + len(PLAIN)))
    some[:, :n, 0], some[:, n, 0] = arm.inertia.ravel(), arm.armature
    some[:, n + 1 :, 1:] = np.eye(len(PLAIN))
    across = np.swapaxes(some, 1, 2)
    whole, pull = across @ (sums[:, :last, :last] @ some), across @ sums[:, :last, -1:]
    found = (np.linalg.pinv(whole, hermitian=True) @ pull)[:, 1 + PLAIN.index("coulomb"), 0]
    return np.maximum(np.abs(found), _LEAST_LEVEL * typical)


@lru_cache(maxsize=4096)
def _size_columns(names: tuple[str, ...], torque: float, speed: float, level: float, prior: ArmPrior) -> FloatArray:
    """Prior deviations of friction parameters, as those of `_size_column`; some follow the Coulomb level [N·m]."""
    by_level = {"stribeck": prior.stribeck * level, "spring_torque": prior.spring * level}
    sizes = [by_level.get(name.split(".")[0], 0.0) or _size_column(name, torque, speed, prior) for name in names]
    result = np.array(sizes)
    result.flags.writeable = False
    return result


def _size_column(name: str, torque: float, speed: float, prior: ArmPrior) -> float:
    """Prior deviation of a friction parameter, from a typical torque [N·m] and the joint's top speed [rad/s]."""
    if name.startswith("torque_delay"):
        return prior.delay
    if name.partition(".")[0] in _WHOLE:
        return 1.0
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
