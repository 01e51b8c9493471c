"""Friction as the two or three numbers of most simulators: a level, a slope, and the level at rest."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.control.compensation.curve import split_law
from fricomp.control.compensation.trust import bound_friction, require_usable
from fricomp.errors import ExportError
from fricomp.export.fidelity import Fidelity, compute_fidelity, fit_levels, sample_friction
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    Dahl,
    FrictionLaw,
    LuGre,
    SmoothedCoulomb,
    Stribeck,
    StribeckCurve,
    Term,
    trace_parts,
)
from fricomp.model import FrictionModel


@dataclass(frozen=True)
class FrictionLevels:
    """Friction of one joint as a level and a slope that come closest over the model's range of velocity.

    Attributes:
        joint: Name of the joint.
        rotary: Whether it turns; otherwise it slides.
        static: Largest friction of either direction at the lowest speeds, mean of both directions [N·m] or [N].
        sliding: Level of dry friction while it moves [N·m] or [N].
        viscous: Slope over the velocity [N·m·s/rad] or [N·s/m].
        fidelity: What is lost.
    """

    joint: str
    rotary: bool
    static: float
    sliding: float
    viscous: float
    fidelity: Fidelity


def fit_friction_levels(model: FrictionModel, *, any_status: bool = False) -> FrictionLevels:
    """The level and the slope that come closest to a model's steady friction.

    Args:
        model: What is exported.
        any_status: Take a model too that its identification calls unusable.

    Raises:
        ExportError: The model is not in newton metres or newtons, or has no friction.
        ParameterError: The model is not usable.
    """
    require_torque(model)
    if not any_status:
        require_usable(model)
    model = bound_friction(model)
    held = find_held_terms(model)
    model = drop_terms(model, held)
    curves = split_law(model.law)
    velocity, friction = sample_friction(model)
    level, slope = fit_levels(velocity, friction)
    lost = ["one level for both directions, no Stribeck effect, no load, no presliding"]
    if curves.lag:
        lost.append(f"friction does not lag the velocity, by {curves.lag:g} s in the model")
    left_out = [term.name for term in (*held, *curves.extra)]
    if left_out:
        lost.append(f"left out: {', '.join(left_out)}")
    slowest = [np.abs(friction[side][np.argmin(np.abs(velocity[side]))]) for side in (velocity > 0, velocity < 0)]
    return FrictionLevels(
        joint=model.joint,
        rotary=model.motion == "rotary",
        static=max(float(np.mean(slowest)), level),
        sliding=level,
        viscous=slope,
        fidelity=compute_fidelity(model, velocity, level * np.sign(velocity) + slope * velocity, tuple(lost)),
    )


def require_torque(model: FrictionModel) -> None:
    """Refuse a model in amperes or in per cent, which no simulator takes.

    Raises:
        ExportError: It is in another unit than N·m (rotary) or N (linear).
    """
    wanted = "N·m" if model.motion == "rotary" else "N"
    if model.torque_unit != wanted:
        raise ExportError(
            f"the model of joint {model.joint!r} is in {model.torque_unit}, a simulator takes {wanted}: calibrate with "
            "the drive's torque_constant, which 'fricomp calibrate --torque-constant' measures"
        )


def find_held_terms(model: FrictionModel) -> list[Term]:
    """Terms that act whatever the direction of motion, and so are no friction."""
    return [term for term in model.law.terms if trace_parts(term).held is not None]


def drop_terms(model: FrictionModel, terms: Sequence[Term]) -> FrictionModel:
    """The model without terms over position, which another element says.

    Raises:
        ExportError: Nothing would be left.
    """
    kept = tuple(term for term in model.law.terms if term not in terms)
    if not kept:
        raise ExportError(f"the law of joint {model.joint!r} has no friction, only terms over position")
    return model.with_law(FrictionLaw(kept))


def join_levels(model: FrictionModel) -> tuple[FrictionModel, tuple[str, ...]]:
    """The model with every further level of dry friction in its first curve, and the names of the terms that had them.

    Where only a part of the friction builds up after a reversal, that part is a term of its own beside the curve. What
    holds one curve would leave it out, and slide too easily.
    """
    terms = model.law.terms
    first = next((one for one in terms if isinstance(one, BidirectionalStribeck | Stribeck)), None)
    if first is None:
        return model, ()
    levels = [
        (one, _find_flat_level(one)) for one in terms if one is not first and getattr(one, "load", None) == first.load
    ]
    flat = {one: level for one, level in levels if level is not None}
    if not flat:
        return model, ()
    ahead, back = (first.curve, first.curve) if isinstance(first, Stribeck) else (first.forward, first.reverse)
    for more, less in flat.values():
        ahead, back = _raise_curve(ahead, more), _raise_curve(back, less)
    whole = BidirectionalStribeck(ahead, back, first.load)
    kept = tuple(whole if one is first else one for one in terms if one not in flat)
    return model.with_law(FrictionLaw(kept)), tuple(one.name for one in flat)


def _find_flat_level(term: Term) -> tuple[float, float] | None:
    """Level of a term in each direction that slides with it whatever the speed [N·m] or [N]; None for others."""
    if isinstance(term, Coulomb | SmoothedCoulomb | Dahl):
        return term.coulomb_torque, term.coulomb_torque
    if not isinstance(term, LuGre):
        return None
    curves = term.forward, term.reverse
    if any(one.static_torque != one.coulomb_torque or one.viscous_coefficient for one in curves):
        return None
    return term.forward.coulomb_torque, term.reverse.coulomb_torque


def _raise_curve(curve: StribeckCurve, level: float) -> StribeckCurve:
    return replace(curve, coulomb_torque=curve.coulomb_torque + level, static_torque=curve.static_torque + level)
