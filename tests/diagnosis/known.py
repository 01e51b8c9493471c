"""Explanations, bases and cases that are known, for tests of what is made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricomp.diagnosis.effects.context import build_contexts
from fricomp.diagnosis.effects.structure import Candidate, Structure
from fricomp.diagnosis.evidence.case import Case
from fricomp.diagnosis.evidence.comparison import Comparison
from fricomp.diagnosis.evidence.confirmation import Confirmation
from fricomp.diagnosis.evidence.findings import Findings
from fricomp.diagnosis.evidence.location import collect_rows
from fricomp.diagnosis.evidence.refitted import RefittedJoint
from fricomp.diagnosis.evidence.trial import Trial
from fricomp.diagnosis.inputs.track import FloatArray, Track
from fricomp.diagnosis.joint.base import pack
from fricomp.diagnosis.joint.nulls import Nulls
from fricomp.diagnosis.joint.observer import Contribution, Job, Observer, Plant
from fricomp.diagnosis.joint.problem import Weights, build_problem
from fricomp.diagnosis.joint.solver import Box, Fit
from fricomp.diagnosis.record.result import Distinguishability, Quantity
from fricomp.diagnosis.search.explanation import Explanation
from fricomp.diagnosis.search.preparation import Baseline
from fricomp.diagnosis.search.screening import Screen
from fricomp.diagnosis.search.search import SearchResult
from fricomp.recording import Recording

_FAR = 5.0  # in units of a row's noise, by which effects reach a row unless it is said otherwise


@dataclass(frozen=True, eq=False)
class Known(Explanation):
    """An explanation whose effects reach each row by `reached`."""

    reached: FloatArray | None = None

    def compute_reach(self, baseline: Baseline) -> FloatArray:
        return np.full(self.fit.residual.size, _FAR) if self.reached is None else self.reached


def fit_of(residual: FloatArray) -> Fit:
    """A fit without parameters that leaves `residual`."""
    return Fit(np.zeros(0), residual, np.zeros((residual.size, 0)), float(residual @ residual))


def known(names: Sequence[str], gain: float, residual: FloatArray | None = None, **more: Any) -> Known:
    """An explanation by the effects `names`, all of whose gain is certain; `more` are its other attributes."""
    structure = Structure((), tuple(Candidate(name, ()) for name in names))
    fit = fit_of(np.zeros(1) if residual is None else residual)
    plain = Known(structure, fit, Structure((), ()).build_box(), gain, gain, 0.9)
    return replace(plain, **more)


PLANT = Plant(0.3, (1.0, 6.0), 0.0, (2.0, 2.6, 0.05, 1.0), (2.0, 2.6, 0.05, 1.0), 4e4)
"""A joint as the fits of these tests leave it."""


def known_search(
    *explanations: Explanation, best: bool = True, explainable: float = 0.0, null: float = 0.0
) -> SearchResult:
    """What a search found: these explanations, of which the first is the best unless none is; its threshold is 30."""
    return SearchResult(explanations, explanations[0] if best else None, 30.0, explainable, null, Screen(()))


def to_and_fro() -> Track:
    """Four seconds to and fro at 0.4 rad/s, two at rest, and four to and fro again."""
    t = np.arange(10_000) * 1e-3
    moving = (t < 4.0) | (t >= 6.0)
    position = np.cumsum(0.4 * np.sign(np.sin(2.0 * np.pi * 0.5 * t)) * moving) * 1e-3
    return Track.build(1e-3, position, np.zeros_like(t))


def known_baseline(track: Track | None = None, *, loudness: float = 1.0, structured: bool = False) -> Baseline:
    """A base without anything to fit, whose residual is everywhere so many times that of its nulls.

    Args:
        track: The recording; that of `to_and_fro` if not given.
        loudness: The ratio.
        structured: Whether its residual swings as no null does.
    """
    problem = build_problem([to_and_fro() if track is None else track], PLANT, Observer())
    seen = problem.observe([Job(problem.tracks[0], PLANT, Contribution())])
    structure, rows = Structure(tuple(build_contexts(problem, PLANT, seen, {}))), problem.grids[0].centres.size
    weights = Weights((np.zeros(rows),), (np.ones(rows),), np.ones(1))
    theta, residual = pack(PLANT), np.full(rows, loudness)
    size = theta.size
    box = Box(theta - 9.0, theta + 9.0, np.ones(size), theta, np.eye(size), np.ones(size))
    fit = Fit(theta, residual, np.zeros((rows, size)), float(residual @ residual))
    nulls = Nulls((np.ones((2, rows)),), weights)
    return Baseline(replace(problem, weights=weights), structure, fit, box, nulls, structured=structured)


def known_fit(baseline: Baseline, names: Sequence[str], gain: float, **more: Any) -> Explanation:
    """An explanation by the effects `names` that starts where they do, beside a base; `more` as in `known`."""
    structure = Structure(baseline.structure.contexts, tuple(Candidate(name, ()) for name in names))
    theta, residual = np.concatenate([baseline.fit.theta, structure.build_start()]), baseline.fit.residual
    fit = Fit(theta, residual, np.zeros((residual.size, theta.size)), float(residual @ residual))
    return replace(Explanation(structure, fit, baseline.box, gain, gain, 0.9), **more)


def known_case(baseline: Baseline, found: SearchResult | None = None, **more: Any) -> Case:
    """A case about a base; `more` are its other attributes."""
    track = baseline.problem.tracks[0]
    time = np.arange(track.size, dtype=np.float64) * np.float64(track.dt)
    recording = Recording(time, track.position, track.torque)
    plain = Case((recording,), baseline, known_search(best=False) if found is None else found, None, None, 0)
    return replace(plain, **more)


def known_findings(baseline: Baseline, case: Case | None = None, **more: Any) -> Findings:
    """Findings of a base that leaves nothing to name; `more` are their other attributes."""
    size, (series,) = baseline.fit.theta.size, collect_rows(baseline, [baseline.fit.residual], [baseline.fit.residual])
    plain = Findings(
        case=known_case(baseline) if case is None else case,
        trial=Trial(),
        unknown=False,
        refitted=RefittedJoint(baseline.structure, baseline.fit, np.eye(size)),
        base={},
        late_action=Quantity(0.0, "s", (0.0, 0.0)),
        held=Confirmation(1.0, 1.0, 1.0, (0.0, 0.0), 0.0),
        noise_ratio=1.0,
        comparison=Comparison(),
        shift_shares={},
        parts=(),
        effects=(),
        lag=None,
        location={},
        series=(series,),
        maps={},
        orders={},
        change_points=((),),
        told_apart=Distinguishability((), []),
    )
    return replace(plain, **more)
