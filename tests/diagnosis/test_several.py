"""Several recordings of one joint: what differs between them belongs to the physics that is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis import diagnose
from fricomp.recording import Recording

from .toy_joint import ToyJoint, recording

pytestmark = pytest.mark.slow


def test_a_cold_and_a_warm_recording_show_what_neither_shows_alone() -> None:
    """Each stays at its own temperature; the law is exp(-0.02 dT), 18 K apart."""
    recordings = []
    for seed, temperature in enumerate((22.0, 40.0)):
        thinner = float(np.exp(-0.02 * (temperature - 31.0)))
        curves = [(2.0, 2.6, 0.05, 1.2 * thinner)] * 2
        joint = ToyJoint(forward=curves[0], reverse=curves[1])
        one = recording(joint, "fourier", 15.0, seed=seed, every=2)
        warmth = np.full(len(one), temperature)
        recordings.append(Recording(one.time, one.position, one.torque, temperature=warmth))
    diagnosis = diagnose(recordings)
    assert [effect.name for effect in diagnosis.effects] == ["thermal_friction"], diagnosis.sentences
    low, high = diagnosis.effects[0].parameters["viscous_slope"].ci95
    assert low <= 0.02 * 1.2 <= high


def test_friction_under_load_feels_the_payload_of_each_recording() -> None:
    joint = ToyJoint(load_coulomb=0.1)
    heavier = replace(joint, inertia=0.42, gravity=8.5)
    recordings = [recording(joint, "fourier", 15.0, every=2), recording(heavier, "fourier", 15.0, seed=3, every=2)]
    diagnosis = diagnose(recordings)
    assert {effect.name for effect in diagnosis.effects} == {"payload_error", "load_coulomb"}, diagnosis.sentences
    found = {effect.name: effect.parameters for effect in diagnosis.effects}
    assert found["load_coulomb"]["coefficient"].value == pytest.approx(0.1, rel=0.1)
    assert found["payload_error"]["gravity_sin_2"].value == pytest.approx(2.5 * np.cos(joint.phase), rel=0.03)
    assert found["payload_error"]["inertia_2"].value == pytest.approx(0.07, rel=0.1)
