"""The base with parameters as the simulation has them, from which the error of the written models is counted."""

from __future__ import annotations

from dataclasses import astuple, replace

import numpy as np

from fricomp.laws import BidirectionalStribeck, FrictionLaw, Stribeck, StribeckCurve
from fricomp.model import FrictionModel

from ..delivery.models import GivenModel
from ..evidence.case import Case
from ..evidence.findings import Findings
from ..evidence.in_place import BODY_SHIFTS

_BODY = ("inertia", "gravity_cosine", "gravity_sine")
_OFFSET = "offset"


def write_given_model(findings: Findings, base: FrictionModel) -> GivenModel | None:
    """The refitted base with those parameters put back that were found to be off; None where the files say none of
    them.

    A simulation has one friction for both directions: where these were found to differ, its level is refitted, and the
    constant torque is the simulation's.

    Args:
        findings: What was found to be off.
        base: Friction and rigid body of the refitted base.
    """
    case, rigid = findings.case, findings.case.rigid
    off = {shift.name for shift in findings.comparison.shifts}
    model, held = base, tuple[str, ...]()
    if rigid is not None and base.dynamics is not None and off & set(BODY_SHIFTS):
        cosine, sine = rigid.gravity
        body = replace(base.dynamics, inertia=rigid.inertia, load_inertia=0.0)
        model, held = replace(base, dynamics=replace(body, gravity_cosine=cosine, gravity_sine=sine)), _BODY
    uneven = off - set(BODY_SHIFTS) or (off and rigid is not None and not rigid.rotary)
    even = _even_out(case, model) if uneven else None
    if even is not None:
        model, held = even, (*held, _OFFSET)
    return GivenModel(model, held) if held else None


def _even_out(case: Case, model: FrictionModel) -> FrictionModel | None:
    """The model with one curve for both directions, and the constant torque of the simulation; None where a friction
    model was given, which has curves of its own."""
    (term, *others), dynamics = model.law.terms, model.dynamics
    if case.friction is not None or not isinstance(term, BidirectionalStribeck) or dynamics is None:
        return None
    numbers = zip(astuple(term.forward), astuple(term.reverse), strict=True)
    even = StribeckCurve(*(float(np.mean(pair)) for pair in numbers))
    offset = 0.0 if case.rigid is None else case.rigid.offset
    return replace(model, law=FrictionLaw((Stribeck(even), *others)), dynamics=replace(dynamics, offset=offset))
