"""What bends over the speed is asked for again where another Stribeck curve stands in its place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import ArmExamination, examine_arm
from fricomp.arm.answer import confirm_terms
from fricomp.arm.equations import ArmEquations
from fricomp.arm.fit import ArmFit, fit_arm
from fricomp.arm.friction import TERMS, JointForm
from fricomp.arm.glance import Glance
from fricomp.arm.identification import EVIDENCE
from fricomp.arm.search.bend import find_bend
from fricomp.arm.search.stribeck import hold_curve, is_at_end, is_curve
from fricomp.laws import FloatArray

from .moving_arm import record_arm, write_arm

_JOINT, _WIDE = 1, 9
_DRAG = 0.25
"""[N·m·s²/rad²]"""


def drag_beside_a_curve(joint: int, _: FloatArray, v: FloatArray, __: FloatArray) -> FloatArray:
    return np.asarray((0.3 * np.exp(-((v / 0.08) ** 2)) * np.sign(v) + _DRAG * v * np.abs(v)) * (joint == _JOINT))


def fall(joint: int, _: FloatArray, v: FloatArray, __: FloatArray) -> FloatArray:
    return np.asarray(0.4 * np.exp(-((v / 0.3) ** 2)) * np.sign(v) * (joint == _JOINT))


@pytest.fixture(scope="module")
def dragged(tmp_path_factory: pytest.TempPathFactory) -> ArmExamination:
    simulation = write_arm(tmp_path_factory.mktemp("dragged"))
    return examine_arm(record_arm(simulation, drag_beside_a_curve), simulation)


def put_curve_alone(found: ArmExamination) -> ArmFit:
    """The fit with a wide curve in place of all friction of the joint beside Coulomb and viscous, as it is left when
    friction that creeps goes that was taken in beside it."""
    one = found.answer.identification
    forms = list(one.fit.model.forms)
    forms[_JOINT] = JointForm((("stribeck", _WIDE),))
    model = hold_curve(replace(one.fit.model, forms=tuple(forms)), _JOINT)
    return fit_arm(one.fit.arm, one.equations, model, one.prior, one.fit)


def test_a_drag_is_asked_for_again_where_a_curve_that_is_none_stands_in_its_place(dragged: ArmExamination) -> None:
    """A drag of 1.7 times the noise had no name: beside the curve friction that creeps had been taken in, and left."""
    found = dragged.answer.identification
    fit = put_curve_alone(dragged)
    assert not is_curve(fit, _JOINT)
    bend = find_bend(Glance(found.equations, fit, found.prior), fit, _JOINT)
    assert bend is not None
    assert (bend.term, bend.model.forms[_JOINT].names[-1]) == ("quadratic_drag", "quadratic_drag")
    assert bend.gain > 50.0
    answer = confirm_terms(replace(found, fit=fit, trials={}))
    assert answer.list_named(_JOINT) == ("quadratic_drag",)
    assert answer.evidence[_JOINT, "quadratic_drag"].log_bayes_factor > 50.0
    value = answer.identification.fit.friction(_JOINT)["quadratic_drag.coefficient.0"]
    assert value == pytest.approx(_DRAG, rel=0.05)


def test_a_joint_with_a_curve_that_is_one_asks_for_no_bend(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    found = examine_arm(record_arm(simulation, fall), simulation).answer.identification
    assert "stribeck" in found.fit.model.forms[_JOINT].names
    glance = Glance(found.equations, found.fit, found.prior)
    bends = [find_bend(glance, found.fit, joint) for joint in range(3)]
    assert all(bend is None or bend.gain < EVIDENCE for bend in bends)


def test_a_curve_may_be_pressed_against_its_end(dragged: ArmExamination) -> None:
    """A drag that is weighed against one on held-out data seems to be nothing."""
    found = dragged.answer.identification
    fit, equations = put_curve_alone(dragged), found.equations
    place, _ = fit.find_friction(_JOINT)
    names = fit.find_friction(_JOINT)[1]

    def fall_by(part: float) -> ArmFit:
        x = fit.x.copy()
        x[place.start + names.index("coulomb")] = 2.0
        x[place.start + names.index(TERMS["stribeck"].names(_WIDE)[0])] = 2.0 * part
        return replace(fit, x=x)

    def fall_until(part: float) -> ArmEquations:
        curves = equations.stribeck.copy()
        curves[_JOINT, _WIDE] = part * equations.top_speed[_JOINT], 1.0
        return equations.with_stribeck(found.rows, curves)

    assert is_at_end(fall_until(0.3), fall_by(0.99), _JOINT)
    assert is_at_end(fall_until(0.6), fall_by(0.5), _JOINT)
    assert not is_at_end(fall_until(0.3), fall_by(0.5), _JOINT)
