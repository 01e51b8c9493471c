"""Effects that explain, with the simulation as it is given, what another inertia or gravity would."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fricomp.root_mean_square import compute_rms

from ..effects import EFFECTS
from ..effects.structure import N_BASE, Structure
from ..inputs.rigid import RigidJoint
from ..joint.solver import Box, Fit
from ..search.explanation import Explanation, compute_evidence, judge
from ..search.preparation import Baseline
from ..search.refit import fit_from
from ..search.screening import screen
from ..search.simulated_body import move_to
from .alias import is_as_good
from .case import Case, compare_given
from .comparison import PLAIN, compute_body_strays
from .gates import stands_out
from .refitted import RefittedJoint
from .settings import ALIASES, IN_PLACE

BODY_SHIFTS = {"inertia_error": 1, "torque_gain_error": 1, "payload_error": 3}
"""Shifts of inertia and gravity, and how many numbers each of them moves."""


@dataclass(frozen=True)
class _Question:
    """Parameters that were moved, and the joint as the simulation has it.

    Attributes:
        moved: The base with the parameters moved; its gain is less their price.
        given: The base with inertia and gravity as given, all else refitted.
        box: Domain of the base, inertia and gravity held as exactly as the comparison knows them.
    """

    moved: Explanation
    given: Explanation
    box: Box

    @property
    def cost(self) -> float:
        """What the simulation as given costs beside moved parameters."""
        return self.given.fit.cost - self.moved.fit.cost

    def count_gain(self, one: Explanation) -> Explanation:
        """An explanation with its gain counted from the simulation as given."""
        return replace(one, gain=one.gain + self.cost)

    def does_as_well(self, one: Explanation, noise: float) -> bool:
        """Whether an effect explains as much: where moved parameters leave nothing but `noise`, so must it."""
        least = self.moved.gain - max(ALIASES.close, self.moved.left, noise)
        return one.gain > least and is_as_good(self.count_gain(one), self.count_gain(self.moved))


def prefer_in_place(case: Case) -> Case:
    """The case, with effects that explain as much as parameters of the simulation that were found to be moved.

    What is too weak to stand out beside a refitted base may have bent its inertia or gravity, which are known a
    hundred times better from the simulation: beside it the effect stands out. One that explains more than the moved
    parameters, by what a recording with nothing missing never shows, takes their place.
    """
    question = _ask(case)
    if question is None:
        return case
    baseline, found = case.baseline, case.found
    base = question.given.fit.theta[:N_BASE]
    tried = fit_from(baseline, [(one, base) for one in _list_tried(case, question)], question.box)
    alike = [one for one in tried if _is_physical(one) and question.does_as_well(one, found.explainable_null)]
    alike = sorted(alike, key=lambda one: (bool(one.refused), -one.gain))
    case = replace(case, instead=tuple(dict.fromkeys(one.names[0] for one in alike)))
    sure = [one for one in alike if not one.refused and one.gain > question.moved.gain + found.threshold]
    if not sure:
        return case
    standing = [_judge_standing(baseline, one, question.given.fit) for one in sure]
    others = tuple(one for one in found.explanations if one.names != standing[0].names)
    explanations = (*standing, *(one for one in alike if one not in sure), *others)
    return replace(case, found=replace(found, best=standing[0], explanations=explanations))


def _ask(case: Case) -> _Question | None:
    """None where no inertia or gravity was moved, or something was found besides."""
    baseline, rigid = case.baseline, case.rigid
    if rigid is None or not rigid.rotary or case.found.best is not None or stands_out(case.found, baseline):
        return None
    named = [one.name for one in compare_given(case, RefittedJoint.refit(baseline, None), PLAIN).shifts]
    numbers = sum(BODY_SHIFTS.get(name, 0) for name in named)
    if not numbers:
        return None
    moved = judge(baseline, baseline.structure, baseline.fit, baseline.box)
    moved = replace(moved, gain=-numbers * float(np.log(baseline.fit.residual.size)))
    box = _hold_as_known(baseline, rigid)
    start = move_to(box.centre[:3], baseline.fit.theta, baseline.structure.contexts)
    (given,) = fit_from(baseline, [(baseline.structure, start)], box)
    jacobian = given.fit.jacobian.copy()
    jacobian[:, :3] = 0.0  # what is given stays so, about it and on every fold
    return _Question(moved, replace(given, fit=replace(given.fit, jacobian=jacobian)), box)


def _hold_as_known(baseline: Baseline, rigid: RigidJoint) -> Box:
    """The base's domain with inertia and gravity of the simulation, as far as they are known and a comparison tells."""
    box, plant, contexts = (
        baseline.box,
        baseline.structure.unpack_plant(baseline.fit.theta),
        baseline.structure.contexts,
    )
    acceleration = compute_rms(np.concatenate([c.acceleration for c in contexts]))
    spread = np.diag(compute_body_strays(plant, float(np.hypot(*rigid.gravity)), PLAIN, acceleration) ** 2)
    spread = spread if rigid.covariance is None else spread + rigid.covariance[:3, :3]
    precision = box.precision.copy()
    precision[:3, :3] = np.linalg.inv(spread)
    centre = np.concatenate([[np.log(rigid.inertia), *rigid.gravity], box.centre[3:]])
    return replace(box, centre=centre, precision=precision)


def _list_tried(case: Case, question: _Question) -> list[Structure]:
    """Effects that may explain what the simulation as given leaves, the most likely ones of them."""
    baseline, fit = case.baseline, question.given.fit
    about = Structure(question.given.structure.move_contexts(fit.theta))
    columns = screen(baseline.problem, about, fit.theta, fit.residual, fit.jacobian).select_best().values()
    strong = [
        c.candidate
        for c in columns
        if c.energy > IN_PLACE.share * question.cost and c.candidate.name not in BODY_SHIFTS
    ]
    single = [one for one in case.found.explanations if len(one.names) == 1 and _is_physical(one)]
    found = [
        candidate for one in single[: IN_PLACE.fitted] for candidate in one.settled if candidate.name not in BODY_SHIFTS
    ]
    return [replace(about, candidates=(one,)) for one in (*strong[: IN_PLACE.most], *found)]


def _is_physical(one: Explanation) -> bool:
    """Whether it may be what happens, be it too faint to be named."""
    if not one.refused:
        return True
    values = one.values
    return all(EFFECTS[name].is_faint(values[name], one.structure.contexts) for name in one.names)


def _judge_standing(baseline: Baseline, one: Explanation, given: Fit) -> Explanation:
    """An explanation judged beside the simulation as given."""
    penalty = one.structure.freedom * float(np.log(given.residual.size))
    return replace(one, certain=compute_evidence(baseline, one.names, given, one.fit) - penalty, before=given)
