"""Choices that are made again on parts of the rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.evidence.repetition import Repetitions, _Trial, draw_parts, refit_parts, repeat_choice
from fricomp.diagnosis.evidence.settings import REPETITIONS
from fricomp.diagnosis.evidence.trial import put_to_trial
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.search.preparation import Baseline, prepare
from fricomp.diagnosis.search.search import SearchResult, search

from ..toy_joint import ToyJoint, recording


@pytest.fixture(scope="module")
def loaded() -> tuple[Baseline, SearchResult]:
    baseline = prepare(
        build_tracks([recording(ToyJoint(load_coulomb=0.1), "fourier", 20.0)]), observer=Observer(), nulls=12, seed=0
    )
    return baseline, search(baseline)


@pytest.mark.slow
def test_an_effect_that_is_there_comes_again(loaded: tuple[Baseline, SearchResult]) -> None:
    again = repeat_choice(*loaded)
    assert again.count == REPETITIONS.blocks + REPETITIONS.cuts
    assert again.compute_share("load_coulomb") >= 0.9
    assert again.nothing == 0


@pytest.mark.slow
def test_the_same_recording_gives_the_same_shares(loaded: tuple[Baseline, SearchResult]) -> None:
    assert repeat_choice(*loaded) == repeat_choice(*loaded)


@pytest.mark.slow
def test_each_part_leaves_out_a_fifth(loaded: tuple[Baseline, SearchResult]) -> None:
    parts = [rows for rows, _ in draw_parts(loaded[0])]
    assert all(abs(np.mean(~rows) - REPETITIONS.left_out) < 0.06 for rows in parts)
    assert not parts[REPETITIONS.blocks][0]  # the first cut leaves out the start
    assert not parts[-1][-1]  # and the last one the end


@pytest.mark.slow
def test_refits_to_parts_stray_about_the_whole(loaded: tuple[Baseline, SearchResult]) -> None:
    baseline, found = loaded
    assert found.best is not None
    at = found.best.fit.theta.size - found.best.structure.build_start().size
    values = np.array([joint.fit.theta[at] for joint in refit_parts(baseline, found.best)])
    assert abs(np.mean(values) - found.best.fit.theta[at]) < 0.05 * found.best.fit.theta[at]
    assert np.std(values) > 0.0


@pytest.mark.slow
def test_the_trial_tells_the_repetitions(loaded: tuple[Baseline, SearchResult]) -> None:
    trial = put_to_trial(*loaded, 0)
    assert trial.chosen is not None
    assert trial.chosen.names == ("load_coulomb",)
    assert trial.objections == {}


@pytest.mark.slow
def test_parts_without_what_is_met_once_do_not_count_against_it(loaded: tuple[Baseline, SearchResult]) -> None:
    """Rows that the effects do not reach say nothing of them; where all effects act, every part counts."""
    baseline, found = loaded
    trial = _Trial(baseline, found)
    assert found.best is not None
    reach = np.abs(trial.compute_reach(trial.explanations.index(found.best)))
    unreached = reach <= np.quantile(reach, 0.05)
    assert not trial.is_reached(unreached)
    assert all(trial.is_reached(rows) for rows, _ in draw_parts(baseline))
    assert trial.is_reached(~unreached, *found.best.names)
    assert repeat_choice(*loaded).unmet == {"load_coulomb": 0}
    assert _Trial(baseline, replace(found, best=None)).is_reached(unreached)


def test_shares_count_sets_and_names() -> None:
    some = Repetitions(10, {("a",): 4, ("a", "b"): 5}, nothing=1)
    assert some.shares == {"a": 0.9, "b": 0.5}
    assert some.compute_share("a", "b") == 0.5
    assert some.compute_share_of_any(("b", "c")) == 0.5


def test_parts_in_which_one_of_two_effects_does_not_act_do_not_count_against_it() -> None:
    """A stop that was hit twice, beside a friction that acts everywhere: without its rows friction alone is right."""
    both = Repetitions(60, {("end_stop", "load_coulomb"): 46, ("load_coulomb",): 12}, unknown=2, unmet={"end_stop": 11})
    assert both.compute_share_of_any(("end_stop", "spring_torque")) == pytest.approx(46 / 49)
    assert both.compute_share("load_coulomb") == pytest.approx(58 / 60)
