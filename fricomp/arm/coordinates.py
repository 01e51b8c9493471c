"""How the parameters of an arm's model stand in the columns of its equations, and what is known of them beforehand."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

from .equations import N_LAST, count_columns, find_reached
from .friction import GEARS, PLAIN, TERMS, JointForm, column_names
from .prior import ArmPrior
from .prior.sizes import PriorSizes, size_friction
from .rigid.inertia import N_INERTIA
from .rigid.simulated_arm import SimulatedArm

_HELD = 1e-9
"""Prior deviation of what is held at its mean, in its own unit."""

_NUMBERS = {name: k for k, name in enumerate(column_names())}
"""Number of each column of friction by its name."""

_REACHING = {name: term.filled for term in TERMS.values() if term.filled in GEARS for name in term.names(0)}
"""Parameters that the other joints feel, each by one column, and what that is made of."""


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

    @property
    def geared(self) -> bool:
        """Whether a gear of some joint has a gap or gives way."""
        return any(form.geared for form in self.forms)

    def with_form(self, joint: int, form: JointForm) -> ArmModel:
        """The model with another friction of one joint."""
        return replace(self, forms=(*self.forms[:joint], form, *self.forms[joint + 1 :]))

    def without_terms(self, joint: int, *terms: str) -> ArmModel:
        """The model without some terms of a joint, and without what plain friction was held at zero beside them."""
        form = self.forms[joint]
        for term in terms:
            form = form.without_term(term)
        kept = frozenset(one for one in self.pinned if one[0] != joint or one[1] not in PLAIN)
        return replace(self.with_form(joint, form), pinned=kept)


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
        z, v = np.zeros((len(self.arm.joints), self.width)), self.weigh(x)
        for one, (at, taken) in zip(z, self.places_felt, strict=True):
            one[taken] = v[at]
        return z

    def weigh(self, x: FloatArray) -> FloatArray:
        """The same weights once each, in the order of x, with that of the torque in the place of the gain. Shape
        (size,)."""
        v: FloatArray = (1.0 + x[-1]) * x
        p = x[: self.n_inertial].reshape(-1, N_INERTIA)
        v[: self.n_inertial] = (1.0 + x[-1]) * self.links.inertia(p).ravel()
        v[-2], v[-1] = -x[-2], -1.0
        return v

    @cached_property
    def columns(self) -> list[NDArray[np.intp]]:
        """Columns of friction that act in each joint: its own, and those of others that reach it."""
        return [taken[self.n_inertial + 1 : -N_LAST] for _, taken in self.places_felt]

    @cached_property
    def places_felt(self) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
        """Places of all that a joint feels, the torque in that of the gain, and their columns."""
        links, n = np.arange(self.n_inertial), self.n_inertial
        shared, last = (np.arange(size - N_LAST, size) for size in (self.size, self.width))
        pairs = [np.array(self._list_felt(j)).T for j in range(len(self.arm.joints))]
        return [
            (np.concatenate([links, [n + j], felt, shared]), np.concatenate([links, [n], columns, last]))
            for j, (felt, columns) in enumerate(pairs)
        ]

    def take_over(self, model: ArmModel, x: FloatArray, mean: FloatArray) -> FloatArray:
        """Parameters x of another model, in the places that they have here; of what it lacks, those of `mean`."""
        result, other = mean.copy(), place_parameters(self.arm, model)
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
        for j, (form, place) in enumerate(zip(self.model.forms, self.places, strict=True)):
            deviation[place] = size_friction(sizes, prior, j, form.columns, self.model.pinned)
        deviation[-N_LAST:-2] = prior.tilt if self.model.tilted else _HELD
        deviation[-2] = _HELD if self.model.prompt else prior.delay
        deviation[-1] = prior.gain if self.model.gain else _HELD
        return mean, deviation


@lru_cache(maxsize=1024)
def place_parameters(arm: SimulatedArm, model: ArmModel) -> Coordinates:
    """The coordinates of a model, which a search asks for many times."""
    return Coordinates(arm, model)
