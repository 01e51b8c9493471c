"""Gravity that acts is fitted and told; where it is left out, the friction that would hold it is not usable."""

from __future__ import annotations

import numpy as np
import pytest

import fricomp
from fricomp.errors import IdentificationError
from fricomp.recording import Recording
from fricomp.sim_bench.studies.logs.good_log import COULOMB, joint_log


def _weigh(log: Recording, size: float, angle: float) -> Recording:
    return log.with_channels(torque=log.torque + size * np.sin(log.position - angle))


@pytest.mark.parametrize(("size", "angle", "seed"), [(3.0, 0.2, 1), (0.8, -1.0, 2)])
def test_gravity_that_acts_is_fitted_and_told(size: float, angle: float, seed: int) -> None:
    log = _weigh(joint_log(20.0, 250.0, seed), size, angle)
    found = fricomp.identify(log, law="coulomb_viscous")
    assert found.is_usable
    assert found.parameters["coulomb.coulomb_torque"] == pytest.approx(COULOMB, rel=0.02)
    (told,) = (note for note in found.notes if note.startswith("Gravity is fitted"))
    assert told.endswith("gravity=False leaves it out.")
    assert found.parameters == fricomp.identify(log, law="coulomb_viscous", gravity=True).parameters


def test_friction_that_holds_gravity_is_not_usable() -> None:
    without = fricomp.identify(_weigh(joint_log(20.0, 250.0, 1), 3.0, 0.2), law="coulomb_viscous", gravity=False)
    assert not without.is_usable
    assert without.result.message.endswith("say gravity")


def test_a_joint_without_gravity_is_given_none() -> None:
    found = fricomp.identify(joint_log(20.0, 250.0, 3), law="coulomb_viscous")
    assert found.is_usable
    assert found.motion is not None
    assert not any(found.motion.rigid_body.gravity)


def test_a_joint_that_never_slides_for_long_is_refused_with_that_reason() -> None:
    time, rate = np.arange(0.0, 10.0, 0.002), 2.0 * np.pi * 24.0
    velocity = 0.05 * rate * np.cos(rate * time)
    torque = 0.3 * np.sign(velocity) - 0.001 * 0.05 * rate**2 * np.sin(rate * time)
    with pytest.raises(IdentificationError, match="0 slide in one direction for as long as the low-pass sees"):
        fricomp.identify(Recording(time, 0.05 * np.sin(rate * time), torque))
