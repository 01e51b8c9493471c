"""The noise beside a ripple: measured where the ripple is known, and left as it was where nothing is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.effects.structure import N_BASE, Candidate, Structure
from fricomp.diagnosis.inputs.rigid import RigidJoint
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.search.again import late_noise
from fricomp.diagnosis.search.again.late_noise import remeasure_noise
from fricomp.diagnosis.search.preparation import Baseline, prepare
from fricomp.diagnosis.search.refit import fit_from
from fricomp.diagnosis.search.search import search
from fricomp.diagnosis.search.settings import SEARCH

from ..known import known_baseline, known_fit, known_search
from ..toy_joint import ToyJoint, recording

_DETENT = (0.9, 50.0)


def _prepare(joint: ToyJoint) -> Baseline:
    tracks = build_tracks([recording(joint, "fourier", 24.0, 5)], [None])
    return prepare(tracks, observer=Observer(), nulls=12, seed=0)


def _measure_noise(baseline: Baseline) -> float:
    return float(np.median(np.concatenate(baseline.nulls.weights.spread)))


@pytest.mark.slow
def test_noise_beside_a_ripple_is_that_of_the_joint_without_it() -> None:
    plain = _prepare(ToyJoint(load_coulomb=0.08))
    rippled = _prepare(ToyJoint(load_coulomb=0.08, cogging=_DETENT))
    noise = _measure_noise(plain)
    assert _measure_noise(rippled) > 2.0 * noise
    quieter = remeasure_noise(rippled, search(rippled), seed=0)
    assert quieter is not None
    assert _measure_noise(quieter) == pytest.approx(noise, rel=0.35)
    assert remeasure_noise(plain, search(plain), seed=0) is None


@pytest.mark.slow
def test_two_effects_are_weighed_by_the_noise_beside_them_however_little_is_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By that of the base alone the second one would hardly count."""
    monkeypatch.setattr(late_noise, "SEARCH", replace(SEARCH, something_left=np.inf))
    rippled = _prepare(ToyJoint(quadratic_drag=0.5, cogging=_DETENT))
    found = search(rippled)
    assert found.best is not None
    both = Structure(found.best.structure.contexts, (*found.best.settled, Candidate("quadratic_drag", ())))
    (pair,) = fit_from(rippled, [(both, found.best.fit.theta[:N_BASE])], found.best.box)
    assert remeasure_noise(rippled, found, seed=0) is None
    given = RigidJoint(0.35, (0.0, 6.0), 0.0, 0.0, 0.0, True)  # inertia and gravity are weighed as well
    assert remeasure_noise(replace(rippled, rigid=given), found, seed=0) is not None
    quieter = remeasure_noise(rippled, replace(found, best=pair), seed=0)
    assert quieter is not None
    assert _measure_noise(quieter) < 0.2 * _measure_noise(rippled)


def test_the_noise_stays_where_a_joint_does_not_simulate_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def run_away(*_: object) -> None:
        raise FloatingPointError("runs away")

    monkeypatch.setattr(late_noise, "rebuild", lambda _, one: one.settled_structure)
    monkeypatch.setattr(late_noise, "weigh_by_nulls", run_away)
    monkeypatch.setattr(Baseline, "measure_typical_loudness", lambda *_: 0.0)
    baseline = known_baseline()
    best = known_fit(baseline, ("cogging",), 900.0)
    assert remeasure_noise(baseline, known_search(best), seed=0) is None
