"""A friction law turned into what MuJoCo can hold still: a bound on the dry torque, plus torques applied outright.

MuJoCo's `dof_frictionloss` L is a constraint force anywhere in [-L, L] that brings the end-of-step velocity to zero
if it can: true sticking. A law is therefore split, at the joint's present state, into

- the level: its torque against the direction s of motion, L = s (tau(s |v|) - tau(0)) with tau(0) the torque at rest;
- the offset tau(0): terms such as cogging that do not depend on the direction, applied as an outside torque;
- the bristle torque of dynamic terms (Dahl, LuGre), likewise applied; of those whose dry part is a level with a memory
  (rests, a lag), what is not dry.

The level is taken at the end-of-step speed, linearised in it: rising branches, however steep, cannot overshoot.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from math import exp, expm1
from typing import NamedTuple

import numpy as np

from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    Dahl,
    DwellStiction,
    DynamicTerm,
    FrictionLaw,
    LaggedStribeck,
    LoadScaling,
    LuGre,
    OperatingPoint,
    Stribeck,
    StribeckCurve,
    Term,
    Viscous,
)

__all__ = ["Contact", "JointFriction", "remembered_level"]

# Speed that stands for "just sliding" where a term must be told a direction [rad/s] or [m/s].
CREEP = 1e-9
# Exponent beyond which exp(-x) is nothing beside one.
NO_FALL = 50.0
# Relative and absolute step of the numerical slope of a term that has no compiled form [rad/s].
SLOPE_STEP = 1e-4


class Contact:
    """What friction depends on besides velocity; one object a joint, rewritten every step.

    Attributes:
        position: [rad] or [m].
        acceleration: [rad/s²] or [m/s²].
        load_torque: Torque that the joint transmits to its load [N·m] or [N].
        normal_load: In the unit of the law's reference load; None where the law is to take its reference.
        temperature: [°C].
    """

    __slots__ = ("acceleration", "load_torque", "normal_load", "position", "temperature")

    def __init__(self) -> None:
        self.position = 0.0
        self.acceleration = 0.0
        self.load_torque = 0.0
        self.normal_load: float | None = None
        self.temperature: float | None = None

    def point(self, velocity: float | np.ndarray) -> OperatingPoint:
        """The operating point that a friction term takes."""
        return OperatingPoint(
            velocity, self.position, self.acceleration, self.load_torque, self.normal_load, self.temperature
        )


# (direction, speed, contact) -> level [N·m] and its slope over speed [N·m·s/rad].
Level = Callable[[float, float, Contact], tuple[float, float]]
# (velocity, contact, dt) -> torque [N·m] after the step; keeps the state itself.
Bristle = Callable[[float, Contact, float], float]


class RememberedLevel(NamedTuple):
    """A dry level with a state.

    Attributes:
        level: The level as it is.
        advance: Takes the state on, and gives the torque of the term that is not dry.
    """

    level: Level
    advance: Bristle


class JointFriction:
    """The friction of one joint, in plain floats: a step of the default law costs about a microsecond.

    Args:
        law: Any friction law; terms without a compiled form are evaluated as they are, which is slower.
    """

    def __init__(self, law: FrictionLaw) -> None:
        self.law = law
        self.offset = 0.0
        """Torque of the law at rest [N·m], at the last step."""
        self.bristle_torque = 0.0
        """Torque of the dynamic terms beside their level [N·m], at the last step."""
        statics = [term for term in law.terms if not isinstance(term, DynamicTerm)]
        compiled = [level_of(term) for term in statics]
        self._stateless = [level for level in compiled if level is not None]
        self._others = [term for term, level in zip(statics, compiled, strict=True) if level is None]
        self._start()
        self._probe = np.zeros(5)
        self._sampled = np.zeros(5)

        self.pushes = bool(self._others or self._bristles)
        """Whether `applied` can be other than zero."""

    def reset(self) -> None:
        """Back to rest without load."""
        self._start()
        self.offset = self.bristle_torque = 0.0

    def _start(self) -> None:
        """States of the dynamic terms at rest."""
        dynamic = [term for term in self.law.terms if isinstance(term, DynamicTerm)]
        levels = [remembered_level(term) for term in dynamic]
        remembered = [level for level in levels if level is not None]
        self._bristles = [bristle_of(term) for term, level in zip(dynamic, levels, strict=True) if level is None]
        self._bristles += [level.advance for level in remembered]
        self._levels = [*self._stateless, *(level.level for level in remembered)]
        self._only = self._levels[0] if len(self._levels) == 1 and not self._others else None

    def applied(self, velocity: float, contact: Contact, dt: float) -> float:
        """Torque [N·m] that acts whatever the direction of motion: offsets and bristles, advanced by `dt` [s].

        Needed before every `level` of a law that `pushes`.
        """
        if self._others:
            self._sample(velocity, contact)
            self.offset = float(self._sampled[0])
        if self._bristles:
            self.bristle_torque = sum(bristle(velocity, contact, dt) for bristle in self._bristles)
        return self.offset + self.bristle_torque

    def level(self, velocity: float, free_velocity: float, mobility: float, contact: Contact) -> float:
        """Bound on the dry torque over the coming step [N·m].

        Args:
            velocity: At the start of the step [rad/s].
            free_velocity: At its end if there were no friction [rad/s]; its sign is the direction of motion or,
                at rest, of impending motion.
            mobility: Step over inertia, dt/J: change of velocity a unit of torque makes [rad/s/(N·m)].
            contact: The joint's state.
        """
        direction = 1.0 if free_velocity >= 0.0 else -1.0
        speed = velocity * direction
        speed = speed if speed > 0.0 else 0.0
        if self._only is not None:
            total, slope = self._only(direction, speed, contact)
        else:
            total, slope = self._sum(direction, speed, contact)
        if slope > 0.0:
            after = (free_velocity * direction - mobility * (total - slope * speed)) / (1.0 + mobility * slope)
            total += slope * ((after if after > 0.0 else 0.0) - speed)
        return total if total > 0.0 else 0.0

    def _sum(self, direction: float, speed: float, contact: Contact) -> tuple[float, float]:
        parts = [function(direction, speed, contact) for function in self._levels]
        if self._others:
            parts.append(self._sampled_level(direction, speed))
        return sum(value for value, _ in parts), sum(rise for _, rise in parts)

    def _sample(self, velocity: float, contact: Contact) -> None:
        """Torque of the terms without a compiled form at rest and at two speeds in either direction."""
        speed = max(abs(velocity), CREEP)
        step = SLOPE_STEP * (speed + SLOPE_STEP)
        self._probe[:] = (0.0, speed, speed + step, -speed, -speed - step)
        point = contact.point(self._probe)
        self._sampled[:] = 0.0
        for term in self._others:
            self._sampled += np.asarray(term.torque(point))

    def _sampled_level(self, direction: float, speed: float) -> tuple[float, float]:
        rest, *forward, reverse, reverse_next = self._sampled.tolist()
        near, far = (forward[0] - rest, forward[1] - rest) if direction > 0.0 else (rest - reverse, rest - reverse_next)
        probed = float(self._probe[1])
        slope = max((far - near) / (float(self._probe[2]) - probed), 0.0)
        # After a reversal within the step the sample was taken at the old speed: slide back along the tangent.
        return near + slope * (speed - probed), slope


@singledispatch
def level_of(term: Term) -> Level | None:
    """The level of `term` in plain floats, or None where it has no compiled form."""
    return None


@level_of.register
def _(term: Coulomb) -> Level:
    factor = _load_factor(term.load)
    return lambda direction, speed, contact: (term.coulomb_torque * factor(contact), 0.0)


@level_of.register
def _(term: Viscous) -> Level:
    f_v = term.viscous_coefficient
    return lambda direction, speed, contact: (f_v * speed, f_v)


@level_of.register
def _(term: Stribeck) -> Level:
    return stribeck_level(term.curve, term.curve, term.load)


@level_of.register
def _(term: BidirectionalStribeck) -> Level:
    return stribeck_level(term.forward, term.reverse, term.load)


def stribeck_level(forward: StribeckCurve, reverse: StribeckCurve, load: LoadScaling) -> Level:
    """Stribeck friction in plain floats; the viscous part is not scaled by the load."""
    factor = _load_factor(load)
    numbers_forward, numbers_reverse = _curve_numbers(forward), _curve_numbers(reverse)

    def level(direction: float, speed: float, contact: Contact) -> tuple[float, float]:
        f_c, fall, v_s, delta, f_v = numbers_forward if direction > 0.0 else numbers_reverse
        ratio = speed / v_s
        power = ratio * ratio if delta == 2.0 else ratio**delta
        dry = f_c + fall * exp(-power) if power < NO_FALL else f_c
        if contact.normal_load is not None:
            dry *= factor(contact)
        return dry + f_v * speed, f_v

    return level


@singledispatch
def remembered_level(term: DynamicTerm) -> RememberedLevel | None:
    """The dry part of `term` in plain floats that keeps its own state, from rest; None where it is no level against
    which the joint holds still.
    """
    return None


@remembered_level.register
def _(term: DwellStiction) -> RememberedLevel:
    share = 0.0

    def advance(velocity: float, contact: Contact, dt: float) -> float:
        nonlocal share
        speed = abs(velocity)
        if speed < term.rest_speed:
            share -= expm1(-dt / term.time_constant) * (1.0 - share)
        else:
            share *= exp(-speed * dt / term.travel)
        return 0.0

    return RememberedLevel(lambda direction, speed, contact: (term.rise * share, 0.0), advance)


@remembered_level.register
def _(term: LaggedStribeck) -> RememberedLevel:
    curve = stribeck_level(term.forward, term.reverse, LoadScaling(load_sensitivity=0.0))
    factor, felt = _load_factor(term.load), 0.0

    def advance(velocity: float, contact: Contact, dt: float) -> float:
        nonlocal felt
        felt = velocity + (felt - velocity) * exp(-dt / term.lag)
        return curve(1.0 if velocity >= 0.0 else -1.0, 0.0, contact)[1] * felt

    def level(direction: float, speed: float, contact: Contact) -> tuple[float, float]:
        total, viscous = curve(direction, abs(felt), contact)
        return (total - viscous * abs(felt)) * factor(contact), 0.0

    return RememberedLevel(level, advance)


def bristle_of(term: DynamicTerm) -> Bristle:
    """A dynamic term in plain floats that keeps its own state, from rest."""
    if type(term) is LuGre:
        return _lugre(term)
    if type(term) is Dahl:
        return _dahl(term)
    state = term.rest_state()

    def advance(velocity: float, contact: Contact, dt: float) -> float:
        nonlocal state
        torque, state = term.advance(state, contact.point(velocity), dt)
        return float(torque)

    return advance


def _dahl(term: Dahl) -> Bristle:
    factor, z = _load_factor(term.load), 0.0

    def advance(velocity: float, contact: Contact, dt: float) -> float:
        nonlocal z
        z = _advance_bristle(z, velocity, term.coulomb_torque * factor(contact) / term.sigma_0, dt)
        return term.sigma_0 * z

    return advance


def _lugre(term: LuGre) -> Bristle:
    z, unloaded = 0.0, LoadScaling(load_sensitivity=0.0)
    factor = _load_factor(term.load)
    curve = stribeck_level(term.forward, term.reverse, unloaded)
    sigma_0, sigma_1 = term.sigma_0, term.sigma_1

    def advance(velocity: float, contact: Contact, dt: float) -> float:
        nonlocal z
        speed = abs(velocity)
        level, f_v = curve(1.0 if velocity >= 0.0 else -1.0, speed, contact)
        before = z
        z = _advance_bristle(z, velocity, (level - f_v * speed) * factor(contact) / sigma_0, dt)
        return sigma_0 * z + sigma_1 * (z - before) / dt + f_v * velocity

    return advance


def _advance_bristle(z: float, velocity: float, steady: float, dt: float) -> float:
    """Exact solution of z' = v - |v| z / z_ss over a step of constant velocity."""
    target = steady if velocity > 0.0 else -steady
    exponent = abs(velocity) * dt / steady
    return target + (z - target) * exp(-exponent) if exponent < NO_FALL else target


def _curve_numbers(curve: StribeckCurve) -> tuple[float, float, float, float, float]:
    fall = curve.static_torque - curve.coulomb_torque
    return curve.coulomb_torque, fall, curve.stribeck_velocity, curve.stribeck_exponent, curve.viscous_coefficient


def _load_factor(load: LoadScaling) -> Callable[[Contact], float]:
    sensitivity, reference = load.load_sensitivity, load.reference_load

    def factor(contact: Contact) -> float:
        normal = contact.normal_load
        return 1.0 if normal is None else 1.0 + sensitivity * (normal / reference - 1.0)

    return factor
