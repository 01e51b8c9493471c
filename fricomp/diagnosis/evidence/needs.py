"""What a name needs besides a gain: a number that is not that of the effect's absence, and is no end of the search."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from scipy.stats import chi2

from ..effects import EFFECTS
from ..effects.effect import EffectParameter, compute_lowest_order
from ..effects.structure import N_BASE
from ..inputs.track import FloatArray, goes_one_way
from .refitted import RefittedJoint, condition
from .settings import NEEDS
from .undetermined import is_open_of_effect


def list_objections(refitted: RefittedJoint, shown: Collection[str] = ()) -> dict[str, str]:
    """Say for each effect what speaks against its name; nothing for those that have all that they need.

    Args:
        refitted: The explanation at its minimum, with fresh derivatives.
        shown: Effects without which far less is explained: a region about the minimum says less of them, where a few
            loud rows make it wide or numbers bend, as those of a stop that is met twice.
    """
    found = {}
    for name in refitted.structure.names:
        absence = () if name in shown else (_find_another, _find_absence, _find_trade)
        findings = (_find_end, _find_doubt, _find_periods, _find_open, *absence)
        reason = next((said for find in findings if (said := find(refitted, name))), "")
        if reason:
            found[name] = reason
    return found


def find_one_way(names: Sequence[str], velocities: Sequence[FloatArray]) -> dict[str, str]:
    """Say what speaks against effects that need both directions where the joint moves in one; nothing for others.

    What depends on the angle repeats in each turn. All else depends on speed and torque, which such a motion
    hardly changes, so that friction and a constant torque look the same.

    Args:
        names: Of the effects.
        velocities: Of the motions [rad/s] or [m/s]. Each of shape (n,).
    """
    if not goes_one_way(velocities):
        return {}
    said = "the joint moves in one direction only, which shows what depends on the angle and nothing else"
    return {name: said for name in names if not EFFECTS[name].ripple}


def _find_end(refitted: RefittedJoint, name: str) -> str:
    """Say which of its numbers stands where the search of it ends; empty where none does."""
    for index, (owner, parameter) in enumerate(refitted.structure.parameters, N_BASE):
        if owner == name and parameter.scale > 0.0 and parameter.is_at_end(float(refitted.fit.theta[index])):
            return f"its {parameter.name.replace('_', ' ')} stands at the end of what is looked for"
    return ""


def _find_doubt(refitted: RefittedJoint, name: str) -> str:
    """Say why no joint is named by its numbers; empty where one is."""
    structure = refitted.structure
    values = structure.name_values(refitted.fit.theta[N_BASE:])[name]
    return EFFECTS[name].doubt(values, structure.contexts) or ""


def _find_periods(refitted: RefittedJoint, name: str) -> str:
    """Say that a ripple may have no period within the recorded range, and be anything that varies slowly; empty where
    it has one."""
    least = compute_lowest_order(refitted.structure.contexts)
    if any(one.name == "order" and one.lower >= least for one in _list_lowest(refitted, name)):
        return "its interval holds orders of which no period lies within the recorded range"
    return ""


def _find_another(refitted: RefittedJoint, name: str) -> str:
    """Say that a number may as well stand at its lower bound, where the effect would be another one; empty where none
    does."""
    at = next((one for one in _list_lowest(refitted, name) if one.at_lowest), None)
    return "" if at is None else f"the interval of its {at.name.replace('_', ' ')} holds that of {at.at_lowest}"


def _list_lowest(refitted: RefittedJoint, name: str) -> list[EffectParameter]:
    """Parameters of an effect whose 95 % interval reaches their lower bound."""
    lows = refitted.fit.theta - 1.96 * refitted.deviations
    parameters = enumerate(refitted.structure.parameters, N_BASE)
    return [one for index, (owner, one) in parameters if owner == name and float(lows[index]) <= one.lower]


def _find_open(refitted: RefittedJoint, name: str) -> str:
    """Say which number that its effect is looked for by, such as a gap, this recording does not determine."""
    numbers = refitted.list_parameters(name, "", "", fit_alone=True)
    own = [one for owner, one in refitted.structure.parameters if owner == name and one.searched]
    at = next((one.name for one in own if one.name in numbers and is_open_of_effect(one, numbers)), "")
    return f"its {at.replace('_', ' ')} is not determined by this recording" if at else ""


def _find_absence(refitted: RefittedJoint, name: str) -> str:
    """Say that the 95 % region of its numbers holds its absence; empty where it does not.

    The numbers in which it is linear are compared with zero where its others stand: without the effect those mean
    nothing, so that the likelihood of its absence is the same whatever they are [davies1987]. That they were chosen
    where the likelihood is largest counts as freedom. Among them is one that ends where its domain does: it moves to
    one side at most, and no step of it can stand for the others.
    """
    own = [(i, p) for i, (owner, p) in enumerate(refitted.structure.parameters, N_BASE) if owner == name]
    linear = [i for i, parameter in own if parameter.linear and parameter.scale > 0.0]
    if linear:
        others = [i for i, parameter in own if not parameter.linear and parameter.scale > 0.0]
        spread = condition(refitted.covariance, linear, others)
        values = refitted.fit.theta[linear]
        distance = float(values @ np.linalg.pinv(spread, hermitian=True) @ values)
        if distance >= chi2.ppf(NEEDS.sure, len(linear) + len(others)):
            return ""
    quantities = refitted.list_parameters(name, "", "")
    intervals = {name: quantity.ci95 for name, quantity in quantities.items()}
    nulls = {p.name: p.null for _, p in own if p.null is not None and p.name in intervals}
    held = {name: intervals[name][0] <= null <= intervals[name][1] for name, null in nulls.items()}
    if linear:
        return "its interval holds zero" if all(held.values()) else ""
    at = next((one.replace("_", " ") for one, holds in held.items() if holds), "")
    return f"the interval of its {at} holds that of a joint without it" if at else ""


def _find_trade(refitted: RefittedJoint, name: str) -> str:
    """Say that each wave of an effect may be nothing, though all together are not; empty where one is known.

    On a small part of a turn waves draw a curve that other effects draw as well, each making up for the others.
    """
    numbers = refitted.list_parameters(name, "", "")
    waves = [one for at, one in numbers.items() if at.startswith(("sine", "cosine", "amplitude"))]
    if len(waves) < 2 or not all(one.ci95[0] <= 0.0 <= one.ci95[1] for one in waves):
        return ""
    return "its waves make up for each other: this recording determines none of them"
