"""Terms that fit no curve as C expressions, the same as `fricomp.control.extra_terms` has them.

The expressions draw on `position`, `load_torque`, `acceleration`, `extra_speed`, `velocity`, `temperature`,
`input->has_temperature` and `state`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import singledispatch
from string import Template

from fricomp.control import CompensationSettings
from fricomp.control.extra_terms import TermKind
from fricomp.errors import ExportError
from fricomp.laws import (
    Cogging,
    DwellStiction,
    EndStop,
    KinematicError,
    LoadCoulomb,
    LoadQuadratic,
    LoadStribeck,
    PositionCoulomb,
    PowerLawViscous,
    QuadraticDrag,
    SpringTorque,
    Term,
    ThermalFriction,
    ThermalViscous,
)
from fricomp.laws.thermal_friction import STRONGEST_FALL

__all__ = ["EXTRA_CHECKS", "EXTRA_FIELDS", "c_expressions", "render_extra"]

Literal = Callable[[float], str]
Expression = tuple[TermKind, str]

EXTRA_FIELDS = """    $real position;           /* [$position_unit] */
    $real load_torque;        /* torque that the joint transmits to its load [$torque_unit] */
    $real temperature;        /* [degrees Celsius] */
    bool has_temperature;
    $real acceleration;       /* of the reference [$position_unit/s^2] */
"""

EXTRA_CHECKS = """    usable = usable && (isfinite(input->position) != 0) && (isfinite(input->load_torque) != 0);
    usable = usable && ((!input->has_temperature) || (isfinite(input->temperature) != 0));
    usable = usable && (isfinite(input->acceleration) != 0);
"""

_EXTRA = Template(
    """    {
        const $real position = input->position;
        const $real velocity = (drive > $high) ? $high : ((drive < $low) ? $low : drive);
        const $real fastest = (drive >= $zero) ? $high : $reverse_high;
        $real extra_speed = (blended > $zero) ? blended : $zero;
        $real load_torque = input->load_torque;
        $real temperature = input->has_temperature ? input->temperature : $zero;
        $real acceleration = input->acceleration;
        $real beside;
        extra_speed = (extra_speed > fastest) ? fastest : extra_speed;
$bounds        (void)position;
        (void)acceleration;
        (void)velocity;
        (void)load_torque;
        (void)temperature;
        (void)extra_speed;
$rests        beside = $dry;
        beside = (beside < -level) ? -level : beside; /* all of dry friction may vanish, but it never drives */
        torque += beside * tanh$f(direction / $smoothing);
        drag = $drag;
        held = $held;
    }
