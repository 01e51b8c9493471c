"""Gravity that acts and was not asked for is told, and the friction that would hold it is not given as usable."""

from __future__ import annotations

import numpy as np
import pytest

import fricomp
from fricomp.recording import Recording
from fricomp.sim_bench.studies.logs.good_log import COULOMB, joint_log


def _weigh(log: Recording, size: float, angle: float) -> Recording:
    return log.with_channels(torque=log.torque + size * np.sin(log.position - angle))


@pytest.mark.parametrize(("size", "angle", "seed"), [(3.0, 0.2, 1), (0.8, -1.0, 2)])
def test_gravity_that_was_not_asked_for_is_told_and_mended_by_the_option(size: float, angle: float, seed: int) -> None:
    log = _weigh(joint_log(20.0, 250.0, seed), size, angle)
    without = fricomp.identify(log, law="coulomb_viscous")
    assert not without.is_usable
    assert without.result.message.endswith("say gravity")
    found = fricomp.identify(log, law="coulomb_viscous", gravity=True)
    assert found.is_usable
    assert found.parameters["coulomb.coulomb_torque"] == pytest.approx(COULOMB, rel=0.02)


def test_a_joint_without_gravity_is_asked_nothing() -> None:
    assert fricomp.identify(joint_log(20.0, 250.0, 3), law="coulomb_viscous").is_usable
