"""Two recordings of one joint with different loads: gravity and inertia differ by the load."""

import numpy as np
import pytest

from fricomp.diagnosis import diagnose

from .toy_joint import ToyJoint, recording


@pytest.mark.slow
def test_two_recordings_of_one_joint_with_different_loads() -> None:
    light, heavy = ToyJoint(), ToyJoint(gravity=8.0, inertia=0.42)
    diagnosis = diagnose([recording(light, "fourier", 20.0, 1, every=2), recording(heavy, "fourier", 20.0, 2, every=2)])
    assert diagnosis.verdict == "parameters"
    assert [effect.name for effect in diagnosis.effects] == ["payload_error"]
    found = {name: one.value for name, one in diagnosis.effects[0].parameters.items()}
    assert found["gravity_sin_2"] == pytest.approx(2.0 * np.cos(0.3), rel=0.03)
    assert found["gravity_cos_2"] == pytest.approx(2.0 * np.sin(0.3), rel=0.1)
    assert found["inertia_2"] == pytest.approx(0.07, rel=0.1)
