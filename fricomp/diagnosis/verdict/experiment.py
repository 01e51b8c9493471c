"""The next experiment: of a menu of motions, the one that tells most rivals from the explanation that was chosen.

What counts is the gain a rival would still lack after both recordings were fitted together: about its minimum on the
recording at hand it may move all its parameters, as far as that recording lets it, to meet what the chosen one predicts
on the motion. A motion on which no rival would lack enough is not proposed, be the difference as large as it may.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from ..effects import Context
from ..effects.context import build_contexts
from ..evidence.alias import list_printed_rivals
from ..evidence.case import compare_given
from ..evidence.comparison import AGREES
from ..evidence.findings import Findings
from ..inputs.track import FloatArray, Track, differentiate
from ..joint.observer import Contribution, Job, Plant
from ..joint.problem import Problem, build_problem
from ..joint.solver import Box, choose_steps
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from ..search.simulated_body import hold
from .motion import MENU, Range
from .settings import EXPERIMENT


class Proposal(NamedTuple):
    """A motion and what it would tell.

    Attributes:
        motion: Columns time [s], position_reference, velocity_reference.
        title: What the motion is.
        separates: Names of the rivals' effects that it would tell from those of the chosen explanation, and of those.
        difference: Predicted root mean square difference of the two that are hardest to tell apart of them [N·m].
    """

    motion: dict[str, FloatArray]
    title: str
    separates: tuple[str, ...]
    difference: float


def propose_experiment(findings: Findings) -> Proposal | None:
    """Propose the motion that tells what was named from what fits as well; None where nothing does, or no motion can.

    Args:
        findings: Evidence from the rows.
    """
    case, rivals = findings.case, dict[tuple[str, ...], Explanation]()
    for rival in list_printed_rivals(case.found):  # best first, one of each set of effects
        rivals.setdefault(rival.names, rival)
    if findings.chosen is None or not rivals:
        return None
    box = case.baseline.box
    if case.rigid is not None and case.rigid.rotary and not compare_given(case, findings.refitted, AGREES).shifts:
        box = hold(box, case.rigid)  # beside one that agrees, rivals are held to the simulation too
    return propose_motion(case.baseline, findings.chosen, list(rivals.values())[: EXPERIMENT.most_rivals], box)


def propose_motion(baseline: Baseline, chosen: Explanation, rivals: Sequence[Explanation], box: Box) -> Proposal | None:
    """The motion that tells `chosen` from most of its rivals; None where no motion of the menu tells it from any.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        chosen: The explanation that was chosen.
        rivals: What fits as well.
        box: Domain and priors of the base, within which a rival may move.
    """
    dt = baseline.problem.tracks[0].dt
    reach, trials = _find_range(baseline), []
    for title, shape in MENU.items():
        time = np.arange(int(EXPERIMENT.duration / dt), dtype=np.float64) * dt
        fade = np.clip(np.minimum(time, time[-1] - time) / EXPERIMENT.fade, 0.0, 1.0)
        position = reach.centre + shape(time, reach) * (3.0 - 2.0 * fade) * fade**2
        motion = _Motion.build(baseline, position)
        trials.append((title, motion, [motion.compute_lack(chosen, rival, box) for rival in rivals]))
    title, motion, lacks = max(trials, key=lambda trial: _rate(trial[2]))
    told = [(lack, rival) for lack, rival in zip(lacks, rivals, strict=True) if lack > EXPERIMENT.enough]
    if not told:
        return None
    names = {name for _, rival in told for name in set(rival.names) ^ set(chosen.names)}
    return Proposal(
        motion.list_columns(), title, tuple(sorted(names)), motion.convert_to_torque(min(lack for lack, _ in told))
    )


def _rate(lacks: Sequence[float]) -> tuple[int, float]:
    """How many rivals a motion tells apart, and how clearly."""
    return sum(lack > EXPERIMENT.enough for lack in lacks), sum(
        min(lack, EXPERIMENT.plenty * EXPERIMENT.enough) for lack in lacks
    )


def _find_range(baseline: Baseline) -> Range:
    low = min(float(track.position.min()) for track in baseline.problem.tracks)
    high = max(float(track.position.max()) for track in baseline.problem.tracks)
    speed = max(float(np.quantile(np.abs(track.velocity), EXPERIMENT.fastest)) for track in baseline.problem.tracks)
    return Range(0.5 * (low + high), EXPERIMENT.half_range * (high - low), speed)


@dataclass(frozen=True)
class _Motion:
    """A motion that is not recorded yet, as the base model would move along it.

    Attributes:
        problem: The one recording that it would give.
        context: What effects would draw on.
        noise: Of a row [N·m], as in the recordings at hand.
        whitener: Of rows, as there.
    """

    problem: Problem
    context: Context
    noise: float
    whitener: FloatArray

    @classmethod
    def build(cls, baseline: Baseline, position: FloatArray) -> _Motion:
        """The motion along `position`, seen through the observer of the recordings."""
        track, plant = _simulate_recording(baseline, position)
        problem = build_problem([track], plant, baseline.problem.observer)
        seen = problem.observe([Job(problem.tracks[0], plant, Contribution())])
        context = build_contexts(problem, plant, seen, baseline.structure.contexts[0].hints)[0]
        weights = baseline.nulls.weights
        return cls(problem, context, float(np.median(np.concatenate(weights.spread))), weights.whitener)

    def predict_rows(self, explanation: Explanation, points: Sequence[FloatArray]) -> FloatArray:
        """What is missing of the motion at several points of an explanation, weighted. Shape (n_points, n_rows)."""
        structure, jobs = explanation.structure, []
        first = structure.contexts[0]
        context = replace(self.context, plant=first.plant, usual_load=first.usual_load)
        for theta in points:
            # By name: of several recordings some effects have parameters of their own; the first ones count here.
            effects = structure.compute_contribution(context, theta)
            jobs.append(Job(self.problem.tracks[0], structure.unpack_plant(theta), effects))
        missing = [self.problem.grids[0].average(one.missing) for one in self.problem.observe(jobs)]
        return np.asarray(lfilter(self.whitener, [1.0], np.stack(missing) / self.noise, axis=1))

    def compute_lack(self, chosen: Explanation, rival: Explanation, box: Box) -> float:
        """Gain that `rival` would lack on this motion where `chosen` is right, after it is fitted to all recordings.

        0 where one of the two, or the rival beside its fit, does not simulate on this motion.
        """
        box, theta = box.join(rival.structure.build_box()), rival.fit.theta
        steps = choose_steps(theta, box, EXPERIMENT.difference)
        free = np.flatnonzero(box.scale > EXPERIMENT.held)
        at, *moved = self.predict_rows(rival, [theta, *(theta + steps[i] * np.eye(theta.size)[i] for i in free)])
        difference = at - self.predict_rows(chosen, [chosen.fit.theta])[0]
        here = (rival.fit.jacobian * box.scale)[:, free]
        signed = np.copysign(EXPERIMENT.difference, steps[free])
        there = np.stack([(row - at) / part for row, part in zip(moved, signed, strict=True)], axis=1)
        # A row that ran away squares to infinity, on which the solution of the normal equations need not even end.
        if not np.all(np.abs(np.column_stack([difference, there])) < EXPERIMENT.largest):
            return 0.0
        known = here.T @ here + box.scaled_precision[np.ix_(free, free)] + there.T @ there
        along = there.T @ difference
        return float(difference @ difference - along @ np.linalg.lstsq(known, along, rcond=1e-10)[0])

    def convert_to_torque(self, gain: float) -> float:
        """Root mean square of a row behind a gain [N·m]."""
        return self.noise * float(np.sqrt(gain / self.problem.grids[0].centres.size))

    def list_columns(self) -> dict[str, FloatArray]:
        """Columns of the file."""
        track = self.problem.tracks[0]
        time = np.arange(track.size, dtype=np.float64) * track.dt
        velocity = np.gradient(track.position, track.dt)
        return {"time": time, "position_reference": track.position, "velocity_reference": velocity}


def _simulate_recording(baseline: Baseline, position: FloatArray) -> tuple[Track, Plant]:
    """The recording that the base model would give on a motion, without noise."""
    plant = baseline.structure.unpack_plant(baseline.fit.theta)
    old = baseline.problem.tracks[0]
    v = differentiate(position, old.dt)
    a = differentiate(v, old.dt)
    speed = np.abs(v)
    curves = []
    for coulomb, static, stribeck, viscous in (plant.forward, plant.reverse):
        curves.append(coulomb + (static - coulomb) * np.exp(-((speed / stribeck) ** 2)) + viscous * speed)
    friction = np.where(v >= 0.0, curves[0], -curves[1]) * np.tanh(speed / EXPERIMENT.rest_speed)
    torque = plant.inertia * a + plant.compute_gravity_torque(position, old.rotary) + friction
    channels: dict[str, FloatArray] = {}
    return Track.build(old.dt, position, torque, rotary=old.rotary, channels=channels, name="proposal"), plant
