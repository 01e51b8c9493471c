"""A compensator as one C header: the same equation, smoothing and limits as in Python."""

import hashlib
import math
import re
from string import Template
from typing import Any

import numpy as np

import fricomp.export.c_template as template
from fricomp.control import CompensationSettings
from fricomp.control.compensation.bristle import FALLING_SHARE_WITHOUT_VELOCITY, deepest_bend
from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.curve import FrictionCurves
from fricomp.control.compensation.extra_terms import trace_extra
from fricomp.control.compensation.trust import require_usable, trusted_curves
from fricomp.errors import ExportError, ParameterError
from fricomp.export.c_source import C
from fricomp.export.c_terms import EXTRA_CHECKS, EXTRA_FIELDS, render_extra
from fricomp.laws.bristle import advance_bristle, bristle_torque
from fricomp.laws.expression import Expression, Symbol
from fricomp.laws.lagged import follow_velocity
from fricomp.laws.stribeck import compute_dry_level, compute_falling_share
from fricomp.model import FrictionModel, encode_model

_LONGEST_PERIOD = 10.0
"""Control periods end here [s], as in `Compensator`."""


def render_c_header(
    model: FrictionModel,
    settings: CompensationSettings | None = None,
    *,
    period: float = 1e-3,
    prefix: str | None = None,
    version: str = "",
    any_status: bool = False,
) -> str:
    """The header for `model`, in double and in single precision.

    Args:
        model: What is compensated.
        settings: How; those that fit the model if None.
        period: Control period, which limits of rate and the bristle need [s].
        prefix: Of every name in the header; made from the joint's name if None.
        version: Of fricomp, for the comment on top.
        any_status: Take a model too that its identification calls unusable.

    Raises:
        ExportError: The prefix is no C name.
        ParameterError: The model is not usable, or the period is outside the range that `Compensator` takes.
    """
    if not any_status:
        require_usable(model)
    if not 0.0 < period < _LONGEST_PERIOD:
        raise ParameterError(f"the period must be positive and below {_LONGEST_PERIOD:g} s, got {period!r}")
    curves = trusted_curves(model)
    chosen = settings or choose_settings(model)
    name = prefix if prefix is not None else "friction_" + re.sub(r"\W+", "_", model.joint.lower()).strip("_")
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
        raise ExportError(f"prefix {name!r} is not a C name: letters, digits and underscores, no digit first")
    functions = "\n".join(
        _functions(curves, chosen, (model.position_unit, _comment(model.torque_unit), name), period, C(is_float))
        for is_float in (False, True)
    )
    return template.HEADER.substitute(
        joint=_comment(model.joint),
        version=version,
        digest=hashlib.sha256(encode_model(model)).hexdigest(),
        torque_unit=_comment(model.torque_unit),
        position_unit=model.position_unit,
        prefix=name,
        guard=f"{name.upper()}_H",
        content=f"{name.upper()}_{hashlib.sha256(functions.encode()).hexdigest()[:16].upper()}",
        period=f"{period:g}",
        functions=functions,
    )


def _comment(text: str) -> str:
    """`text` for a comment or a message: nothing in it ends a line or a comment, splices lines, or is a trigraph."""
    shown = re.sub(r"[^ !#-)+-\[\]-~*]", "_", text.replace("·", "*"))
    return shown.replace("*/", "* /").replace("/*", "/ *").replace("??", "__")


def _functions(
    curves: FrictionCurves, settings: CompensationSettings, names: tuple[str, str, str], period: float, c: C
) -> str:
    position_unit, torque_unit, prefix = names
    constants = {"real": c.real, "f": c.suffix, "prefix": prefix}
    constants |= {name: c.literal(value) for name, value in _numbers(curves, settings).items()}
    extra, is_late = trace_extra(curves.extra, period) if curves.extra else None, curves.lag > 0.0
    constants |= {"speed": "blended", "dragged": "drive"}
    if is_late:
        constants |= {"speed": f"fabs{c.suffix}(state->felt)", "dragged": "state->dragged"}
        constants["follow"] = _follow(period / curves.lag, c)
    constants["factor_of_load"] = c.assign({"factor": curves.load.factor(Symbol("normal_load"))})
    memories = ["felt", "dragged"] if is_late else []
    memories += [name for step in (extra.steps if extra else ()) for name in step.states]

    def filled(text: str) -> str:
        return Template(text).substitute(constants, position_unit=position_unit, torque_unit=torque_unit)

    dry = _static(curves, settings, c) if curves.bristle is None else _bristle(curves, period, c)
    return template.FUNCTIONS.substitute(
        constants,
        position_unit=position_unit,
        extra_fields=filled(EXTRA_FIELDS) if extra else "",
        extra_checks=EXTRA_CHECKS if extra else "",
        extra_variables=filled(template.EXTRA_VARIABLES) if extra else "",
        extra=render_extra(extra, settings, c) if extra else "",
        lagging=filled(template.LAG) if is_late else "",
        turning=filled(template.TURNING) if is_late else "",
        memories=filled("".join(f"    $real {name};\n" for name in memories)),
        forgotten=filled("".join(f"    state->{name} = $zero;\n" for name in memories)),
        dragging=filled("((viscous * $dragged) + drag)" if extra else "viscous * $dragged"),
        holding=filled(template.HOLDING) if extra else "",
        load_bounds=_load_bounds(settings, c),
        drive_from_measurement=_measured(settings, c),
        dry=Template(dry.safe_substitute(constants)).substitute(constants),
        rate_limit=_rate_limit(settings, period, c),
    )


