"""Terms over load, position and temperature as C expressions, the same as `fricomp.control.extra_terms` has them.

The expressions draw on `position`, `load_torque`, `extra_speed`, `velocity` and `input->temperature`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import singledispatch
from string import Template

from fricomp.control import CompensationSettings
from fricomp.control.extra_terms import TermKind
from fricomp.errors import ExportError
from fricomp.laws import (
    Cogging,
    EndStop,
    LoadCoulomb,
    LoadQuadratic,
    LoadStribeck,
    PositionCoulomb,
    PowerLawViscous,
    QuadraticDrag,
    SpringTorque,
    Term,
    ThermalViscous,
)

__all__ = ["EXTRA_CHECKS", "EXTRA_FIELDS", "c_expression", "render_extra"]

Literal = Callable[[float], str]

EXTRA_FIELDS = """    $real position;           /* [$position_unit] */
    $real load_torque;        /* torque that the joint transmits to its load [$torque_unit] */
    $real temperature;        /* [degrees Celsius] */
    bool has_temperature;
"""

EXTRA_CHECKS = """    usable = usable && (isfinite(input->position) != 0) && (isfinite(input->load_torque) != 0);
    usable = usable && ((!input->has_temperature) || (isfinite(input->temperature) != 0));
"""

_EXTRA = Template(
    """    {
        const $real position = input->position;
        const $real velocity = (drive > $high) ? $high : ((drive < $low) ? $low : drive);
        const $real fastest = (drive >= $zero) ? $high : $reverse_high;
        $real extra_speed = (blended > $zero) ? blended : $zero;
        $real load_torque = input->load_torque;
        extra_speed = (extra_speed > fastest) ? fastest : extra_speed;
$load_bounds        (void)position;
        (void)velocity;
        (void)load_torque;
        (void)extra_speed;
        torque += ($dry) * tanh$f(direction / $smoothing);
        drag = $drag;
        held = $held;
    }
"""
)


@singledispatch
def c_expression(term: Term, literal: Literal) -> tuple[TermKind, str]:
    """Kind of `term` and its expression.

    Raises:
        ExportError: The term has no closed form in C.
    """
    name = getattr(term, "name", type(term).__name__)
    raise ExportError(
        f"the term {name} has no closed form in C: a header holds one dry curve (Coulomb, Stribeck, Dahl or LuGre), "
        "viscous friction and drag, and terms over load, position and temperature"
    )


@c_expression.register
def _(term: Cogging, literal: Literal) -> tuple[TermKind, str]:
    return "held", _wave(term, literal)


@c_expression.register
def _(term: PositionCoulomb, literal: Literal) -> tuple[TermKind, str]:
    return "dry", _wave(term, literal)


@c_expression.register
def _(term: SpringTorque, literal: Literal) -> tuple[TermKind, str]:
    stretch = f"(position - {literal(term.centre)})"
    stiffer = f"({literal(1.0)} + {literal(term.hardening)} * {stretch} * {stretch})"
    return "held", f"({literal(term.stiffness)} * {stretch} * {stiffer})"


@c_expression.register
def _(term: EndStop, literal: Literal) -> tuple[TermKind, str]:
    past = f"(position {'>' if term.side > 0.0 else '<'} {literal(term.edge)})"
    return "held", f"({past} ? ({literal(term.stiffness)} * (position - {literal(term.edge)})) : $zero)"


@c_expression.register
def _(term: LoadCoulomb, literal: Literal) -> tuple[TermKind, str]:
    return "dry", f"({literal(term.coefficient)} * fabs$f(load_torque))"


@c_expression.register
def _(term: LoadQuadratic, literal: Literal) -> tuple[TermKind, str]:
    return "dry", f"({literal(term.coefficient)} * load_torque * load_torque)"


@c_expression.register
def _(term: LoadStribeck, literal: Literal) -> tuple[TermKind, str]:
    ratio = f"(extra_speed / {literal(term.stribeck_velocity)})"
    return "dry", f"({literal(term.coefficient)} * fabs$f(load_torque) * exp$f(-({ratio} * {ratio})))"


@c_expression.register
def _(term: QuadraticDrag, literal: Literal) -> tuple[TermKind, str]:
    return "drag", f"({literal(term.coefficient)} * velocity * fabs$f(velocity))"


@c_expression.register
def _(term: PowerLawViscous, literal: Literal) -> tuple[TermKind, str]:
    size = f"({literal(term.coefficient)} * pow$f(fabs$f(velocity), {literal(term.exponent)}))"
    return "drag", f"((velocity >= $zero) ? {size} : -{size})"


@c_expression.register
def _(term: ThermalViscous, literal: Literal) -> tuple[TermKind, str]:
    warmth = f"(input->temperature - {literal(term.reference_temperature)})"
    return "drag", f"(input->has_temperature ? -({literal(term.slope)} * {warmth} * velocity) : $zero)"


def _wave(term: Cogging | PositionCoulomb, literal: Literal) -> str:
    angle = f"({literal(term.order)} * position)"
    return f"(({literal(term.sine)} * sin$f{angle}) + ({literal(term.cosine)} * cos$f{angle}))"


def render_extra(terms: Sequence[Term], settings: CompensationSettings, literal: Literal) -> str:
    """The block that adds `terms` to the torque; empty where there are none.

    Raises:
        ExportError: A term has no closed form in C.
    """
    if not terms:
        return ""
    found = [c_expression(term, literal) for term in terms]
    sums = {kind: " + ".join(text for k, text in found if k == kind) or "$zero" for kind in ("dry", "drag", "held")}
    bounds = ""
    if settings.load_torque_range is not None:
        low, high = (literal(edge) for edge in settings.load_torque_range)
        bounds = (
            f"        load_torque = (load_torque < {low}) ? {low} : ((load_torque > {high}) ? {high} : load_torque);\n"
        )
    edges = {"low": literal(settings.velocity_range[0]), "high": literal(settings.velocity_range[1])}
    edges |= {"reverse_high": literal(-settings.velocity_range[0]), "smoothing": literal(settings.smoothing)}
    return _EXTRA.safe_substitute(sums, load_bounds=bounds, **edges)
