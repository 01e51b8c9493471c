"""What one recording of a moving arm says about its links, its rotors and the friction of all its joints.

The bandwidth first, since structure that rings is no friction; then the time by which all torques are late, because a
wrong delay turns into friction; then one thing more at a time, as long as it makes the recording more probable: a term
of friction in a joint, a link that is further off than files usually are, a gain of all torques. Where what was found
leaves so much less that another band says more, all of that is done again in it. What was taken in and does not come
again in halves of the recording, or hardly changes the held-out error, is left out again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from fricomp.blas import one_blas_thread
from fricomp.errors import IdentificationError

from .arm_recording import ArmRecording
from .coordinates import ArmModel
from .equations import ArmEquations
from .fit import ArmFit, fit_arm
from .friction import GEARS, TERMS
from .glance import Glance
from .physics import is_physical, is_whole
from .prior import ArmPrior
from .rigid.simulated_arm import SimulatedArm
from .robust_fit import fit_robustly
from .rows import ArmRows
from .search.early_torque import EarlyTorques
from .search.gear import YIELDING_GEAR, GearSearch
from .search.gear_motion import GearMotion
from .search.judge import JointJudges
from .search.proposal import propose_models
from .search.ripple import propose_ripples
from .search.shared_delay import SharedDelay, share_delays
from .search.stribeck import is_curve
from .timing.bandwidth import choose_again, choose_rows
from .timing.delay_correction import move_torques, take_off_delay
from .timing.gear_band import choose_lower, find_gaps
from .timing.ripple_band import find_ripples

__all__ = ["EVIDENCE", "LOOK_STEPS", "ArmIdentification", "ArmSearch", "identify_arm", "identify_without"]

Progress = Callable[[str], None]

_PASSES = 2
"""Of delay and model in turn."""

_ALIKE = 3.0
"""Difference of such logarithms below which two explanations are said to do as well: odds of twenty to one."""

_GLANCE, LOOK_STEPS = 2, 15
"""Gauss-Newton steps in which a term is weighed, and a link that may be far off, which is not linear."""

_GLANCE_ERROR = 3.0
"""By how much a glance may be wrong about the logarithm of a Bayes factor: links are not linear."""

_DELAY = "torque_delay"

EVIDENCE = 6.0
"""Logarithm of the least Bayes factor by which something is taken in: a probability of 0.998 at even odds."""


_PROBABLE = 0.0
"""The same of a Stribeck curve, which every friction law has: it is taken in where it is more probable than none."""


@dataclass(frozen=True)
class ArmIdentification:
    """The answer.

    Attributes:
        recording: What it is of.
        rows: The equations, with the delay taken off.
        equations: Their sums.
        fit: Values and covariance, and what was taken in.
        delay: By how much the torques are late.
        prior: How far the simulation was trusted.
        trials: What was tried, with the logarithm of its Bayes factor when it was last weighed.
        rivals: Of each thing that was taken in, what would have done nearly as well in the same joint.
        begun: Rows and equations at the bandwidth that was chosen before anything was found.
    """

    recording: ArmRecording
    rows: ArmRows
    equations: ArmEquations
    fit: ArmFit
    delay: SharedDelay
    prior: ArmPrior
    trials: dict[str, float]
    rivals: dict[str, tuple[str, ...]]
    begun: tuple[ArmRows, ArmEquations]


@one_blas_thread()
def identify_arm(
    arm: SimulatedArm, recording: ArmRecording, prior: ArmPrior | None = None, progress: Progress | None = None
) -> ArmIdentification:
    """Identify links, rotors and friction of a whole arm.

    Args:
        arm: The simulation, with the joints of the recording in its order.
        recording: All joints, moving.
        prior: How far the simulation is trusted.
        progress: Called with a few words before each step.

    Raises:
        IdentificationError: No joint moves, or the recording is too short.
    """
    say, prior = progress or (lambda _: None), prior or ArmPrior()
    if not any(np.ptp(part.position) > 0.0 for part in recording.parts):
        raise IdentificationError("no joint moves in this recording")
    say("choosing the bandwidth")
    plain = ArmModel.build_plain(len(arm.joints))
    rows, begun = choose_rows(arm, recording, plain, prior)
    start = ArmSearch(arm, recording, prior, say)
    return start.finish(start.run(rows, begun, plain, SharedDelay(0.0, 0.0, {})), rows, begun)


def identify_without(
    found: ArmIdentification, barred: frozenset[str], progress: Progress | None = None
) -> ArmIdentification:
    """Search again, in the band that was begun with, without what was not borne out.

    What was found beside it leans on it: gone on from that, the search names what nobody finds without it.

    Args:
        found: With the model that was confirmed.
        barred: Things that are not looked for, by the names of `propose_models`.
        progress: Called with a few words before each step.
    """
    search = ArmSearch(found.fit.arm, found.recording, found.prior, progress or (lambda _: None), barred)
    plain = ArmModel.build_plain(len(found.fit.arm.joints))
    return search.finish(search.run(*found.begun, plain, SharedDelay(0.0, 0.0, {})), *found.begun)


@dataclass
class ArmSearch:
    """Looks for what the simulation has wrong.

    Attributes:
        arm: The simulation.
        recording: Of its joints.
        prior: How far it is trusted.
        say: Called with a few words before each step.
        barred: Things that are not looked for, by the names of `propose_models`.
        trials: As those of `ArmIdentification`.
        rivals: As those of `ArmIdentification`.
    """

    arm: SimulatedArm
    recording: ArmRecording
    prior: ArmPrior
    say: Progress
    barred: frozenset[str] = frozenset()
    trials: dict[str, float] = field(default_factory=dict)
    rivals: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def finish(self, found: ArmIdentification, rows: ArmRows, begun: ArmEquations) -> ArmIdentification:
        """Search again in another band where that says more, and settle.

        Args:
            found: In the band that was chosen.
            rows: At the bandwidth that was chosen before anything was found.
            begun: Equations there.
        """
        other = choose_again(found.rows, found.equations, found.fit, self.recording, self.prior, begun.weights.noise)
        if other is not None:
            found = self.search_again(*other, found)
        while lower := choose_lower(found.rows, found.equations, found.fit, self.recording, self.prior):
            found = self.search_again(*lower, found)
        for look in (find_gaps, find_ripples):
            seen = look(found.rows, found.equations, found.fit, self.recording, self.prior)
            if seen is not None:
                new = _list_terms(seen.fit) - _list_terms(found.fit)
                trials = found.trials | dict.fromkeys(new, seen.gain)
                found = replace(found, rows=seen.rows, equations=seen.equations, fit=seen.fit, trials=trials)
        model = found.fit.model
        fit, equations = fit_robustly(self.arm, found.rows, found.equations, model, self.prior, found.fit, settled=True)
        return replace(found, fit=fit, equations=equations, begun=(rows, begun))

    def search_again(self, rows: ArmRows, equations: ArmEquations, known: ArmIdentification) -> ArmIdentification:
        """In another band.

        What is missing shifts the delay that joints ask for, and the more the wider the band is. So the one that is
        known from another band, beside what was found there, stands until this is found again.
        """
        plain = replace(ArmModel.build_plain(len(self.arm.joints)), prompt=known.fit.model.prompt)
        self.trials, self.rivals = {}, {}
        moved, equations = move_torques(rows, equations, known.delay.value)
        model, _, equations = self._take_in(moved, equations, plain)
        return self.run(moved, equations, model, known.delay)

    def run(self, rows: ArmRows, equations: ArmEquations, model: ArmModel, delay: SharedDelay) -> ArmIdentification:
        """Delay and model in turn.

        Args:
            rows: With torques as early as the delay has them.
            equations: Of these rows.
            model: To begin with.
            delay: As far as it is known.
        """
        begun = rows, equations
        for _ in range(_PASSES):
            self.say("finding the delay of the torques")
            before, model = model, share_delays(model)
            rows, equations, delay, prompt = take_off_delay(
                self.recording, rows, equations, model, self.prior, delay.value, self.arm
            )
            model = replace(model, prompt=prompt)
            self.say("weighing what the simulation may have wrong")
            model, fit, equations = self._take_in(rows, equations, model)
            if model == before:
                break
        return ArmIdentification(
            self.recording, rows, equations, fit, delay, self.prior, self.trials, self.rivals, begun
        )

    def _take_in(
        self, rows: ArmRows, equations: ArmEquations, model: ArmModel
    ) -> tuple[ArmModel, ArmFit, ArmEquations]:
        """Take in one thing at a time, the most probable first, until none makes the recording much more probable."""
        fit, equations = fit_robustly(self.arm, rows, equations, model, self.prior)
        motion = GearMotion(rows, fit)
        searches = [GearSearch(motion, filled) for filled in GEARS]
        while True:
            equations = propose_ripples(rows, equations, fit)
            judges = JointJudges(equations, fit)
            for gears in searches:
                judges = JointJudges(equations, fit) if fit.model.geared else judges
                equations = gears.propose(equations, fit, self.prior, judges)
            tried = _try_out(rows, equations, fit, self.prior, self.trials, self.barred)
            gains = {name: one.log_evidence - fit.log_evidence for name, one in sorted(tried, key=_evidence_of)}
            self.trials |= gains  # of the best variant of each
            best = max(gains, key=lambda name: gains[name] - _require(name), default=None)
            if best is None or gains[best] < _require(best):
                return fit.model, fit, equations
            alike = [name for name in _order(tried) if _is_rival(name, best) and gains[name] > gains[best] - _ALIKE]
            self.rivals[alike[0]] = tuple(alike[1:])
            chosen = max((one for name, one in tried if name == alike[0]), key=lambda one: one.log_evidence)
            fit, equations = fit_robustly(self.arm, rows, equations, chosen.model, self.prior, chosen)
            if any(YIELDING_GEAR in form.names for form in fit.model.forms):  # links make up for what a gear is off by
                spring = GEARS.index("spring")
                searches[spring] = searches[spring].follow(GearMotion(rows, fit))


def _try_out(
    rows: ArmRows,
    equations: ArmEquations,
    fit: ArmFit,
    prior: ArmPrior,
    trials: dict[str, float],
    barred: frozenset[str],
) -> list[tuple[str, ArmFit]]:
    """Fits of what a glance finds most promising and friction can do, in the order in which models are proposed.

    No delay of a joint where a gear would explain more and is not the law that it should be, as one on which a load
    bounces to and fro: joints feel at other times what is behind it.
    """
    glance, early = Glance(equations, fit, prior), EarlyTorques(rows, equations, fit)
    is_early = partial(early.shows, glance=glance)
    proposed = [(name, other) for name, other in propose_models(fit.arm, fit.model) if name not in barred]
    gains = [(name, other, _weigh(glance, fit.model, other)) for name, other in proposed]
    trials |= {name: gain for name, _, gain in sorted(gains, key=lambda each: each[2])}
    open_ones = [each for each in gains if each[2] > _require(each[0]) - _GLANCE_ERROR]
    while open_ones:
        best = max(gain for _, _, gain in open_ones)
        now = [each for each in open_ones if each[2] >= best - _ALIKE - _GLANCE_ERROR]
        tried = [
            (name, fit_arm(fit.arm, equations, other, prior, fit, steps=_count_steps(fit, other)))
            for name, other, _ in now
        ]
        tried = [(name, one) for name, one in tried if is_physical(one, fit, is_early)]
        possible = [(name, one) for name, one in tried if _is_possible(one, fit) and not _is_torn(one, fit, early)]
        if possible:
            return possible
        open_ones = [each for each in open_ones if each not in now]
        if any(TERMS[name].filled in GEARS for _, one in tried for _, name in _list_added(one.model, fit.model)):
            open_ones = [each for each in open_ones if not each[0].endswith(f": {_DELAY}")]
    return []


def _list_added(model: ArmModel, before: ArmModel) -> list[tuple[int, str]]:
    """Numbers of joints and the names of the terms by which a model is another one than before."""
    pairs = enumerate(zip(model.forms, before.forms, strict=True))
    return [(j, form.names[-1]) for j, (form, old) in pairs if form != old]


def _is_possible(one: ArmFit, before: ArmFit) -> bool:
    """Whether a Stribeck curve that was added is one, and what has a law without a factor is nearer to it than to none.

    A gear of a joint that is rigid comes with some other stiffness and a small part of what that would do.
    """
    added = _list_added(one.model, before.model)
    return all(is_curve(one, j) if name == "stribeck" else is_whole(one, j, name) for j, name in added)


def _is_torn(one: ArmFit, before: ArmFit, early: EarlyTorques) -> bool:
    """Whether a delay that was added to a joint is one that its links and its friction contradict each other about."""
    return any(early.is_torn(j) for j, name in _list_added(one.model, before.model) if name == _DELAY)


def _weigh(glance: Glance, model: ArmModel, other: ArmModel) -> float:
    """Logarithm of a Bayes factor by a glance.

    A joint whose torque is in another unit looks like links that weigh something else: it counts for no more than it
    has beyond links that may weigh anything.
    """
    gain = glance.measure_gain(other)
    scaled = [j for j, name in _list_added(other, model) if name == "torque_gain_error"]
    if not scaled:
        return gain
    free = frozenset(range(scaled[0], glance.n_links)) | model.opened
    beyond = glance.measure_gain(replace(other, opened=free)) - glance.measure_gain(replace(model, opened=free))
    return min(gain, beyond)


def _require(name: str) -> float:
    """Logarithm of the Bayes factor that is asked for."""
    return _PROBABLE if name.endswith(": stribeck") else EVIDENCE


def _count_steps(fit: ArmFit, other: ArmModel) -> int:
    return _GLANCE if other.opened == fit.model.opened else LOOK_STEPS


def _evidence_of(tried: tuple[str, ArmFit]) -> float:
    return tried[1].log_evidence


def _order(tried: Sequence[tuple[str, ArmFit]]) -> list[str]:
    """Names in the order in which they are proposed: simpler ones come first."""
    return list(dict.fromkeys(name for name, _ in tried))


def _list_terms(fit: ArmFit) -> set[str]:
    """Names of all terms of all joints, as models are proposed."""
    pairs = zip(fit.arm.joints, fit.model.forms, strict=True)
    return {f"{joint}: {name}" for joint, form in pairs for name in form.names}


def _is_rival(name: str, other: str) -> bool:
    """Whether two things are of the same joint or the same kind, so that one may stand for the other."""
    return name.split(": ", maxsplit=1)[0] == other.split(": ", maxsplit=1)[0]
