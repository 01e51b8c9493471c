"""What bends over the speed, asked for again beside every Stribeck curve.

A curve is taken in first, and may stand in for a drag: beside that curve nothing asks for it, beside another one it is
far more probable. Friction that creeps may have kept it out too, which left the model again.
"""

from __future__ import annotations

from typing import NamedTuple

from ..coordinates import ArmModel
from ..fit import ArmFit
from ..friction import TERMS
from ..glance import Glance
from ..physics import is_physical
from .proposal import add_term
from .stribeck import hold_curve, is_curve

_BENDS = [term for term in TERMS.values() if term.family == "speed"]


class Bend(NamedTuple):
    """What bends over the speed.

    Attributes:
        term: Its name.
        model: With it.
        gain: Logarithm of its Bayes factor.
    """

    term: str
    model: ArmModel
    gain: float


def find_bend(glance: Glance, fit: ArmFit, joint: int) -> Bend | None:
    """The most probable bend in a joint, beside no Stribeck curve or any that is one; weighed against the most probable
    of these alone. None where the joint has a bend, or none can be.

    Args:
        glance: At the fit.
        fit: Of the model without it.
        joint: Its number.
    """
    if any(term.name in fit.model.forms[joint].names for term in _BENDS):
        return None

    def is_possible(model: ArmModel) -> bool:
        there = glance.solve(model)
        return is_physical(there, fit) and ("stribeck" not in model.forms[joint].names or is_curve(there, joint))

    bare = fit.model.without_terms(joint, "stribeck")
    curves = [hold_curve(fit.model, joint)] if "stribeck" in fit.model.forms[joint].names else []
    curves = [bare, *filter(is_possible, [*curves, *add_term(bare, joint, TERMS["stribeck"])])]
    bent = [(term.name, one) for term in _BENDS for curve in curves for one in add_term(curve, joint, term)]
    weighed = sorted(((glance.measure_gain(one), name, one) for name, one in bent), key=lambda each: -each[0])
    best = next((each for each in weighed if is_possible(each[2])), None)  # a gain costs less than a fit
    if best is None:
        return None
    gain, name, model = best
    return Bend(name, model, gain - max(map(glance.measure_gain, curves)))
