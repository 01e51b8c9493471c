"""The text of a joint's compensation in Python: the equation of `CompensationSettings`, written out for one model.

A line is there only where the model and its settings need it. Numbers are written into the text; the formulas of the
friction come from the terms.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf, isinf
from typing import Any

from fricomp.control.compensation.bristle import FALLING_SHARE_WITHOUT_VELOCITY, deepest_bend
from fricomp.control.compensation.curve import CurveParameters, FrictionCurves
from fricomp.control.compensation.extra_terms import TURNS_FORWARD, ExtraFormulas, clip_lines, find_bounds, trace_extra
from fricomp.control.settings import CompensationSettings
from fricomp.laws import INPUTS, find_inputs
from fricomp.laws.bristle import advance_bristle, bristle_torque
from fricomp.laws.expression import Expression, Symbol
from fricomp.laws.lagged import follow_velocity
from fricomp.laws.source import print_python, print_python_number
from fricomp.laws.stribeck import compute_dry_level

_ARGUMENTS = ("velocity", "position_error", "normal_load", *INPUTS)
_n = print_python_number


@dataclass(frozen=True)
class _Case:
    """A model and its settings, and what the lines depend on."""

    curves: FrictionCurves
    settings: CompensationSettings
    period: float
    extra: ExtraFormulas | None
    inputs: frozenset[str]

    @property
    def direction(self) -> str:
        """The variable whose sign is the direction."""
        return "direction" if self.settings.error_rate else "drive"

    @property
    def dragged(self) -> str:
        """The variable that viscous friction follows."""
        return "dragged" if self.curves.lag > 0.0 else "drive"

    @property
    def factor(self) -> str:
        """What the load multiplies dry friction with."""
        return "factor * " if self.curves.load.load_sensitivity else ""

    @property
    def is_on_reference(self) -> bool:
        """Whether the speed on the curve is that of `drive` in the direction of motion."""
        return not (self.settings.measured_share or self.settings.error_rate or self.curves.lag)

    @property
    def states(self) -> list[str]:
        """Variables that last from one period to the next."""
        names = ["deflection"] if self.curves.bristle is not None else []
        names += ["felt", "dragged"] if self.curves.lag > 0.0 else []
        return names + [name for step in (self.extra.steps if self.extra else ()) for name in step.states]


def write_hot_path(curves: FrictionCurves, settings: CompensationSettings, period: float) -> list[str]:
    """Lines of a function `build`, which gives those of `HotPath` in their order.

    Args:
        curves: The law, taken apart.
        settings: How it is compensated.
        period: Control period [s].
    """
    extra = trace_extra(curves.extra, period) if curves.extra else None
    case = _Case(curves, settings, period, extra, find_inputs(curves.extra))
    start = [f"{name} = 0.0" for name in ("last", *case.states)]
    steps = [_write_inputs, _write_lag, _write_core, _write_extra, _write_sum, _write_fade, _write_limit]
    body = [line for step in steps for line in step(case)]
    arguments = "".join(f", {name}=None" for name in _ARGUMENTS)
    return [
        "def build():",
        *_indent_lines([*start, "rejected, rejection = 0, ''", f"dry_gain = viscous_gain = {_n(settings.gain)}"]),
        f"    def torque(velocity_reference{arguments}):",
        f"        nonlocal rejected, rejection, {', '.join(['last', *case.states])}",
        "        try:",
        *_indent_lines(_indent_lines(_indent_lines(body))),
        "        except ParameterError as error:",
        "            last, rejection = 0.0, f'{type(error).__name__}: {error}'",
        "            rejected += 1",
        "            raise",
        "        except (TypeError, ValueError, ArithmeticError) as error:",
        "            last, rejection = 0.0, f'{type(error).__name__}: {error}'",
        "            rejected += 1",
        "            return 0.0",
        "    torque.__qualname__ = 'Compensator.torque'",  # what Python says of a missing argument names it
        "    def reset():",
        *_indent_lines(_indent_lines([f"nonlocal {', '.join(['last', *case.states])}", *start])),
        "    def set_scale(dry, viscous):",
        "        nonlocal dry_gain, viscous_gain",
        f"        dry_gain, viscous_gain = {_n(settings.gain)} * dry, {_n(settings.gain)} * viscous",
        "    return torque, reset, lambda: rejected, lambda: rejection, set_scale",
    ]


def _indent_lines(lines: Iterable[str]) -> list[str]:
    return [f"    {line}" for line in lines]


def _assign(**formulas: Expression) -> list[str]:
    """Lines that give each name its formula."""
    lines, texts = print_python(list(formulas.values()))
    return [*lines, *(f"{name} = {text}" for name, text in zip(formulas, texts, strict=True))]


def _clip(name: str, value: str, low: float, high: float) -> list[str]:
    """Lines that hold `value` to a range."""
    return [
        f"{name} = {value}",
        f"if not {_n(low)} <= {name} <= {_n(high)}:",
        f"    {name} = {_n(low)} if {name} < {_n(low)} else {_n(high)}",
    ]


def _write_given(name: str, *then: str) -> list[str]:
    """Lines for an input that is given: it becomes a float and part of the sum that is finite if all are."""
    check = [f"if {name}.__class__ is not float:", f"    {name} = as_number({name!r}, {name})", f"total += {name}"]
    return [f"if {name} is not None:", *_indent_lines([*check, *then])]


def _write_inputs(case: _Case) -> list[str]:
    settings = case.settings
    lines = [
        "if velocity_reference.__class__ is not float:",
        "    velocity_reference = as_number('velocity_reference', velocity_reference)",
        "total = drive = blended = velocity_reference",
        *(["factor = 1.0"] if case.factor else []),
        *_write_given("velocity", *_write_blend(settings)),
        *(["direction = drive"] if settings.error_rate else []),
        *_write_given("position_error", *_write_turn(settings)),
        *_write_given("normal_load", *(_write_load(case) if case.factor else [])),
    ]
    if case.extra is not None:
        for name in INPUTS:
            lines += _write_given(name)
            if name in case.inputs and name != "temperature":
                lines += ["else:", f"    {name} = total = nan"]
    return [
        *lines,
        "if total - total != 0.0:",  # infinite or NaN; what follows would turn either into a torque
        "    raise ValueError('an input is not finite, or one that the model depends on is missing')",
    ]


def _write_blend(settings: CompensationSettings) -> list[str]:
    """The velocity that decides, and the speed on the curve, where one is measured."""
    share, band, lines = settings.measured_share, _n(settings.dead_band), []
    if settings.source == "measured":
        lines = [f"drive = velocity - {band} if velocity > {band} else min(velocity + {band}, 0.0)"]
    if share == 0.0:
        return [*lines, *(["blended = drive"] if lines else [])]
    return [
        *lines,
        "blended = velocity" if share == 1.0 else f"blended = {_n(1.0 - share)} * drive + {_n(share)} * velocity",
    ]


def _write_turn(settings: CompensationSettings) -> list[str]:
    """The direction that a position error beyond its band gives."""
    if not settings.error_rate:
        return []
    band, rate = _n(settings.error_band), _n(settings.error_rate)
    return [
        f"if position_error > {band}:",
        f"    direction += {rate} * (position_error - {band})",
        f"elif position_error < -{band}:",
        f"    direction += {rate} * (position_error + {band})",
    ]


def _write_load(case: _Case) -> list[str]:
    """The factor of the load, which is held to its range and to where dry friction ends."""
    load, (low, high) = case.curves.load, case.settings.normal_load_range or (-inf, inf)
    low = max(low, load.reference_load * (1.0 - 1.0 / load.load_sensitivity))
    return [*_clip("normal_load", "normal_load", low, high)[1:], *_assign(factor=load.factor(Symbol("normal_load")))]


def _write_lag(case: _Case) -> list[str]:
    """The low pass of both velocities; beyond the range they count as its ends, so that no single input lasts."""
    if not case.curves.lag > 0.0:
        return []
    edges, steps = case.settings.velocity_range, case.period / case.curves.lag
    followed = (follow_velocity(Symbol(name), Symbol(f"{name}_now"), steps) for name in ("felt", "dragged"))
    return [
        *_clip("felt_now", "blended", *edges),
        *_clip("dragged_now", "drive", *edges),
        *_assign(**dict(zip(("felt", "dragged"), followed, strict=True))),
    ]


def _write_core(case: _Case) -> list[str]:
    """`tau` of the dry curve, its `level` and the `viscous` coefficient."""
    curves, smoothing = case.curves, _n(case.settings.smoothing)
    is_adjusted = curves.bristle is None and bool(case.settings.rest_velocity or case.settings.source == "blend")
    sides = [
        _write_side(case, curve, sign, is_adjusted) for curve, sign in ((curves.forward, ""), (curves.reverse, "-"))
    ]
    viscous = [[f"viscous = {_n(curve.viscous)}"] for curve in (curves.forward, curves.reverse)]
    if curves.bristle is not None and case.direction != "drive":
        lines = [*_choose("drive", *sides), *_choose(case.direction, *viscous)]
    else:
        lines = _choose(case.direction, *(side + more for side, more in zip(sides, viscous, strict=True)))
    lines += _write_adjustment(case) if is_adjusted else []
    has_dry = case.extra is not None
    if curves.bristle is None or curves.lag > 0.0 or has_dry:
        lines.append(f"turned = tanh({case.direction} / {smoothing})")
    if curves.lag > 0.0:  # the velocity that drags has not turned yet, and the coefficient must not jump
        mean, half = (0.5 * (curves.forward.viscous + sign * curves.reverse.viscous) for sign in (1.0, -1.0))
        lines.append(f"viscous = {_n(mean)} + {_n(half)} * turned")
    return [*lines, *(["tau = level * turned"] if curves.bristle is None else _write_bend(case))]


def _choose(name: str, forward: list[str], reverse: list[str]) -> list[str]:
    if forward == reverse:
        return forward
    return [f"if {name} >= 0.0:", *_indent_lines(forward), "else:", *_indent_lines(reverse)]


def _write_side(case: _Case, curve: CurveParameters, sign: str, is_adjusted: bool) -> list[str]:
    """The level of the curve of one direction, or what it is made of where rest is still to be looked at."""
    speed = f"speed = {sign}blended if blended {'<' if sign else '>'} 0.0 else 0.0"
    if case.curves.bristle is not None or case.curves.lag > 0.0:
        felt = "felt" if case.curves.bristle is None else case.dragged
        speed = f"speed = abs({felt})" if case.curves.lag > 0.0 else f"speed = {sign}drive"
    elif case.is_on_reference:
        speed = f"speed = {sign}drive"
    if curve.rise == 0.0 and not is_adjusted:
        return [f"level = {case.factor}{_n(curve.coulomb)}"]
    if is_adjusted:
        formulas = _assign(falling=curve.falling_share(Symbol("speed")))
        return [speed, *formulas, f"coulomb, rise = {_n(curve.coulomb)}, {_n(curve.rise)}"]
    level: Any = curve.dry(Symbol("speed"))
    return [speed, *_assign(level=Symbol("factor") * level if case.factor else level)]


def _write_adjustment(case: _Case) -> list[str]:
    """The falling branch of a joint that is seen to rest, or whose velocity is not measured."""
    width, lines = case.settings.rest_velocity, []
    if case.settings.source == "blend":
        lines = ["if velocity is None:", f"    falling *= {_n(FALLING_SHARE_WITHOUT_VELOCITY)}"]
    if width > 0.0:
        within = f"-{_n(width)} < velocity < {_n(width)}"
        lines += [
            f"elif {within}:" if lines else f"if velocity is not None and {within}:",
            f"    falling += (1.0 - falling) * (1.0 - abs(velocity) / {_n(width)})",
        ]
    symbols: list[Any] = [Symbol(name) for name in ("coulomb", "rise", "falling")]
    level = compute_dry_level(*symbols)
    return [*lines, *_assign(level=Symbol("factor") * level if case.factor else level)]


def _write_bend(case: _Case) -> list[str]:
    """The bristle; beyond `deepest_bend` nothing bends, and the torque is its level."""
    bristle = case.curves.bristle
    assert bristle is not None
    before, after, period = Symbol("deflection"), Symbol("after"), case.period
    return [
        f"steady = level / {_n(bristle.sigma_0)}",
        f"if 0.0 < steady < {_n(deepest_bend(case.curves))}:",
        *_indent_lines(_assign(after=advance_bristle(before, Symbol("drive"), Symbol("steady"), period))),
        *_indent_lines(_assign(tau=bristle_torque(bristle.sigma_0, bristle.sigma_1, before, after, period))),
        "    deflection = after",
        "else:",
        "    deflection = 0.0",
        f"    tau = level * tanh(drive / {_n(case.settings.smoothing)})",
    ]


def _write_extra(case: _Case) -> list[str]:
    """`dry`, `drag` and `held` of the terms that fit no curve, and their states."""
    extra = case.extra
    if extra is None:
        return []
    low, high = case.settings.velocity_range
    lines, symbols = [], extra.symbols
    if symbols & {"velocity", "is_forward", "speed"}:
        lines.append("velocity = drive")
    if "speed" in symbols:
        lines += [
            f"speed = blended if {case.direction} >= 0.0 else -blended",
            f"fastest = {_n(high)} if velocity >= 0.0 else {_n(-low)}",
            "speed = 0.0 if speed < 0.0 else fastest if speed > fastest else speed",
        ]
    lines += clip_lines(find_bounds(case.settings), symbols)
    names = {
        "is_forward": "velocity >= 0.0",
        TURNS_FORWARD: f"{case.direction} >= 0.0",
        "has_temperature": "temperature is not None",
    }
    for step in extra.steps:
        found, texts = print_python(step.after, names)
        lines += [*found, *(f"{name}_after = {text}" for name, text in zip(step.states, texts, strict=True))]
    found, texts = print_python([extra.dry, extra.drag, extra.held], names)
    lines += [*found, *(f"{name} = {text}" for name, text in zip(("dry", "drag", "held"), texts, strict=True))]
    return [*lines, *(f"{name} = {name}_after" for step in extra.steps for name in step.states)]


def _write_sum(case: _Case) -> list[str]:
    """All friction together, with the gains."""
    if case.extra is None:
        return [f"tau = dry_gain * tau + viscous_gain * viscous * {case.dragged}"]
    return [
        "if dry < -level:",  # all of dry friction together may vanish, but it never drives
        "    dry = -level",
        f"tau = dry_gain * (tau + dry * turned) + viscous_gain * (viscous * {case.dragged} + drag)",
    ]


def _write_fade(case: _Case) -> list[str]:
    """The fade beyond the range of velocity, and what holds a position, which does not fade."""
    (low, high), fade = case.settings.velocity_range, 1.0 / case.settings.fade_width
    lines = [
        f"if not {_n(low)} <= drive <= {_n(high)}:",
        f"    left = 1.0 - (drive - {_n(high)} if drive > {_n(high)} else {_n(low)} - drive) * {_n(fade)}",
        "    tau = tau * left if left > 0.0 else 0.0",
    ]
    return lines if case.extra is None else [*lines, f"tau += {_n(case.settings.gain)} * held"]


def _write_limit(case: _Case) -> list[str]:
    """The limits of authority and rate."""
    highest, step = case.settings.authority, case.settings.torque_rate * case.period
    lines = [
        f"if not {_n(-highest)} <= tau <= {_n(highest)}:",
        "    if tau - tau != 0.0:",
        "        raise ValueError('the torque is not finite')",
        f"    tau = {_n(highest)} if tau > 0.0 else {_n(-highest)}",
    ]
    if not isinf(step):
        lines += [
            f"if not {_n(-step)} <= tau - last <= {_n(step)}:",
            f"    tau = last + {_n(step)} if tau > last else last - {_n(step)}",
            "last = tau",
        ]
    return [*lines, "return tau"]
