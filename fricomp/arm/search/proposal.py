"""What may be taken into the model of an arm next: one thing more, by its name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..coordinates import ArmModel
from ..friction import CREEP, TERMS, JointForm, JointTerm
from ..rigid.simulated_arm import SimulatedArm
from .stribeck import hold_curve


def propose_models(arm: SimulatedArm, model: ArmModel) -> Iterator[tuple[str, ArmModel]]:
    """Every model with one thing more, by its name; a term of a joint comes with all its variants."""
    for j, (joint, form) in enumerate(zip(arm.joints, model.forms, strict=True)):
        for term in (one for one in TERMS.values() if _suits(one, form, rotary=arm.rotary[j])):
            yield from ((f"{joint}: {term.name}", other) for other in add_term(model, j, term))
    for i, link in enumerate(arm.links):
        if i not in model.opened:
            yield f"{link} is off", replace(model, opened=model.opened | {i})
    if not model.tilted:
        yield "gravity leans over", replace(model, tilted=True)
    if not model.gain:
        yield "all torques have a gain", replace(model, gain=True)


def add_term(model: ArmModel, joint: int, term: JointTerm) -> Iterator[ArmModel]:
    """The model with each variant of a term more in a joint, and in place of what that may stand for; none where the
    joint has the term."""
    form = model.forms[joint]
    for variant in range(len(term.values)) if term.name not in form.names else ():
        other = model.with_form(joint, form.with_term(term.name, variant))
        yield hold_curve(other, joint) if term.filled == "stribeck" else other
        if term.replaces:
            yield replace(other, pinned=model.pinned | {(joint, name) for name in term.replaces})


def _suits(term: JointTerm, form: JointForm, *, rotary: bool) -> bool:
    """Whether a term may act beside others in a joint that turns, or slides.

    Friction that creeps is ahead of its joint by a time of its own. Beside a delay of the joint it would take the part
    of friction in that, and leave a delay of the links alone, which is none.
    """
    timed = term.name == CREEP and any(TERMS[name].filled == "delay" for name in form.names)
    return not timed and (rotary or term.on_slides is not None)
