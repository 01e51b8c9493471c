"""Terms that fit no curve, in plain floats: what holds a position, what resists like dry friction, what drags.

A term of a law with a closed form belongs to one kind:

- `held`: fixed in the position, whatever the motion; f(position);
- `dry`: a level against the direction of motion; f(speed, position, load_torque);
- `drag`: rises from rest with the velocity; f(velocity, temperature).

Any other term is evaluated as it is, in both directions at the same speed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import singledispatch
from math import cos, exp, sin
from typing import Literal, NamedTuple

import numpy as np

from fricomp.control.settings import CompensationSettings
from fricomp.laws import (
    Cogging,
    EndStop,
    LoadCoulomb,
    LoadQuadratic,
    LoadStribeck,
    OperatingPoint,
    PositionCoulomb,
    PowerLawViscous,
    QuadraticDrag,
    SpringTorque,
    Term,
    ThermalViscous,
)

__all__ = [
    "LOAD_TERMS",
    "POSITION_TERMS",
    "TEMPERATURE_TERMS",
    "ExtraTorque",
    "PlainForm",
    "TermKind",
    "build_extra",
    "plain_form",
]

LOAD_TERMS = (LoadCoulomb, LoadQuadratic, LoadStribeck)
"""Terms over the torque that a joint transmits to its load."""

POSITION_TERMS = (Cogging, PositionCoulomb, SpringTorque, EndStop)
"""Terms over the position."""

TEMPERATURE_TERMS = (ThermalViscous,)
"""Terms over the temperature."""

TermKind = Literal["held", "dry", "drag"]


class PlainForm(NamedTuple):
    """A term in plain floats.

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
        held: Whatever the motion.
    """

    dry: float
    drag: float
    held: float


@singledispatch
def plain_form(term: Term) -> PlainForm | None:
    """The closed form of `term` in plain floats; None where it has none."""
    return None


@plain_form.register
def _(term: Cogging) -> PlainForm:
    wave = _wave(term)
    return PlainForm("held", wave)


@plain_form.register
def _(term: SpringTorque) -> PlainForm:
    stiffness, centre, hardening = term.stiffness, term.centre, term.hardening

    def torque(position: float) -> float:
        stretch = position - centre
        return stiffness * stretch * (1.0 + hardening * stretch * stretch)

    return PlainForm("held", torque)


@plain_form.register
def _(term: EndStop) -> PlainForm:
    stiffness, edge, side = term.stiffness, term.edge, term.side
    return PlainForm("held", lambda position: stiffness * side * max(side * (position - edge), 0.0))


@plain_form.register
def _(term: PositionCoulomb) -> PlainForm:
    wave = _wave(term)
    return PlainForm("dry", lambda speed, position, load_torque: wave(position))


@plain_form.register
def _(term: LoadCoulomb) -> PlainForm:
    return PlainForm("dry", lambda speed, position, load_torque: term.coefficient * abs(load_torque))


@plain_form.register
def _(term: LoadQuadratic) -> PlainForm:
    return PlainForm("dry", lambda speed, position, load_torque: term.coefficient * load_torque * load_torque)


@plain_form.register
def _(term: LoadStribeck) -> PlainForm:
    def level(speed: float, position: float, load_torque: float) -> float:
        ratio = speed / term.stribeck_velocity
        return term.coefficient * abs(load_torque) * exp(-ratio * ratio)

    return PlainForm("dry", level)


@plain_form.register
def _(term: QuadraticDrag) -> PlainForm:
    return PlainForm("drag", lambda velocity, temperature: term.coefficient * velocity * abs(velocity))


@plain_form.register
def _(term: PowerLawViscous) -> PlainForm:
    def drag(velocity: float, temperature: float | None) -> float:
        size: float = term.coefficient * abs(velocity) ** term.exponent
        return size if velocity >= 0.0 else -size

    return PlainForm("drag", drag)


@plain_form.register
def _(term: ThermalViscous) -> PlainForm:
    def drag(velocity: float, temperature: float | None) -> float:
        return 0.0 if temperature is None else -term.slope * (temperature - term.reference_temperature) * velocity

    return PlainForm("drag", drag)


def _wave(term: Cogging | PositionCoulomb) -> Callable[[float], float]:
    sine, cosine, order = term.sine, term.cosine, term.order
    return lambda position: sine * sin(order * position) + cosine * cos(order * position)


def build_extra(
    terms: Sequence[Term], settings: CompensationSettings
) -> Callable[[float, float, float, float, float | None], ExtraTorque]:
    """The sum of `terms` as a function of speed on the curve, velocity, position, load torque and temperature.

    The inputs are finite. Speed and velocity beyond the range of validity count as its ends, the load torque likewise.
    """
    forms = [plain_form(term) for term in terms]
    held, dry, drag = (
        [f.torque for f in forms if f is not None and f.kind == kind] for kind in ("held", "dry", "drag")
    )
    others = [term for term, form in zip(terms, forms, strict=True) if form is None]
    low, high = settings.velocity_range
    low_load, high_load = settings.load_torque_range or (-np.inf, np.inf)

    def extra(
        speed: float, velocity: float, position: float, load_torque: float, temperature: float | None
    ) -> ExtraTorque:
        speed = min(max(speed, 0.0), high if velocity >= 0.0 else -low)
        velocity = min(max(velocity, low), high)
        load_torque = min(max(load_torque, low_load), high_load)
        level = outright = 0.0
        if others:
            level, outright = _both_directions(others, speed, position, load_torque, temperature)
        for torque in dry:
            level += torque(speed, position, load_torque)
        for torque in held:
            outright += torque(position)
        return ExtraTorque(level, sum([torque(velocity, temperature) for torque in drag]), outright)

    return extra


def _both_directions(
    terms: Sequence[Term], speed: float, position: float, load_torque: float, temperature: float | None
) -> tuple[float, float]:
    """Half difference and mean of the torque in both directions, which are a level and a torque held."""
    point = OperatingPoint(
        np.array([speed, -speed]), position=position, load_torque=load_torque, temperature=temperature
    )
    ahead, back = sum((np.broadcast_to(np.asarray(term.torque(point)), 2) for term in terms), np.zeros(2)).tolist()
    return 0.5 * (ahead - back), 0.5 * (ahead + back)