"""
)


@singledispatch
def c_expressions(term: Term, literal: Literal) -> tuple[Expression, ...]:
    """Kind and expression of each part of `term`.

    Raises:
        ExportError: The term has no closed form in C.
    """
    name = getattr(term, "name", type(term).__name__)
    raise ExportError(
        f"the term {name} has no closed form in C: a header holds one dry curve (Coulomb, Stribeck, Dahl or LuGre), "
        "viscous friction and drag, with their lag, and terms over load, position, temperature, acceleration and rests"
    )


@c_expressions.register
def _(term: Cogging, literal: Literal) -> tuple[Expression, ...]:
    return (("held", _wave(term, literal)),)


@c_expressions.register
def _(term: PositionCoulomb, literal: Literal) -> tuple[Expression, ...]:
    return (("dry", _wave(term, literal)),)


@c_expressions.register
def _(term: SpringTorque, literal: Literal) -> tuple[Expression, ...]:
    stretch = f"(position - {literal(term.centre)})"
    stiffer = f"({literal(1.0)} + {literal(term.hardening)} * {stretch} * {stretch})"
    return (("held", f"({literal(term.stiffness)} * {stretch} * {stiffer})"),)


@c_expressions.register
def _(term: EndStop, literal: Literal) -> tuple[Expression, ...]:
    past = f"(position {'>' if term.side > 0.0 else '<'} {literal(term.edge)})"
    return (("held", f"({past} ? ({literal(term.stiffness)} * (position - {literal(term.edge)})) : $zero)"),)


@c_expressions.register
def _(term: LoadCoulomb, literal: Literal) -> tuple[Expression, ...]:
    return (("dry", f"({literal(term.coefficient)} * fabs$f(load_torque))"),)


@c_expressions.register
def _(term: LoadQuadratic, literal: Literal) -> tuple[Expression, ...]:
    return (("dry", f"({literal(term.coefficient)} * load_torque * load_torque)"),)


@c_expressions.register
def _(term: LoadStribeck, literal: Literal) -> tuple[Expression, ...]:
    ratio = f"(extra_speed / {literal(term.stribeck_velocity)})"
    return (("dry", f"({literal(term.coefficient)} * fabs$f(load_torque) * exp$f(-({ratio} * {ratio})))"),)


@c_expressions.register
def _(term: QuadraticDrag, literal: Literal) -> tuple[Expression, ...]:
    return (("drag", f"({literal(term.coefficient)} * velocity * fabs$f(velocity))"),)


@c_expressions.register
def _(term: PowerLawViscous, literal: Literal) -> tuple[Expression, ...]:
    size = f"({literal(term.coefficient)} * pow$f(fabs$f(velocity), {literal(term.exponent)}))"
    return (("drag", f"((velocity >= $zero) ? {size} : -{size})"),)


@c_expressions.register
def _(term: ThermalViscous, literal: Literal) -> tuple[Expression, ...]:
    warmth = f"(temperature - {literal(term.reference_temperature)})"
    return (("drag", f"(input->has_temperature ? -({literal(term.slope)} * {warmth} * velocity) : $zero)"),)


@c_expressions.register
def _(term: ThermalFriction, literal: Literal) -> tuple[Expression, ...]:
    warmth = f"(temperature - {literal(term.reference_temperature)})"
    viscous = f"((velocity >= $zero) ? {literal(term.forward_viscous)} : {literal(term.reverse_viscous)})"
    fall = f"(({literal(term.viscous_slope)} * {warmth}) / {viscous})"
    bounded = f"fmax$f(fmin$f({fall}, {literal(STRONGEST_FALL)}), {literal(-STRONGEST_FALL)})"
    drag = f"({viscous} * expm1$f(-{bounded}) * velocity)"
    level = f"-({literal(term.coulomb_slope)} * {warmth})"
    return (
        ("drag", f"(input->has_temperature ? {drag} : $zero)"),
        ("dry", f"(input->has_temperature ? {level} : $zero)"),
    )


@c_expressions.register
def _(term: KinematicError, literal: Literal) -> tuple[Expression, ...]:
    sine, cosine, order, inertia = (literal(v) for v in (term.sine, term.cosine, term.order, term.load_inertia))
    along, across = literal(term.gravity_cosine), literal(term.gravity_sine)
    wave_sine, wave_cosine = (f"{function}$f({order} * position)" for function in ("sin", "cos"))
    error = f"(({sine} * {wave_sine}) + ({cosine} * {wave_cosine}))"
    slope = f"({order} * (({sine} * {wave_cosine}) - ({cosine} * {wave_sine})))"
    gravity = f"(({along} * cos$f(position)) + ({across} * sin$f(position)))"
    gradient = f"(({across} * cos$f(position)) - ({along} * sin$f(position)))"
    pushed = f"({slope} * ({gravity} + ({literal(2.0)} * {inertia} * acceleration)))"
    bent = f"({inertia} * {order} * {order} * {error} * velocity * velocity)"
    return (("held", f"({pushed} - {bent} + ({gradient} * {error}))"),)


@c_expressions.register
def _(term: DwellStiction, literal: Literal) -> tuple[Expression, ...]:
    return (("dry", f"({literal(term.rise)} * state->rested)"),)


def _wave(term: Cogging | PositionCoulomb, literal: Literal) -> str:
    angle = f"({literal(term.order)} * position)"
    return f"(({literal(term.sine)} * sin$f{angle}) + ({literal(term.cosine)} * cos$f{angle}))"


def render_extra(terms: Sequence[Term], settings: CompensationSettings, period: float, literal: Literal) -> str:
    """The block that adds `terms` to the torque; empty where there are none.

    Raises:
        ExportError: A term has no closed form in C.
    """
    if not terms:
        return ""
    found = [part for term in terms for part in c_expressions(term, literal)]
    rests = "".join(_rest(term, period, literal) for term in terms if isinstance(term, DwellStiction))
    sums = {kind: " + ".join(text for k, text in found if k == kind) or "$zero" for kind in ("dry", "drag", "held")}
    ranges = {
        "load_torque": settings.load_torque_range,
        "temperature": settings.temperature_range,
        "acceleration": settings.acceleration_range,
    }
    bounds = "".join(_bounds(name, limits, literal) for name, limits in ranges.items() if limits is not None)
    edges = {"low": literal(settings.velocity_range[0]), "high": literal(settings.velocity_range[1])}
    edges |= {"reverse_high": literal(-settings.velocity_range[0]), "smoothing": literal(settings.smoothing)}
    return _EXTRA.safe_substitute(sums, bounds=bounds, rests=rests, **edges)


def _bounds(name: str, limits: tuple[float, float], literal: Literal) -> str:
    """What holds the variable `name` to its range."""
    low, high = (literal(edge) for edge in limits)
    return f"        {name} = ({name} < {low}) ? {low} : (({name} > {high}) ? {high} : {name});\n"


def _rest(term: DwellStiction, period: float, literal: Literal) -> str:
    """What a period adds to, or takes from, the share of the rise that rests have brought."""
    growth, per_speed = literal(-math.expm1(-period / term.time_constant)), literal(period / term.travel)
    return f"""        if (fabs$f(velocity) < {literal(term.rest_speed)}) {{
            state->rested += {growth} * ($one - state->rested);
        }} else {{
            state->rested *= exp$f(-(fabs$f(velocity) * {per_speed}));
        }}
"""
