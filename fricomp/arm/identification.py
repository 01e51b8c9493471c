"""What one recording of a moving arm says about its links, its rotors and the friction of all its joints.

The bandwidth first, since structure that rings is no friction; then the time by which all torques are late, because a
wrong delay turns into friction; then one thing more at a time, as long as it makes the recording more probable: a term
of friction in a joint, a link that is further off than files usually are, a gain of all torques. Where what was found
leaves so much less that a wider band says more, all of that is done again in it. What was taken in and does not come
again in halves of the recording, or hardly changes the held-out error, is left out again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.blas import one_blas_thread
from fricomp.errors import IdentificationError

from .arm_recording import ArmRecording
from .bandwidth import choose_rows, raise_cutoff
from .coordinates import ArmModel
from .equations import ArmEquations
from .fit import ArmFit, fit_arm
from .friction import GEARS
from .glance import Glance
from .physics import is_physical, is_whole
from .prior import ArmPrior
from .rigid.simulated_arm import SimulatedArm
from .robust_fit import fit_robustly
from .rows import ArmRows
from .search.early_torque import EarlyTorques
from .search.gear import YIELDING_GEAR, GearSearch
from .search.proposal import propose_models
from .search.ripple import propose_ripples
from .search.shared_delay import SharedDelay, measure_delay, measure_seen, share_delays
from .search.stribeck import is_curve

__all__ = ["EVIDENCE", "LOOK_STEPS", "ArmIdentification", "identify_arm"]

Progress = Callable[[str], None]

_DELAY_ROUNDS, _PASSES = 6, 2
"""Of the search for a delay, and of delay and model in turn."""

_HOLD, _SURELY = 0.5, 2.0
"""Of a sample's period, by which torques may be ahead of the positions without more: a command acts from its row to the
next, in the mean half a period after it, and no row is known to be of one instant. Standard deviations by which a delay
must be beyond that to be further: that of a command is half a period, and comes out on either side of it."""

_ALIKE = 3.0
"""Difference of such logarithms below which two explanations are said to do as well: odds of twenty to one."""

_GLANCE, LOOK_STEPS = 2, 15
"""Gauss-Newton steps in which a term is weighed, and a link that may be far off, which is not linear."""

_GLANCE_ERROR = 3.0
"""By how much a glance may be wrong about the logarithm of a Bayes factor: links are not linear."""

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
    arm: SimulatedArm,
    recording: ArmRecording,
    prior: ArmPrior | None = None,
    progress: Progress | None = None,
    barred: frozenset[str] = frozenset(),
    before: ArmIdentification | None = None,
) -> ArmIdentification:
    """Identify links, rotors and friction of a whole arm.

    Args:
        arm: The simulation, with the joints of the recording in its order.
        recording: All joints, moving.
        prior: How far the simulation is trusted.
        progress: Called with a few words before each step.
        barred: Things that are not looked for, by the names of `propose_models`.
        before: An answer on the same recording, whose bandwidth is begun with.

    Raises:
        IdentificationError: No joint moves, or the recording is too short.
    """
    say, prior = progress or (lambda _: None), prior or ArmPrior()
    if not any(np.ptp(part.position) > 0.0 for part in recording.parts):
        raise IdentificationError("no joint moves in this recording")
    say("choosing the bandwidth")
    plain = ArmModel.build_plain(len(arm.joints))
    rows, begun = choose_rows(arm, recording, plain, prior) if before is None else before.begun
    found = _search(rows, begun, arm, recording, prior, say, barred=barred)
    higher = raise_cutoff(found.rows, found.equations, found.fit, recording, prior, begun.weights.noise)
    if higher is not None:
        found = _search(*higher, arm, recording, prior, say, found, barred)
    fit, equations = fit_robustly(arm, found.rows, found.equations, found.fit.model, prior, found.fit, settled=True)
    return replace(found, fit=fit, equations=equations, begun=(rows, begun))


def _search(
    rows: ArmRows,
    equations: ArmEquations,
    arm: SimulatedArm,
    recording: ArmRecording,
    prior: ArmPrior,
    say: Progress,
    known: ArmIdentification | None = None,
    barred: frozenset[str] = frozenset(),
) -> ArmIdentification:
    """Delay and model in turn, from a plain one.

    What is missing shifts the delay that joints ask for, and the more the wider the band is. So the one that is known
    from another band, beside what was found there, stands until this is found again.
    """
    model, begun = ArmModel.build_plain(len(arm.joints)), (rows, equations)
    trials: dict[str, float] = {}
    rivals: dict[str, tuple[str, ...]] = {}
    delay = SharedDelay(0.0, 0.0, {})
    if known is not None:
        delay, model = known.delay, replace(model, prompt=known.fit.model.prompt)
        rows, equations = _move_torques(recording, rows, equations, delay.value)
        model, _, equations = _take_in(rows, equations, model, prior, trials, rivals, arm, barred)
    for _ in range(_PASSES):
        say("finding the delay of the torques")
        before, model = model, share_delays(model)
        rows, equations, delay, prompt = _take_off_delay(recording, rows, equations, model, prior, delay.value, arm)
        model = replace(model, prompt=prompt)
        say("weighing what the simulation may have wrong")
        model, fit, equations = _take_in(rows, equations, model, prior, trials, rivals, arm, barred)
        if model == before:
            break
    return ArmIdentification(recording, rows, equations, fit, delay, prior, trials, rivals, begun)


def _take_off_delay(
    recording: ArmRecording,
    rows: ArmRows,
    equations: ArmEquations,
    model: ArmModel,
    prior: ArmPrior,
    start: float,
    arm: SimulatedArm,
) -> tuple[ArmRows, ArmEquations, SharedDelay, bool]:
    """Rows in which the torques are as early as the positions, and the delay that was taken off.

    Torques are not taken to be further ahead of the positions than a held command is where friction turns before its
    joints do, which looks like it; nor ahead at all where a gear gives way, which does so too.
    Whether a delay is sure is seen where it stands still: on the way there, each joint shows another part of its own.

    Returns:
        The last tells whether they look so, and are taken to be prompt.
    """
    total, found, moved, before, held = start, SharedDelay(start, 0.0, {}), 0.0, 0.0, -_HOLD * recording.period
    for _ in range(_DELAY_ROUNDS):  # settled: a joint that sticks turns later than it would
        fit, equations = fit_robustly(arm, rows, equations, model, prior, settled=True)
        more = measure_delay(equations, fit, prior)
        ahead = total + more.value < 0.0
        beyond, early = total + more.value + _SURELY * more.deviation < held, EarlyTorques(rows, equations, fit)
        if beyond and not early.are_all(total + fit.delay[0]):
            at = held if early.are_held(total + fit.delay[0]) else 0.0
            return *_move_torques(recording, rows, equations, at), more.move(total, at - total), True
        still = abs(more.value) < 0.5 * more.deviation
        moved = 0.0 if still else more.value / measure_seen(more.value, before, moved)
        before = more.value
        found = more.move(total, moved)
        if still:
            break
        total = found.value
        rows, equations = _move_torques(recording, rows, equations, total)
    if found.is_sure or not total:
        return rows, equations, found, ahead and not total
    return *_move_torques(recording, rows, equations, 0.0), found._replace(value=0.0), ahead


def _move_torques(
    recording: ArmRecording, rows: ArmRows, equations: ArmEquations, delay: float
) -> tuple[ArmRows, ArmEquations]:
    """Rows and equations of torques that are taken to be late by this [s]."""
    moved = rows.with_delay(recording, delay)
    return moved, equations.with_torque(moved)


def _take_in(
    rows: ArmRows,
    equations: ArmEquations,
    model: ArmModel,
    prior: ArmPrior,
    trials: dict[str, float],
    rivals: dict[str, tuple[str, ...]],
    arm: SimulatedArm,
    barred: frozenset[str],
) -> tuple[ArmModel, ArmFit, ArmEquations]:
    """Take in one thing at a time, the most probable first, until none makes the recording much more probable."""
    fit, equations = fit_robustly(arm, rows, equations, model, prior)
    searches = [GearSearch(rows, fit, filled) for filled in GEARS]
    while True:
        equations = propose_ripples(rows, equations, fit)
        for gears in searches:
            equations = gears.propose(equations, fit, prior)
        tried = _try_out(rows, equations, fit, prior, trials, barred)
        gains = {name: one.log_evidence - fit.log_evidence for name, one in sorted(tried, key=_evidence_of)}
        trials |= gains  # of the best variant of each
        best = max(gains, key=lambda name: gains[name] - _require(name), default=None)
        if best is None or gains[best] < _require(best):
            return fit.model, fit, equations
        alike = [name for name in _order(tried) if _is_rival(name, best) and gains[name] > gains[best] - _ALIKE]
        rivals[alike[0]] = tuple(alike[1:])
        chosen = max((one for name, one in tried if name == alike[0]), key=lambda one: one.log_evidence)
        model = chosen.model
        fit, equations = fit_robustly(arm, rows, equations, model, prior, chosen)
        if alike[0].endswith(f": {YIELDING_GEAR}"):  # until then links made up for it, and what bends it hangs on them
            searches[GEARS.index("spring")] = GearSearch(rows, fit, "spring")


def _try_out(
    rows: ArmRows,
    equations: ArmEquations,
    fit: ArmFit,
    prior: ArmPrior,
    trials: dict[str, float],
    barred: frozenset[str],
) -> list[tuple[str, ArmFit]]:
    """Fits of what a glance finds most promising and friction can do, in the order in which models are proposed."""
    glance, early = Glance(equations, fit, prior), EarlyTorques(rows, equations, fit)

    def is_early(joint: int) -> bool:
        return not fit.model.prompt and early.shows(joint, glance)

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
        tried = [
            (name, one)
            for name, one in tried
            if is_physical(one, fit, is_early) and _is_possible(one, fit) and not _is_torn(one, fit, early)
        ]
        if tried:
            return tried
        open_ones = [each for each in open_ones if each not in now]
    return []


def _is_possible(one: ArmFit, before: ArmFit) -> bool:
    """Whether a Stribeck curve that was added is one, and what has a law without a factor is nearer to it than to none.

    A gear of a joint that is rigid comes with some other stiffness and a small part of what that would do.
    """
    pairs = enumerate(zip(one.model.forms, before.model.forms, strict=True))
    added = [(j, form.names[-1]) for j, (form, old) in pairs if form != old]
    return all(is_curve(one, j) if name == "stribeck" else is_whole(one, j, name) for j, name in added)


def _is_torn(one: ArmFit, before: ArmFit, early: EarlyTorques) -> bool:
    """Whether a delay that was added to a joint is one that its links and its friction contradict each other about."""
    pairs = enumerate(zip(one.model.forms, before.model.forms, strict=True))
    return any(early.is_torn(j) for j, (form, old) in pairs if form != old and form.names[-1] == "torque_delay")


def _weigh(glance: Glance, model: ArmModel, other: ArmModel) -> float:
    """Logarithm of a Bayes factor by a glance.

    A joint whose torque is in another unit looks like links that weigh something else: it counts for no more than it
    has beyond links that may weigh anything.
    """
    gain = glance.measure_gain(other)
    scaled = [
        j
        for j, (form, before) in enumerate(zip(other.forms, model.forms, strict=True))
        if form != before and form.terms[-1][0] == "torque_gain_error"
    ]
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


def _is_rival(name: str, other: str) -> bool:
    """Whether two things are of the same joint or the same kind, so that one may stand for the other."""
    return name.split(": ", maxsplit=1)[0] == other.split(": ", maxsplit=1)[0]
