"""Joints drawn at random, identified from a recorded motion."""

import numpy as np
import pytest

from fricomp.sim_bench.studies.identification.motions import draw_joint, study_motions


def test_a_seed_draws_the_same_joint_again() -> None:
    first, again, other = (draw_joint(np.random.default_rng(seed)) for seed in (3, 3, 4))
    assert first.law == again.law
    assert first.law != other.law


@pytest.mark.slow
def test_intervals_from_recorded_motions_hold_the_truth() -> None:
    study = study_motions(range(100, 106))
    assert len(study.all.statuses) == 6
    assert len(study.usable.statuses) >= 2
    held = [score.held for score in study.usable.scores]
    assert sum(held) >= 0.8 * len(held)
