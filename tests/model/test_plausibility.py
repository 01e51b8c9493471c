"""The floor of every model: what no joint can be like is told, and what one can be like is not."""

import numpy as np
import pytest

from fricomp.laws import Coulomb, FrictionLaw, Viscous
from fricomp.model import FrictionModel
from fricomp.model.plausibility import find_impossible

_SPEEDS = np.linspace(-2.0, 2.0, 41)


def _model(coulomb: float, viscous: float) -> FrictionModel:
    return FrictionModel(law=FrictionLaw((Coulomb(coulomb), Viscous(viscous))), joint="elbow")


def test_a_joint_with_friction_and_inertia_can_be() -> None:
    assert find_impossible(_model(0.4, 0.1), _SPEEDS, (0.03, 0.001)) is None


def test_an_inertia_below_zero_by_chance_can_be() -> None:
    assert find_impossible(_model(0.4, 0.1), _SPEEDS, (-0.001, 0.001)) is None


@pytest.mark.parametrize("inertia", [-0.03, -5.0])
def test_a_negative_inertia_cannot_be(inertia: float) -> None:
    reason = find_impossible(_model(0.4, 0.1), _SPEEDS, (inertia, 0.001))
    assert reason is not None
    assert "negative" in reason


def test_a_model_without_friction_drives_nothing() -> None:
    assert find_impossible(_model(0.0, 0.0), _SPEEDS) is None
