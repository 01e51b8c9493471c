"""How far a model is trusted: whether it may be used, and how much friction it may claim where none was measured.

A law extends to speeds at which nothing was measured, above all to those between the slowest one and rest. Data that
do not show the bend there fit a static torque of any size.
"""

import math
from dataclasses import replace

from fricomp.control.compensation.curve import FrictionCurves, split_law
from fricomp.errors import ParameterError
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    Dahl,
    FrictionLaw,
    LoadScaling,
    LuGre,
    SmoothedCoulomb,
    Stribeck,
    StribeckCurve,
    Term,
)
from fricomp.model import FrictionModel

LARGEST_EXTRAPOLATION = 2.0
"""Friction at speeds that were not measured is at most this multiple of the largest that was [1]. With table I of
[luo2024pinn], a sweep that starts at the Stribeck velocity itself has to extrapolate by 1.9."""
# Another basin that is nearly as likely has other parameters, but much the same curve where speeds were measured. A law
# that the points depart from is still the nearest of its kind to them there.
_USABLE = ("", "converged", "lack_of_fit", "wrong_basin_suspected")


def find_doubt(model: FrictionModel) -> str | None:
    """Why `model` should not be used, or None.

    A model without a status was written by hand or by a version that kept none; then its covariance decides. Viscous
    friction does not count there: near zero it is never known by its own size, and it grows beyond the range only.
    """
    provenance = model.provenance
    if provenance.status:
        return find_doubt_in_status(provenance.status, provenance.message)
    if model.covariance is None:
        return None
    values = model.law.parameters()
    deviations = model.covariance.standard_deviations()
    vague = [n for n, sd in deviations.items() if sd > abs(values[n]) and not n.endswith("viscous_coefficient")]
    return f"its data do not determine {', '.join(vague)}: the standard deviation exceeds the value" if vague else None


def find_doubt_in_status(status: str, message: str) -> str | None:
    """Why a model or network whose identification ended with `status` should not be used, or None."""
    if status in _USABLE:
        return None
    return f"{status}: {message}" if message else status


def require_usable(model: FrictionModel) -> None:
    """Refuse a model that its own identification calls unusable.

    Raises:
        ParameterError: The model's status, or without one its covariance, says so.
    """
    doubt = find_doubt(model)
    if doubt is not None:
        raise ParameterError(
            f"the model of joint {model.joint!r} is not usable ({doubt}); identify it from better data, or pass "
            "any_status=True (fricomp export: --any-status) to use it all the same"
        )


def compute_torque_cap(model: FrictionModel) -> float | None:
    """Most friction that the curves of `model` may claim, in its torque unit; None where no data are known."""
    largest = model.provenance.largest_torque
    return None if largest is None else LARGEST_EXTRAPOLATION * largest


def bound_friction(model: FrictionModel) -> FrictionModel:
    """`model` with dry friction no larger than `compute_torque_cap`, at rest as well.

    A static torque above it is lowered to it, and the Stribeck velocity changed so that the curve keeps its value at
    the slowest speed measured. A model within the bound, or without data, comes back as it is.
    """
    cap = compute_torque_cap(model)
    if cap is None:
        return model
    terms = tuple(_bound_term(term, cap, model) for term in model.law.terms)
    return model if terms == model.law.terms else replace(model, law=FrictionLaw(terms))


def trusted_curves(model: FrictionModel) -> FrictionCurves:
    """The law of `model` taken apart, within `bound_friction`, following the normal load only where that is known.

    A law whose data held no normal load has a mere default there: a load of 0 would take all dry friction away.

    Raises:
        ParameterError: The law leaves nothing to compensate.
    """
    curves = split_law(bound_friction(model).law)
    if model.validity.normal_load is None and curves.load == LoadScaling():
        return replace(curves, load=LoadScaling(load_sensitivity=0.0))
    return curves


def _bound_term(term: Term, cap: float, model: FrictionModel) -> Term:
    if not isinstance(term, BidirectionalStribeck | Stribeck | LuGre | Coulomb | SmoothedCoulomb | Dahl):
        return term
    # The parameters hold at the reference load, the data at their own.
    factors = [float(term.load.factor(load)) for load in model.validity.normal_load or (None,)]
    level = cap / max(*factors, 1e-3)
    reverse, forward = model.provenance.slowest_speeds or (0.0, 0.0)
    if isinstance(term, BidirectionalStribeck | LuGre):
        ahead, back = _bound_curve(term.forward, level, forward), _bound_curve(term.reverse, level, reverse)
        return replace(term, forward=ahead, reverse=back)
    if isinstance(term, Stribeck):
        return replace(term, curve=_bound_curve(term.curve, level, min(reverse, forward)))
    if term.coulomb_torque <= level:
        return term
    lowered = replace(term, coulomb_torque=level)
    if isinstance(lowered, SmoothedCoulomb):  # keeps its slope at rest, where such a curve was measured
        return replace(lowered, smoothing_velocity=lowered.smoothing_velocity * level / term.coulomb_torque)
    return lowered


def _bound_curve(curve: StribeckCurve, level: float, slowest: float) -> StribeckCurve:
    """`curve` with a static torque of at most `level`; above `slowest` it changes little."""
    if curve.static_torque <= level:
        return curve
    coulomb = min(curve.coulomb_torque, level)
    rise = level - coulomb
    bend = curve.stribeck_velocity
    if slowest > 0.0 and rise > 0.0:
        # rise exp(-(slowest/bend)^delta) stays; in logarithms, because the old rise may be of any size.
        delta = curve.stribeck_exponent
        fallen = (slowest / bend) ** delta - math.log((curve.static_torque - coulomb) / rise)
        bend = slowest / fallen ** (1.0 / delta) if fallen > 0.0 else bend
    return replace(curve, coulomb_torque=coulomb, static_torque=level, stribeck_velocity=bend)
