"""What a name needs besides a gain: a number that is not that of the effect's absence, and is no end of the search."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from ..effects.effect import EffectParameter
from ..effects.settings import EFFECT
from ..effects.structure import N_BASE
from ..inputs.track import FloatArray
from .refitted import RefittedJoint
from .settings import NEEDS

__all__ = ["list_objections"]


def list_objections(refitted: RefittedJoint) -> dict[str, str]:
    """Say for each effect what speaks against its name; nothing for those that have all that they need.

    Args:
        refitted: The explanation at its minimum, with fresh derivatives.
    """
    found = {}
    for name in refitted.structure.names:
        reason = _find_end(refitted, name) or _find_absence(refitted, name)
        if reason:
            found[name] = reason
    return found


def _find_end(refitted: RefittedJoint, name: str) -> str:
    """Say which of its numbers stands where the search of it ends; empty where none does."""
    for index, (owner, parameter) in enumerate(refitted.structure.parameters, N_BASE):
        if owner == name and parameter.scale > 0.0 and parameter.is_at_end(float(refitted.fit.theta[index])):
            return f"its {parameter.name.replace('_', ' ')} stands at the end of what is looked for"
    return ""


def _find_absence(refitted: RefittedJoint, name: str) -> str:
    """Say that the 95 % region of its numbers holds its absence; empty where it does not.

    A number that ends where its domain does moves to one side at most, and no step of it can stand for the others: the
    region is that of the others beside it. A spring that does not stiffen is known, whatever stiffening would hide.
    """
    own = [(i, p) for i, (owner, p) in enumerate(refitted.structure.parameters, N_BASE) if owner == name]
    linear = [i for i, parameter in own if parameter.linear and parameter.scale > 0.0]
    if linear:
        ended = [i for i, parameter in own if not parameter.linear and _is_ended(refitted, i, parameter)]
        spread = _condition(refitted.covariance, linear, ended)
        values = refitted.fit.theta[linear]
        distance = float(values @ np.linalg.pinv(spread, hermitian=True) @ values)
        return "its interval holds zero" if distance < chi2.ppf(NEEDS.sure, len(linear)) else ""
    quantities = refitted.list_parameters(name, "", "")
    for _, parameter in own:
        low, high = quantities[parameter.name].ci95
        if parameter.null is not None and low <= parameter.null <= high:
            return f"the interval of its {parameter.name.replace('_', ' ')} holds that of a joint without it"
    return ""


def _is_ended(refitted: RefittedJoint, index: int, parameter: EffectParameter) -> bool:
    """Whether a number stands where its domain ends."""
    margin = EFFECT.at_bound * (parameter.upper - parameter.lower)
    return not parameter.lower + margin < float(refitted.fit.theta[index]) < parameter.upper - margin


def _condition(covariance: FloatArray, kept: list[int], given: list[int]) -> FloatArray:
    """Covariance of some numbers where others are given. Shape (n_kept, n_kept)."""
    own = covariance[np.ix_(kept, kept)]
    if not given:
        return np.asarray(own)
    across = covariance[np.ix_(kept, given)]
    among = np.linalg.pinv(covariance[np.ix_(given, given)], hermitian=True)
    return np.asarray(own - across @ among @ across.T)
