"""A compensator as one C header: the same equation, smoothing and limits as in Python."""

from __future__ import annotations

import hashlib
import math
import re
import sys
from collections.abc import Callable
from string import Template

import numpy as np

import fricomp.export.c_template as template
from fricomp.control import CompensationSettings
from fricomp.control.bristle import FALLING_SHARE_WITHOUT_VELOCITY, deepest_bend
from fricomp.control.choice import choose_settings
from fricomp.control.curve import FrictionCurves
from fricomp.control.trust import require_usable, trusted_curves
from fricomp.errors import ExportError, ParameterError
from fricomp.export.c_terms import EXTRA_CHECKS, EXTRA_FIELDS, render_extra
from fricomp.laws import DwellStiction
from fricomp.model import FrictionModel, encode_model

__all__ = ["render_c_header"]

Literal = Callable[[float], str]

_LONGEST_PERIOD = 10.0
"""Control periods end here [s], as in `Compensator`."""
_LARGEST_FLOAT, _LARGEST_DOUBLE = float(np.finfo(np.float32).max), sys.float_info.max


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
        ExportError: The prefix is no C name, or the law has a term without a closed form in C.
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
        _functions(curves, chosen, (model.position_unit, _comment(model.torque_unit), name), period, is_float)
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
    curves: FrictionCurves, settings: CompensationSettings, names: tuple[str, str, str], period: float, is_float: bool
) -> str:
    def literal(value: float) -> str:
        if abs(value) > (_LARGEST_FLOAT if is_float else _LARGEST_DOUBLE):
            size = "INFINITY" if is_float else "(double)INFINITY"
            return size if value > 0.0 else f"-{size}"
        text = repr(float(value))
        text = text if "e" in text or "." in text else f"{text}.0"
        return f"{text}F" if is_float else text

    position_unit, torque_unit, prefix = names
    suffix = "f" if is_float else ""
    constants = {"real": "float" if is_float else "double", "f": suffix, "prefix": prefix}
    constants |= {name: literal(value) for name, value in _numbers(curves, settings).items()}
    dry = _static(curves, settings, literal) if curves.bristle is None else _bristle(curves, period, literal)
    has_extra, is_late = bool(curves.extra), curves.lag > 0.0
    constants |= {"speed": "blended", "dragged": "drive"}
    if is_late:
        constants |= {"speed": f"fabs{suffix}(state->felt)", "dragged": "state->dragged"}
        constants["lasting"] = literal(math.exp(-period / curves.lag))
    memories = ["felt", "dragged"] if is_late else []
    memories += ["rested" for term in curves.extra if isinstance(term, DwellStiction)]

    def filled(text: str) -> str:
        return Template(text).substitute(constants, position_unit=position_unit, torque_unit=torque_unit)

    return template.FUNCTIONS.substitute(
        constants,
        position_unit=position_unit,
        extra_fields=filled(EXTRA_FIELDS) if has_extra else "",
        extra_checks=EXTRA_CHECKS if has_extra else "",
        extra_variables=filled(template.EXTRA_VARIABLES) if has_extra else "",
        extra=filled(render_extra(curves.extra, settings, period, literal)),
        lagging=filled(template.LAG) if is_late else "",
        turning=filled(template.TURNING) if is_late else "",
        memories=filled("".join(f"    $real {name};\n" for name in memories)),
        forgotten=filled("".join(f"    state->{name} = $zero;\n" for name in memories)),
        dragging=filled("((viscous * $dragged) + drag)" if has_extra else "viscous * $dragged"),
        holding=filled(template.HOLDING) if has_extra else "",
        load_bounds=_load_bounds(settings, literal),
        drive_from_measurement=_measured(settings, literal),
        dry=Template(dry.safe_substitute(constants)).substitute(constants),
        rate_limit=_rate_limit(settings, period, literal),
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
        "load_sensitivity": curves.load.load_sensitivity,
        "reference_load": curves.load.reference_load,
        "forward_edge": high,
        "reverse_edge": low,
    }
    for side, curve in (("forward", curves.forward), ("reverse", curves.reverse)):
        values |= {f"{side}_coulomb": curve.coulomb, f"{side}_rise": curve.rise}
        values |= {f"{side}_stribeck_velocity": curve.stribeck_velocity, f"{side}_viscous": curve.viscous}
    return values


def _load_bounds(settings: CompensationSettings, literal: Literal) -> str:
    if settings.normal_load_range is None:
        return ""
    low, high = (literal(edge) for edge in settings.normal_load_range)
    return f"        normal_load = (normal_load < {low}) ? {low} : ((normal_load > {high}) ? {high} : normal_load);\n"


def _measured(settings: CompensationSettings, literal: Literal) -> str:
    if settings.source != "measured":
        return ""
    band, zero = literal(settings.dead_band), literal(0.0)
    return (
        f"        drive = (input->velocity > {band}) ? (input->velocity - {band})\n"
        f"              : ((input->velocity < -{band}) ? (input->velocity + {band}) : {zero});\n"
    )


def _falling(curves: FrictionCurves, literal: Literal, chosen_by: str) -> str:
    """The exponential of the curve of the sign of `chosen_by` as C; the usual exponent 2 needs no power."""
    ratio = "(speed / stribeck_velocity)"
    forward, reverse = curves.forward.exponent, curves.reverse.exponent
    if forward == reverse == 2.0:
        return f"exp$f(-({ratio} * {ratio}))"
    return f"exp$f(-pow$f({ratio}, ({chosen_by} >= $zero) ? {literal(forward)} : {literal(reverse)}))"


def _static(curves: FrictionCurves, settings: CompensationSettings, literal: Literal) -> Template:
    share_at_rest, width = "$zero", literal(settings.rest_velocity)
    if settings.rest_velocity > 0.0:
        size = "fabs$f(input->velocity)"
        share_at_rest = f"({size} < {width}) ? ($one - ({size} / {width})) : $zero"
    return Template(
        template.STATIC.safe_substitute(
            falling=_falling(curves, literal, "direction"),
            share_at_rest=share_at_rest,
            unseen=literal(FALLING_SHARE_WITHOUT_VELOCITY if settings.source == "blend" else 1.0),
        )
    )


def _bristle(curves: FrictionCurves, period: float, literal: Literal) -> Template:
    assert curves.bristle is not None
    return Template(
        template.BRISTLE.safe_substitute(
            falling=_falling(curves, literal, "drive"),
            sigma_0=literal(curves.bristle.sigma_0),
            deepest=literal(deepest_bend(curves)),
            sigma_1_per_period=literal(curves.bristle.sigma_1 / period),
            period=literal(period),
        )
    )


def _rate_limit(settings: CompensationSettings, period: float, literal: Literal) -> str:
    if math.isinf(settings.torque_rate):
        return "    (void)change; /* the rate is not limited */\n"
    return template.RATE.substitute(step=literal(settings.torque_rate * period))
