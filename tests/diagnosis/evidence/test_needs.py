"""What a name needs: numbers that are not those of its absence, and no end of a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricomp.diagnosis.effects.structure import N_BASE, Candidate, Structure
from fricomp.diagnosis.evidence.needs import list_objections
from fricomp.diagnosis.evidence.refitted import RefittedJoint

from ..known import known_baseline, known_fit


def _refitted(name: str, deviation: float, **values: float) -> RefittedJoint:
    """A base with one effect, whose numbers are known to a deviation."""
    baseline = known_baseline()
    structure = Structure(baseline.structure.contexts, (Candidate(name, tuple(values.items())),))
    one = replace(known_fit(baseline, [name], 100.0), structure=structure)
    theta = np.concatenate([baseline.fit.theta, structure.build_start()])
    fit = replace(one.fit, theta=theta, jacobian=np.zeros((baseline.fit.residual.size, theta.size)))
    covariance = np.diag(np.concatenate([np.zeros(N_BASE), np.full(theta.size - N_BASE, deviation**2)]))
    return RefittedJoint(structure, fit, covariance)


def test_a_size_whose_interval_holds_zero_is_no_name() -> None:
    assert "holds zero" in list_objections(_refitted("load_coulomb", 0.1, coefficient=0.1))["load_coulomb"]
    assert list_objections(_refitted("load_coulomb", 0.02, coefficient=0.1)) == {}


def test_both_parts_of_a_wave_are_judged_together() -> None:
    assert list_objections(_refitted("cogging", 0.1, sine=0.2, cosine=0.2, order=40.0)) == {}
    assert list_objections(_refitted("cogging", 0.1, sine=0.15, cosine=0.1, order=40.0))


def test_an_exponent_near_that_of_the_base_is_no_name() -> None:
    assert list_objections(_refitted("stribeck_shape", 0.2, stribeck_exponent=2.3))
    assert list_objections(_refitted("stribeck_shape", 0.05, stribeck_exponent=1.0)) == {}


def test_a_number_at_the_end_of_the_search_is_no_name() -> None:
    at_end = list_objections(_refitted("stribeck_shape", 0.01, stribeck_exponent=0.4))
    assert "end of what is looked for" in at_end["stribeck_shape"]
    softest = list_objections(_refitted("presliding_hysteresis", 0.01, breakaway_distance=np.log(5e-2)))
    assert "breakaway distance" in softest["presliding_hysteresis"]
