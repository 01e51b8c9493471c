"""The largest torque that a compensation may give: the model's largest friction over its range of validity."""

from __future__ import annotations

import math
from itertools import product

from fricomp.control.curve import FrictionCurves
from fricomp.control.extra_terms import LOAD_TERMS
from fricomp.control.trust import compute_torque_cap
from fricomp.laws import Cogging, DwellStiction, FrictionLaw, KinematicError, PositionCoulomb, Term
from fricomp.model import FrictionModel, Validity

__all__ = ["compute_authority"]

# Friction from a load of unknown range is trusted up to as much as all other friction together [1].
_UNKNOWN_LOAD_SHARE = 1.0


def compute_authority(
    model: FrictionModel, curves: FrictionCurves, velocity_range: tuple[float, float]
) -> tuple[float, list[str]]:
    """Largest friction of `model` over its validity, in its torque unit, and what is unknown about it.

    That of the curves counts up to `compute_torque_cap`.

    Returns:
        The torque, and notes in sentences.
    """
    factors = [float(curves.load.factor(edge)) for edge in model.validity.normal_load or ()]
    cap = compute_torque_cap(model)
    largest = min(curves.largest(velocity_range, max([*factors, 1.0])), math.inf if cap is None else cap)
    over_load = [term for term in curves.extra if isinstance(term, LOAD_TERMS)]
    rest = [term for term in curves.extra if not isinstance(term, LOAD_TERMS)]
    largest += sum(_largest(term, velocity_range, model.validity) for term in rest)
    if not over_load:
        return largest, []
    if model.validity.load_torque is not None:
        return largest + sum(_largest(term, velocity_range, model.validity) for term in over_load), []
    note = (
        "the model states no range of load torque: friction from the load is compensated up to as much as all other "
        "friction together; give authority for more"
    )
    return largest * (1.0 + _UNKNOWN_LOAD_SHARE), [note]


def _largest(term: Term, velocity_range: tuple[float, float], validity: Validity) -> float:
    """Largest torque of a term: the amplitude of a wave, or the largest at the ends of all ranges.

    What follows the acceleration, of which a model states no range, is no part of it.
    """
    if isinstance(term, Cogging | PositionCoulomb):
        return math.hypot(term.sine, term.cosine)
    if isinstance(term, DwellStiction):
        return term.rise
    if isinstance(term, KinematicError):
        fastest = max(abs(edge) for edge in velocity_range)
        gravity = math.hypot(term.gravity_cosine, term.gravity_sine)
        pushed = (1.0 + term.order) * gravity + term.load_inertia * (term.order * fastest) ** 2
        return math.hypot(term.sine, term.cosine) * pushed
    # Next to rest as well, where falling branches are highest.
    speeds = [edge * share for edge in velocity_range for share in (1.0, 1e-6)]
    ends = product(speeds, validity.position or (0.0,), validity.load_torque or (0.0,), validity.temperature or (None,))
    law = FrictionLaw((term,))
    return max(abs(float(law.torque(v, position=q, load_torque=load, temperature=hot))) for v, q, load, hot in ends)
