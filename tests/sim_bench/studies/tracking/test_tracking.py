"""Tracking on the stand-in: compensation pays, by as much as is claimed."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.sim_bench.studies.tracking import (
    JOINTS,
    Method,
    TrackingCase,
    compute_robustness,
    run_case,
    run_standstill,
)


def changes(joint: str, method: Method, bandwidth: float) -> tuple[float, float]:
    case = TrackingCase(JOINTS[joint], method, 0.2, bandwidth, frequency=0.2)
    none = run_case(TrackingCase(JOINTS[joint], "none", 0.2, bandwidth, frequency=0.2))
    found = run_case(case)
    return found.rms / none.rms - 1.0, found.reversal_rms / none.reversal_rms - 1.0


def test_moderate_joint_tracks_far_better() -> None:
    rms, reversal = changes("moderate", "default", 5.0)
    assert rms <= -0.85
    assert reversal <= -0.80


@pytest.mark.slow
def test_strongly_falling_joint_tracks_better_than_with_coulomb_viscous() -> None:
    ours, rival = changes("table_i", "default", 5.0), changes("table_i", "coulomb_viscous", 5.0)
    assert ours[0] < rival[0] - 0.2
    assert ours[1] < rival[1] - 0.2


@pytest.mark.parametrize("joint", list(JOINTS))
def test_standing_joint_does_not_drift(joint: str) -> None:
    assert run_standstill(TrackingCase(JOINTS[joint], "default", 0.2, 5.0), 1.0) < 2.0 * np.pi / 2**18


@pytest.mark.slow
def test_map_agrees_with_the_stand_in_where_both_were_run() -> None:
    found = compute_robustness(JOINTS["moderate"], 5.0, gain=(0.95,), scale=(1.0, 1.3), delay=(0.001,))
    for index, scale in enumerate(found.scale):
        cases = [
            TrackingCase(JOINTS["moderate"], m, 0.5, 5.0, friction_scale=float(scale)) for m in ("none", "default")
        ]
        none, default = (run_case(case).rms for case in cases)
        assert found.ours[0, index, 0] == pytest.approx(default / none - 1.0, abs=0.08)
