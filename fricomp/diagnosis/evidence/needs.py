"""What a name needs besides a gain: a number that is not that of the effect's absence, and is no end of the search."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from ..effects.structure import N_BASE
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
    """Say that the 95 % region of its numbers holds its absence; empty where it does not."""
    own = [(i, p) for i, (owner, p) in enumerate(refitted.structure.parameters, N_BASE) if owner == name]
    linear = [i for i, parameter in own if parameter.linear and parameter.scale > 0.0]
    if linear:
        values, spread = refitted.fit.theta[linear], refitted.covariance[np.ix_(linear, linear)]
        distance = float(values @ np.linalg.pinv(spread, hermitian=True) @ values)
        return "its interval holds zero" if distance < chi2.ppf(NEEDS.sure, len(linear)) else ""
    quantities = refitted.list_parameters(name, "", "")
    for _, parameter in own:
        low, high = quantities[parameter.name].ci95
        if parameter.null is not None and low <= parameter.null <= high:
            return f"the interval of its {parameter.name.replace('_', ' ')} holds that of a joint without it"
    return ""
