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
    # One model has one gravity and one inertia: fitted to both loads, its friction had made up for the difference.
    model, plain = diagnosis.base_model, light.forward
    assert model is not None
    assert model.dynamics is not None
    assert model.dynamics.gravity_sine == pytest.approx(6.0 * np.cos(0.3), rel=0.02)
    assert model.dynamics.inertia == pytest.approx(0.35, rel=0.02)
    curve = model.law.parameters()
    assert curve["stribeck.forward.coulomb_torque"] == pytest.approx(plain[0] + light.offset, rel=0.04)
    assert curve["stribeck.reverse.coulomb_torque"] == pytest.approx(light.reverse[0] - light.offset, rel=0.04)
    assert diagnosis.record.errors is not None
    assert diagnosis.record.errors.file.torque.rms < 0.05
    assert not any("simulation" in one for one in diagnosis.record.summary)
    assert any("as loaded in recording 1" in one for one in diagnosis.record.summary)
