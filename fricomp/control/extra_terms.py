"""Terms that fit no curve, in plain floats: what holds a position, what resists like dry friction, what drags.

A term of a law with a closed form is of one kind:

- `held`: whatever the direction of motion; f(position, velocity, acceleration);
- `dry`: a level against the direction of motion; f(speed, position, load_torque, temperature);
- `drag`: rises from rest with the velocity; f(velocity, temperature);

or has parts of several kinds. What rests have brought is a level that follows the velocity over time. Any other term
is evaluated as it is, in both directions at the same speed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import singledispatch
from math import cos, exp, expm1, sin
from typing import Literal, NamedTuple

import numpy as np

from fricomp.control.settings import CompensationSettings
from fricomp.laws import (
    Cogging,
    DwellStiction,
    EndStop,
    KinematicError,
    LoadCoulomb,
    LoadQuadratic,
    LoadStribeck,
    OperatingPoint,
    PositionCoulomb,
    PowerLawViscous,
    QuadraticDrag,
    SpringTorque,
    Term,
    ThermalFriction,
    ThermalViscous,
)
from fricomp.laws.thermal_friction import STRONGEST_FALL

__all__ = [
    "INPUT_TERMS",
    "LOAD_TERMS",
    "ExtraTorque",
    "PlainForm",
    "TermKind",
    "build_extra",
    "plain_forms",
]

LOAD_TERMS = (LoadCoulomb, LoadQuadratic, LoadStribeck)
"""Terms over the torque that a joint transmits to its load."""

INPUT_TERMS: Mapping[str, tuple[type[Term], ...]] = {
    "position": (Cogging, PositionCoulomb, SpringTorque, EndStop, KinematicError),
    "load_torque": LOAD_TERMS,
    "temperature": (ThermalViscous, ThermalFriction),
    "acceleration": (KinematicError,),
}
"""Terms over each input besides velocity and normal load."""

_ANY = (-np.inf, np.inf)

TermKind = Literal["held", "dry", "drag"]


class PlainForm(NamedTuple):
    """A term, or a part of one, in plain floats.

    Attributes:
        kind: Which of the three signatures `torque` has.
        torque: The torque, or the level of a `dry` term [N·m] or [N].
    """

    kind: TermKind
    torque: Callable[..., float]


class ExtraTorque(NamedTuple):
    """What the terms that fit no curve add up to [N·m] or [N].

    Attributes:
        dry: Level against the direction of motion.
        drag: Along the velocity.
        held: Whatever the direction of motion.
    """

    dry: float
    drag: float
    held: float


@singledispatch
def plain_forms(term: Term) -> tuple[PlainForm, ...]:
    """The closed form of `term` in plain floats; empty where it has none."""
    return ()


@plain_forms.register
def _(term: Cogging) -> tuple[PlainForm, ...]:
    wave = _wave(term)
    return (PlainForm("held", lambda position, velocity, acceleration: wave(position)),)


@plain_forms.register
def _(term: SpringTorque) -> tuple[PlainForm, ...]:
    stiffness, centre, hardening = term.stiffness, term.centre, term.hardening

    def torque(position: float, velocity: float, acceleration: float) -> float:
        stretch = position - centre
        return stiffness * stretch * (1.0 + hardening * stretch * stretch)

    return (PlainForm("held", torque),)


@plain_forms.register
def _(term: EndStop) -> tuple[PlainForm, ...]:
    stiffness, edge, side = term.stiffness, term.edge, term.side

    def torque(position: float, velocity: float, acceleration: float) -> float:
        return stiffness * side * max(side * (position - edge), 0.0)

    return (PlainForm("held", torque),)


@plain_forms.register
def _(term: PositionCoulomb) -> tuple[PlainForm, ...]:
    wave = _wave(term)
    return (PlainForm("dry", lambda speed, position, load_torque, temperature: wave(position)),)


@plain_forms.register
def _(term: LoadCoulomb) -> tuple[PlainForm, ...]:
    return (PlainForm("dry", lambda speed, position, load_torque, temperature: term.coefficient * abs(load_torque)),)


@plain_forms.register
def _(term: LoadQuadratic) -> tuple[PlainForm, ...]:
    return (
        PlainForm(
            "dry", lambda speed, position, load_torque, temperature: term.coefficient * load_torque * load_torque
        ),
    )


@plain_forms.register
def _(term: LoadStribeck) -> tuple[PlainForm, ...]:
    def level(speed: float, position: float, load_torque: float, temperature: float | None) -> float:
        ratio = speed / term.stribeck_velocity
        return term.coefficient * abs(load_torque) * exp(-ratio * ratio)

    return (PlainForm("dry", level),)


@plain_forms.register
def _(term: QuadraticDrag) -> tuple[PlainForm, ...]:
    return (PlainForm("drag", lambda velocity, temperature: term.coefficient * velocity * abs(velocity)),)


@plain_forms.register
def _(term: PowerLawViscous) -> tuple[PlainForm, ...]:
    def drag(velocity: float, temperature: float | None) -> float:
        size: float = term.coefficient * abs(velocity) ** term.exponent
        return size if velocity >= 0.0 else -size

    return (PlainForm("drag", drag),)


@plain_forms.register
def _(term: ThermalViscous) -> tuple[PlainForm, ...]:
    def drag(velocity: float, temperature: float | None) -> float:
        return 0.0 if temperature is None else -term.slope * (temperature - term.reference_temperature) * velocity

    return (PlainForm("drag", drag),)


@plain_forms.register
def _(term: ThermalFriction) -> tuple[PlainForm, ...]:
    slope, reference, coulomb_slope = term.viscous_slope, term.reference_temperature, term.coulomb_slope
    forward, reverse = term.forward_viscous, term.reverse_viscous

    def drag(velocity: float, temperature: float | None) -> float:
        if temperature is None:
            return 0.0
        viscous = forward if velocity >= 0.0 else reverse
        fall = min(max(slope * (temperature - reference) / viscous, -STRONGEST_FALL), STRONGEST_FALL)
        return viscous * expm1(-fall) * velocity

    def level(speed: float, position: float, load_torque: float, temperature: float | None) -> float:
        return 0.0 if temperature is None else -coulomb_slope * (temperature - reference)

    return PlainForm("drag", drag), PlainForm("dry", level)


@plain_forms.register
def _(term: KinematicError) -> tuple[PlainForm, ...]:
    sine, cosine, order, inertia = term.sine, term.cosine, term.order, term.load_inertia
    gravity_cosine, gravity_sine = term.gravity_cosine, term.gravity_sine

    def torque(position: float, velocity: float, acceleration: float) -> float:
        wave_cosine, wave_sine = cos(order * position), sin(order * position)
        error = sine * wave_sine + cosine * wave_cosine
        slope = order * (sine * wave_cosine - cosine * wave_sine)
        along, across = cos(position), sin(position)
        pushed = slope * (gravity_cosine * along + gravity_sine * across + 2.0 * inertia * acceleration)
        bent = inertia * order * order * error * velocity * velocity
        return pushed - bent + (gravity_sine * along - gravity_cosine * across) * error

    return (PlainForm("held", torque),)


def _wave(term: Cogging | PositionCoulomb) -> Callable[[float], float]:
    sine, cosine, order = term.sine, term.cosine, term.order
    return lambda position: sine * sin(order * position) + cosine * cos(order * position)


def build_extra(
    terms: Sequence[Term], settings: CompensationSettings, period: float
) -> tuple[Callable[[float, float, float, float, float | None, float], ExtraTorque], Callable[[], None]]:
    """The sum of `terms` as a function of speed on the curve, velocity, position, load torque, temperature and
    acceleration, called once a period [s]; and what sets it back to rest.

    The inputs are finite. Beyond the ranges of `settings` speed, velocity, load torque, temperature and acceleration
    count as their ends.
    """
    forms = [form for term in terms for form in plain_forms(term)]
    held, dry, drag = ([form.torque for form in forms if form.kind == kind] for kind in ("held", "dry", "drag"))
    rests = [_build_rest(term, period) for term in terms if isinstance(term, DwellStiction)]
    others = [term for term in terms if not plain_forms(term) and not isinstance(term, DwellStiction)]
    low, high = settings.velocity_range
    low_load, high_load = settings.load_torque_range or _ANY
    coldest, hottest = settings.temperature_range or _ANY
    low_acceleration, high_acceleration = settings.acceleration_range or _ANY

    def extra(
        speed: float,
        velocity: float,
        position: float,
        load_torque: float,
        temperature: float | None,
        acceleration: float,
    ) -> ExtraTorque:
        speed = min(max(speed, 0.0), high if velocity >= 0.0 else -low)
        velocity = min(max(velocity, low), high)
        load_torque = min(max(load_torque, low_load), high_load)
        if not low_acceleration <= acceleration <= high_acceleration:
            acceleration = low_acceleration if acceleration < low_acceleration else high_acceleration
        if temperature is not None and not coldest <= temperature <= hottest:
            temperature = coldest if temperature < coldest else hottest
        level = outright = 0.0
        if others:
            level, outright = _both_directions(others, speed, position, load_torque, temperature, acceleration)
        for torque in dry:
            level += torque(speed, position, load_torque, temperature)
        for rest, _ in rests:
            level += rest(velocity)
        for torque in held:
            outright += torque(position, velocity, acceleration)
        return ExtraTorque(level, sum([torque(velocity, temperature) for torque in drag]), outright)

    def reset() -> None:
        for _, forget in rests:
            forget()

    return extra, reset


def _build_rest(term: DwellStiction, period: float) -> tuple[Callable[[float], float], Callable[[], None]]:
    """What rests add to the level, after another period at a velocity; advanced as by `DwellStiction.advance`."""
    rise, rest_speed, per_speed = term.rise, term.rest_speed, period / term.travel
    growth, share = -expm1(-period / term.time_constant), 0.0

    def rest(velocity: float) -> float:
        nonlocal share
        speed = abs(velocity)
        share = share + growth * (1.0 - share) if speed < rest_speed else share * exp(-speed * per_speed)
        return rise * share

    def reset() -> None:
        nonlocal share
        share = 0.0

    return rest, reset


def _both_directions(
    terms: Sequence[Term],
    speed: float,
    position: float,
    load_torque: float,
    temperature: float | None,
    acceleration: float,
) -> tuple[float, float]:
    """Half difference and mean of the torque in both directions, which are a level and a torque held."""
    speeds = np.array([speed, -speed])
    point = OperatingPoint(speeds, position, acceleration, load_torque, temperature=temperature)
    ahead, back = sum((np.broadcast_to(np.asarray(term.torque(point)), 2) for term in terms), np.zeros(2)).tolist()
    return 0.5 * (ahead - back), 0.5 * (ahead + back)
