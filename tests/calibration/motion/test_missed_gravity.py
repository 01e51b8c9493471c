"""Gravity that acts is fitted and told; where it is left out, the friction that would hold it is not usable."""

from __future__ import annotations

import numpy as np
import pytest

import fricomp
from fricomp.errors import IdentificationError
from fricomp.recording import Recording
from fricomp.sim_bench.studies.logs.good_log import COULOMB, VISCOUS, joint_log


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


_SMALL = ((0.05, 0.4), (0.03, 1.1), (0.01, 2.3))
"""Amplitudes [rad] and frequencies [Hz] of a reference over so small an angle that gravity is nearly constant."""


@pytest.mark.parametrize(("size", "angle", "seed"), [(0.15, -1.4, 4), (0.25, 1.8, 5)])
def test_gravity_that_a_small_angle_makes_constant_is_no_friction_of_one_direction(
    size: float, angle: float, seed: int
) -> None:
    log = _weigh(joint_log(20.0, 500.0, seed, _SMALL), size, angle)
    found = fricomp.identify(log, law="asymmetric_coulomb_viscous")
    forward, reverse = (abs(float(found.model.torque(sign * 0.3))) for sign in (1.0, -1.0))
    assert forward == pytest.approx(COULOMB + 0.3 * VISCOUS, rel=0.03)
    assert reverse == pytest.approx(forward, rel=0.03)
    (told,) = (note for note in found.notes if "may be gravity" in note)
    assert told.endswith("or say gravity=False where no gravity acts.")
    without = fricomp.identify(log, law="asymmetric_coulomb_viscous", gravity=False)
    uneven = float(without.model.torque(0.3) + without.model.torque(-0.3)) / 2
    assert abs(uneven) == pytest.approx(size * abs(np.sin(angle)), rel=0.2)


_WIDE = ((0.4, 0.35), (0.25, 0.9), (0.1, 2.1))
"""The same over an angle that tells gravity from a constant torque."""


def _bend(log: Recording, size: float) -> Recording:
    """The log with a Stribeck effect, which a fit of Coulomb and viscous friction leaves."""
    velocity = np.gradient(log.position, log.time)
    return log.with_channels(torque=log.torque + size * np.sign(velocity) * np.exp(-((velocity / 0.4) ** 2)))


@pytest.mark.parametrize(("size", "angle", "seed"), [(0.3, 0.9, 4), (0.25, -1.0, 5), (0.2, 2.2, 6)])
def test_gravity_beside_friction_that_bends_is_no_friction_of_one_direction(
    size: float, angle: float, seed: int
) -> None:
    found = fricomp.identify(_bend(_weigh(joint_log(20.0, 500.0, seed, _WIDE), size, angle), 0.25))
    assert found.motion is not None
    assert np.hypot(*found.motion.rigid_body.gravity) == pytest.approx(size, rel=0.15)
    assert float(found.model.torque(1.2) + found.model.torque(-1.2)) == pytest.approx(0.0, abs=0.1 * COULOMB)


@pytest.mark.parametrize("seed", [4, 5, 6])
def test_friction_that_bends_and_differs_between_the_directions_is_no_gravity(seed: int) -> None:
    log = _bend(joint_log(20.0, 500.0, seed, _WIDE), 0.25)
    found = fricomp.identify(log.with_channels(torque=log.torque + 0.1))
    assert found.motion is not None
    assert not any(found.motion.rigid_body.gravity)


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
