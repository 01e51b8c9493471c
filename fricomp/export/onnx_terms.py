"""The closed form of the friction of several joints as one formula."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from fricomp.control.compensation.curve import FrictionCurves
from fricomp.export.onnx_nodes import make_column, merge_joints
from fricomp.laws import Parts, Term, TracedPoint, trace_parts
from fricomp.laws.expression import Call, Expression, Symbol
from fricomp.laws.stribeck import compute_dry_level, compute_falling_share

_VELOCITY: Any = Symbol("velocity")
_SPEED: Any = Call("absolute", _VELOCITY)
_IS_FORWARD: Any = _VELOCITY >= 0.0


def closed_form(curves: Sequence[FrictionCurves], caps: Sequence[float | None]) -> Expression:
    """Friction of each joint in steady sliding, over the columns of the state.

    Args:
        curves: The law of each joint, taken apart.
        caps: Most friction that its curve may claim; None for any.
    """
    factor = _load_factor(curves)
    sides = [_side([getattr(each, side) for each in curves], factor) for side in ("forward", "reverse")]
    dry, size = (np.where(_IS_FORWARD, ahead, back) for ahead, back in zip(*sides, strict=True))
    sign: Any = np.sign(_VELOCITY)
    torque: Any = size * sign
    if any(caps):
        cap = make_column([np.inf if cap is None else cap for cap in caps])
        torque = np.maximum(np.minimum(torque, cap), -cap)
    beside = _sum_parts([each.extra for each in curves])
    if beside.dry is not None:  # all levels together take no more than there is, so that dry friction never drives
        torque = torque + np.maximum(beside.dry, -dry) * sign
    for part in (beside.drag, beside.held):
        torque = torque if part is None else torque + part
    found: Expression = torque
    return found


def _load_factor(curves: Sequence[FrictionCurves]) -> Any:
    """What dry friction is multiplied with; far below the reference load it ends."""
    factor: Any = merge_joints([curve.load.factor(Symbol("normal_load")) for curve in curves])
    factor = np.maximum(factor, 0.0)
    smoothing = [curve.smoothing for curve in curves]
    if not any(smoothing):
        return factor
    sharp = make_column([0.0 if width > 0.0 else 1.0 for width in smoothing])  # these change their sign at once
    width = make_column([width or 1.0 for width in smoothing])
    return factor * np.maximum(np.tanh(_SPEED / width), sharp)


def _side(curves: Sequence[Any], factor: Any) -> tuple[Any, Any]:
    """Dry friction and all friction of the curves of one direction."""
    coulomb, rise, stribeck_velocity, exponent, viscous = (make_column(column) for column in zip(*curves, strict=True))
    dry = factor * compute_dry_level(coulomb, rise, compute_falling_share(_SPEED, stribeck_velocity, exponent))
    return dry, dry + viscous * _SPEED


def _sum_parts(laws: Sequence[Sequence[Term]]) -> Parts:
    """The terms beside the curves of all joints, added up by what they resist."""
    point = TracedPoint(normal_load=None, traced_speed=_SPEED, forward=_IS_FORWARD, unknown=())
    sums: dict[str, Any] = {}
    for name in dict.fromkeys(term.name for terms in laws for term in terms):
        owned = [next((term for term in terms if term.name == name), None) for terms in laws]
        parts = [Parts() if term is None else trace_parts(term, point) for term in owned]
        for kind in ("dry", "drag", "held"):
            merged = merge_joints([getattr(part, kind) for part in parts])
            if merged is not None:
                sums[kind] = sums[kind] + merged if kind in sums else merged
    return Parts(**sums)
