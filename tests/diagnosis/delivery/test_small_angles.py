"""Over a small angle a constant torque cancels with gravity: what the curves of both directions make of that."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis import diagnose
from fricomp.model import FrictionModel
from tests.diagnosis.toy_joint import ToyJoint, recording

pytestmark = pytest.mark.slow

SPEEDS = np.array([0.2, 0.4, 0.8])


def _diagnose(kind: str, offset: float, seed: int) -> FrictionModel:
    """Friction of a joint that is the same in both directions, beside a constant torque."""
    curve = (2.0, 2.6, 0.05, 1.1)
    joint = ToyJoint(gravity=9.0, offset=offset, forward=curve, reverse=curve, gains=(2500.0, 50.0))
    model = diagnose(recording(joint, kind, 30.0, seed, every=2)).base_model
    assert model is not None
    return model


def _split(model: FrictionModel) -> tuple[float, float]:
    """Half the difference of the directions, and their mean."""
    forward, reverse = (np.asarray(model.torque(sign * SPEEDS)) for sign in (1.0, -1.0))
    return float(np.mean(forward + reverse)) / 2, float(np.mean(forward - reverse)) / 2


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_what_cancels_with_gravity_stays_beside_it(seed: int) -> None:
    uneven, friction = _split(_diagnose("small", 0.0, seed))
    assert uneven == pytest.approx(0.0, abs=0.1)
    assert friction == pytest.approx(2.0 + 1.1 * float(np.mean(SPEEDS)), rel=0.03)


@pytest.mark.parametrize("offset", [0.3, -0.7])
def test_a_constant_torque_that_a_wide_motion_shows_is_in_the_curves(offset: float) -> None:
    uneven, friction = _split(_diagnose("fourier", offset, 1))
    assert uneven == pytest.approx(offset, abs=0.05)
    assert friction == pytest.approx(2.0 + 1.1 * float(np.mean(SPEEDS)), rel=0.03)
