"""One concealed case: a joint, a motion, effects at a wanted strength, and the recording of it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .effect import Change, Scene, merge
from .excitation import settle
from .refit import build_rows, compute_enr, compute_left_after_refit, find_intervals
from .sensing import Sensors
from .spec import CaseSpec
from .strength import Concealed, conceal, conceal_again
from .trial import Outcome, Trial


@dataclass(frozen=True)
class Case:
    """A generated case; the recording starts at `start`, samples before it are the lead-in.

    Attributes:
        spec: What was asked for.
        scene: Joint and motion.
        concealed: The effects.
        belief: Fields of the user's simulation.
        outcome: Of the run with all effects.
        enr: Of all effects together.
        left: What survives the refit over the noise, shape (n_rows,).
        intervals: Times at which most of it does [s].
        start: First sample of the recording.
        temperature: Of the joint [°C], shape (n_samples,).
        change: All effects.
        sensors: Without effects.
    """

    spec: CaseSpec
    scene: Scene
    concealed: tuple[Concealed, ...]
    belief: dict[str, float]
    outcome: Outcome
    enr: float
    left: NDArray[np.float64]
    intervals: list[tuple[float, float]]
    start: int
    temperature: NDArray[np.float64]
    change: Change
    sensors: Sensors


def generate(spec: CaseSpec) -> Case:
    """Make the case; the same spec always makes the same one.

    Raises:
        DiagnosisError: The drawn loop is unstable with the effect in it.
    """
    trial = Trial(spec)
    return _finish(trial, tuple(conceal(trial, index, name) for index, name in enumerate(spec.effects)))


def record_again(case: Case, reference: NDArray[np.float64]) -> Case:
    """The same joint with the same effects on another motion.

    Args:
        case: The first case.
        reference: Position [rad] and velocity [rad/s] at 1 kHz, starting at rest; shape (n_samples, 2).
    """
    trial = Trial(case.spec, settle(reference))
    return _finish(trial, tuple(conceal_again(trial, i, each) for i, each in enumerate(case.concealed)))


def _finish(trial: Trial, concealed: tuple[Concealed, ...]) -> Case:
    change = Change()
    for each in concealed:
        change = merge(change, each.change)
    outcome = trial.run(change)
    references = {each.effect.against for each in concealed} or {"refit"}
    against = next(name for name in ("nothing", "friction", "refit") if name in references)
    left = compute_left_after_refit(outcome.torque, outcome.rows, against)
    everywhere = build_rows(outcome.motion, outcome.sensed, trial.joint, step=1)
    return Case(
        spec=trial.spec,
        scene=trial.scene,
        concealed=concealed,
        belief={**trial.shift, **change.belief},
        outcome=outcome,
        enr=compute_enr(left),
        left=left,
        intervals=find_intervals(compute_left_after_refit(outcome.torque, everywhere, against), everywhere.step),
        start=trial.start,
        temperature=trial.temperature(change)[trial.start :],
        change=change,
        sensors=trial.sensors,
    )
