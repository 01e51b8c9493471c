"""A spring that pulls at a joint is told, and friction that holds a part of it is not usable."""

from __future__ import annotations

import numpy as np
import pytest

import fricomp
from fricomp.recording import Recording
from fricomp.sim_bench.studies.logs.good_log import joint_log


def _pull(log: Recording, stiffness: float, *, weight: float = 0.0) -> Recording:
    position = np.asarray(log.position)
    return log.with_channels(torque=np.asarray(log.torque) + stiffness * (position - 0.3) + weight * np.sin(position))


@pytest.mark.parametrize(("stiffness", "weight", "seed"), [(1.5, 0.0, 1), (-0.8, 0.0, 2), (4.0, 2.0, 3)])
def test_a_spring_is_told_with_its_stiffness(stiffness: float, weight: float, seed: int) -> None:
    found = fricomp.identify(
        _pull(joint_log(20.0, 250.0, seed), stiffness, weight=weight), law="coulomb_viscous", gravity=weight > 0.0
    )
    assert not found.is_usable
    told = found.result.message.split("like a spring of ")[1]
    assert float(told.split()[0]) == pytest.approx(stiffness, rel=0.05)


def test_a_joint_without_a_spring_is_told_none() -> None:
    found = fricomp.identify(joint_log(20.0, 250.0, 4), law="coulomb_viscous")
    assert found.is_usable
    assert "spring" not in found.result.message