def _numbers(curves: FrictionCurves, settings: CompensationSettings) -> dict[str, float]:
    """The numbers of the templates, by name."""
    low, high = settings.velocity_range
    values = {
        "zero": 0.0,
        "one": 1.0,
        "keep": 1.0 - settings.measured_share,
        "share": settings.measured_share,
        "error_band": settings.error_band,
        "error_rate": settings.error_rate,
        "gain": settings.gain,
        "fade_width": settings.fade_width,
        "authority": settings.authority,
        "smoothing": settings.smoothing,
        "mean_viscous": 0.5 * (curves.forward.viscous + curves.reverse.viscous),
        "half_viscous": 0.5 * (curves.forward.viscous - curves.reverse.viscous),
        "forward_edge": high,
        "reverse_edge": low,
    }
    for side, curve in (("forward", curves.forward), ("reverse", curves.reverse)):
        values |= {f"{side}_coulomb": curve.coulomb, f"{side}_rise": curve.rise}
        values |= {f"{side}_stribeck_velocity": curve.stribeck_velocity, f"{side}_viscous": curve.viscous}
    return values


def _load_bounds(settings: CompensationSettings, c: C) -> str:
    if settings.normal_load_range is None:
        return ""
    low, high = (c.literal(edge) for edge in settings.normal_load_range)
    return f"        normal_load = (normal_load < {low}) ? {low} : ((normal_load > {high}) ? {high} : normal_load);\n"


def _measured(settings: CompensationSettings, c: C) -> str:
    if settings.source != "measured":
        return ""
    band, zero = c.literal(settings.dead_band), c.literal(0.0)
    return (
        f"        drive = (input->velocity > {band}) ? (input->velocity - {band})\n"
        f"              : ((input->velocity < -{band}) ? (input->velocity + {band}) : {zero});\n"
    )


def _follow(steps: float, c: C) -> str:
    """The low pass of both velocities of a lag."""
    now = {"felt": "seen", "dragged": "driven"}
    formulas = {f"state->{name}": follow_velocity(Symbol(name), Symbol(now[name]), steps) for name in now}
    return c.assign(formulas, {name: f"state->{name}" for name in now})


def _symbols(*names: str) -> list[Any]:
    return [Symbol(name) for name in names]


def _falling(curves: FrictionCurves, chosen_by: str, c: C) -> tuple[Expression, dict[str, str]]:
    """The share of the rise that is left in the direction of the sign of `chosen_by`, and the text of its symbol."""
    speed, stribeck_velocity = _symbols("speed", "stribeck_velocity")
    exponents = [curve.exponent for curve in (curves.forward, curves.reverse)]
    exponent: Any = exponents[0]
    if exponents[0] != exponents[1]:
        exponent = np.where(Symbol("is_forward"), *exponents)  # type: ignore[call-overload]
    return compute_falling_share(speed, stribeck_velocity, exponent), {
        "is_forward": f"({chosen_by} >= {c.literal(0.0)})"
    }


def _static(curves: FrictionCurves, settings: CompensationSettings, c: C) -> Template:
    share_at_rest, width = "$zero", c.literal(settings.rest_velocity)
    if settings.rest_velocity > 0.0:
        size = "fabs$f(input->velocity)"
        share_at_rest = f"({size} < {width}) ? ($one - ({size} / {width})) : $zero"
    falling, names = _falling(curves, "direction", c)
    level = compute_dry_level(*_symbols("coulomb", "rise", "falling"))
    return Template(
        template.STATIC.safe_substitute(
            falling=c.assign({"falling": falling}, names, " " * 12),
            level=c.assign({"level": Symbol("factor") * level}, {"factor": "${prefix}_factor${f}(input)"}),
            share_at_rest=share_at_rest,
            unseen=c.literal(FALLING_SHARE_WITHOUT_VELOCITY if settings.source == "blend" else 1.0),
        )
    )


def _bristle(curves: FrictionCurves, period: float, c: C) -> Template:
    bristle = curves.bristle
    assert bristle is not None
    falling, names = _falling(curves, "drive", c)
    coulomb, rise = _symbols("coulomb", "rise")
    level = compute_dry_level(coulomb, rise, falling)
    before, after = Symbol("bristle"), Symbol("after")
    bent = advance_bristle(before, Symbol("drive"), Symbol("steady"), period)
    torque = bristle_torque(bristle.sigma_0, bristle.sigma_1, before, after, period)
    names |= {"factor": "${prefix}_factor${f}(input)", "bristle": "state->bristle"}
    return Template(
        template.BRISTLE.safe_substitute(
            level=c.assign({"level": Symbol("factor") * level}, names),
            sigma_0=c.literal(bristle.sigma_0),
            deepest=c.literal(deepest_bend(curves)),
            bend=c.assign({f"const {c.real} after": bent}, names, " " * 12)
            + c.assign({"torque": torque}, names, " " * 12),
        )
    )


def _rate_limit(settings: CompensationSettings, period: float, c: C) -> str:
    if math.isinf(settings.torque_rate):
        return "    (void)change; /* the rate is not limited */\n"
    return template.RATE.substitute(step=c.literal(settings.torque_rate * period))
