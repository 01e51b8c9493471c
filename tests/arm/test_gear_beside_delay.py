"""Delays of single joints beside gears that give way or have a gap."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest

from fricomp.arm import answer, identification
from fricomp.arm.answer import confirm_terms
from fricomp.arm.coordinates import ArmModel
from fricomp.arm.friction import JointForm
from fricomp.arm.identification import _list_added, _try_out

_PLAIN = ArmModel((JointForm(), JointForm()))
_GAINS = {"backlash": 2000.0, "torque_delay": 40.0, "stribeck": 30.0}


class _Fit:
    """A fit of which the model alone matters."""

    def __init__(self, model: ArmModel) -> None:
        self.model, self.arm = model, None


@pytest.mark.parametrize(("gear_is_tried", "taken"), [(True, "wrist: stribeck"), (False, "wrist: torque_delay")])
def test_no_joint_is_late_where_a_gear_that_is_none_would_explain_more(
    monkeypatch: pytest.MonkeyPatch, gear_is_tried: bool, taken: str
) -> None:
    """A torso without gravity, whose load bounces between teeth, had three late joints in the arms on it."""

    def propose(arm: object, model: ArmModel) -> Iterator[tuple[str, ArmModel]]:
        if gear_is_tried:
            yield "torso: backlash", ArmModel((JointForm().with_term("backlash", 0), JointForm()))
        for name in ("torque_delay", "stribeck"):
            yield f"wrist: {name}", ArmModel((JointForm(), JointForm().with_term(name, 0)))

    def weigh(glance: object, model: ArmModel, other: ArmModel) -> float:
        return _GAINS[_list_added(other, model)[0][1]]

    def is_possible(one: _Fit, before: _Fit) -> bool:
        return _list_added(one.model, before.model)[0][1] != "backlash"

    stubs = {
        "Glance": lambda *_: None,
        "EarlyTorques": lambda *_: SimpleNamespace(shows=lambda *_, **__: False),
        "propose_models": propose,
        "_weigh": weigh,
        "fit_arm": lambda arm, equations, model, prior, fit, steps: _Fit(model),
        "is_physical": lambda *_: True,
        "_is_possible": is_possible,
        "_is_torn": lambda *_: False,
    }
    for name, stub in stubs.items():
        monkeypatch.setattr(identification, name, stub)
    nothing = cast(Any, None)
    tried = _try_out(nothing, nothing, cast(Any, _Fit(_PLAIN)), nothing, {}, frozenset())
    assert [name for name, _ in tried] == [taken]


@pytest.mark.parametrize("terms", [("torque_delay", "joint_elasticity"), ("torque_delay",)])
def test_a_torque_is_taken_as_early_as_it_is_before_its_gear_is_weighed(
    monkeypatch: pytest.MonkeyPatch, terms: tuple[str, ...]
) -> None:
    """A wrist that was 6 ms late had a gear for the curvature of its torque, which a term linear in a delay leaves."""
    form, taken = JointForm(tuple((name, 0) for name in terms)), []

    class Weighed(Exception):
        """What was fitted is weighed."""

    def refine(rows: object, equations: object, fit: _Fit, prior: object) -> tuple[_Fit, object]:
        taken.append(fit)
        return fit, equations

    def weigh(*_: object) -> None:
        raise Weighed

    monkeypatch.setattr(answer, "refine_delays", refine)
    monkeypatch.setattr(answer, "widen_covariance", weigh)
    found = SimpleNamespace(fit=_Fit(ArmModel((form,))), rows=None, equations=None, prior=None)
    with pytest.raises(Weighed):
        confirm_terms(cast(Any, found))
    assert len(taken) == len(terms) - 1
