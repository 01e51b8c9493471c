"""Settings of training simulators: they load as what they are, and say the model's own numbers."""

from __future__ import annotations

import ast
import re
from dataclasses import replace

import numpy as np
import pytest

from fricomp.errors import ExportError
from fricomp.export import TRAINING_FORMATS, FrictionLevels, fit_friction_levels, render_training
from fricomp.laws import Coulomb, FrictionLaw, Viscous

from .models import make_model

yaml = pytest.importorskip("yaml")


def plain_levels(joint: str = "elbow") -> FrictionLevels:
    """Levels of a joint that has nothing but 0.3 N·m and 0.1 N·m·s/rad."""
    model = replace(make_model(), joint=joint).with_law(FrictionLaw((Coulomb(0.3), Viscous(0.1))))
    return fit_friction_levels(model)


def load_python(text: str) -> object:
    """The value of FRICTION, by Python's own parser."""
    (assignment,) = ast.parse(text).body
    assert isinstance(assignment, ast.Assign)
    return ast.literal_eval(assignment.value)


def find_texts(value: object) -> set[str]:
    """Every text in nested containers."""
    if isinstance(value, dict):
        return {text for pair in value.items() for each in pair for text in find_texts(each)}
    if isinstance(value, list | tuple):
        return {text for each in value for text in find_texts(each)}
    return {value} if isinstance(value, str) else set()


def test_a_level_and_a_slope_come_back_as_they_are() -> None:
    levels = plain_levels()
    assert [levels.static, levels.sliding, levels.viscous] == pytest.approx([0.3, 0.3, 0.1], rel=1e-3)
    assert levels.fidelity.relative_rms < 1e-6


def test_what_holds_at_rest_is_more_than_what_slides() -> None:
    model = make_model()
    levels = fit_friction_levels(model)
    breakaway = np.mean(np.abs(np.asarray(model.torque(np.array([-1e-4, 1e-4])))))
    assert levels.static == pytest.approx(breakaway, rel=0.02)
    assert levels.static > levels.sliding


def test_isaaclab_has_the_level_at_rest_and_that_of_sliding_by_joint() -> None:
    levels = [plain_levels("hip"), fit_friction_levels(make_model())]
    friction = load_python(render_training(levels, "isaaclab"))
    assert isinstance(friction, dict)
    assert set(friction) == {"friction", "dynamic_friction", "viscous_friction"}
    assert friction["friction"][make_model().joint] == pytest.approx(levels[1].static)
    assert friction["viscous_friction"]["hip"] == pytest.approx(0.1, rel=1e-3)


def test_mjlab_matches_one_joint_and_no_other() -> None:
    groups = load_python(render_training([plain_levels("knee.1")], "mjlab"))
    assert isinstance(groups, tuple)
    (group,) = groups
    assert re.fullmatch(group["target_names_expr"][0], "knee.1")
    assert not re.fullmatch(group["target_names_expr"][0], "knee_1")
    assert group["frictionloss"] == pytest.approx(0.3, rel=1e-3)


def test_newton_takes_them_as_arguments_of_a_degree_of_freedom() -> None:
    assert load_python(render_training([plain_levels()], "newton")) == {
        "elbow": {"friction": pytest.approx(0.3, rel=1e-3), "damping": pytest.approx(0.1, rel=1e-3)}
    }


def test_parameters_of_ros_are_yaml() -> None:
    loaded = yaml.safe_load(render_training([plain_levels()], "ros2"))["friction_compensation"]["ros__parameters"]
    assert loaded["joints"] == ["elbow"]
    assert loaded["elbow"]["viscous"] == pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize("to", TRAINING_FORMATS)
def test_a_name_of_a_joint_is_never_code(to: str) -> None:
    name = "elbow'\n}; import os\u2028#\""
    text = render_training([plain_levels(name)], to)
    loaded = yaml.safe_load(text) if to == "ros2" else load_python(text)
    assert name in find_texts(loaded) or re.escape(name) in find_texts(loaded)


def test_a_model_in_amperes_is_refused() -> None:
    with pytest.raises(ExportError, match="in A, a simulator takes N·m"):
        fit_friction_levels(replace(make_model(), torque_unit="A"))
