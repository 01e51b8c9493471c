"""The amplitude at which an effect has the wanted strength, found by bisection."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import DiagnosisError

from .effect import Change, Effect, Form
from .effects import EFFECTS
from .refit import compute_enr, compute_left_after_refit
from .spec import STRENGTHS
from .trial import Outcome, Trial

_TOLERANCE, _ATTEMPTS, _TINY = 0.05, 12, 1e-9


@dataclass(frozen=True)
class Concealed:
    """One effect as it stands in a case.

    Attributes:
        effect: Which.
        form: Its functional form.
        amplitude: In the form's unit.
        change: What it sets.
        enr: Effect-to-noise ratio, alone.
        torque: Concealed torque, alone [N·m], shape (n_samples,).
    """

    effect: Effect
    form: Form
    amplitude: float
    change: Change
    enr: float
    torque: NDArray[np.float64]


def _measure(trial: Trial, effect: Effect, change: Change) -> tuple[float, Outcome]:
    outcome = trial.run(change)
    return compute_enr(compute_left_after_refit(outcome.torque, outcome.rows, effect.against)), outcome


def conceal(trial: Trial, index: int, name: str) -> Concealed:
    """Find the amplitude with the wanted strength, at most the largest that real joints have."""
    effect, target = EFFECTS[name], STRENGTHS[trial.spec.strength]
    form = _choose_form(effect, trial.spec.form if index == 0 else None, trial.effect_rng(index))

    def change_at(amplitude: float) -> Change:
        rng = trial.effect_rng(index)
        rng.random()  # the number that chose the form
        return form.build(trial.scene, amplitude, rng)

    lower, high = effect.floor(trial.scene), effect.typical(trial.scene)[1]
    upper, enr, outcome = _find_largest_stable(trial, effect, change_at, high)
    amplitude = upper
    for _ in range(_ATTEMPTS):
        if abs(np.log(max(enr, _TINY) / target)) < _TOLERANCE or (amplitude == upper and enr < target):
            break
        if enr > target:
            upper = amplitude
        else:
            lower = amplitude
        if upper < 1.02 * lower:  # even the weakest is stronger than wanted
            break
        proposed = amplitude * target / max(enr, _TINY)  # most effects are proportional to their amplitude
        amplitude = proposed if lower < proposed < upper else float(np.sqrt(lower * upper))
        enr, outcome = _measure(trial, effect, change_at(amplitude))
    return Concealed(effect, form, amplitude, change_at(amplitude), enr, outcome.torque)


def conceal_again(trial: Trial, index: int, before: Concealed) -> Concealed:
    """The effect of an earlier trial in this one: the joint stays, what happens over time is of this motion."""
    rng = trial.effect_rng(index)
    rng.random()  # the number that chose the form
    built = before.form.build(trial.scene, before.amplitude, rng)
    joint = before.change  # a stop, for one, stays where it is when the range of the motion is another
    change = replace(built, plant=joint.plant, sensing=joint.sensing, belief=joint.belief, parameters=joint.parameters)
    enr, outcome = _measure(trial, before.effect, change)
    return Concealed(before.effect, before.form, before.amplitude, change, enr, outcome.torque)


def _find_largest_stable(
    trial: Trial, effect: Effect, change_at: Callable[[float], Change], high: float
) -> tuple[float, float, Outcome]:
    """The largest amplitude, from `high` down, with which the loop still follows its reference."""
    for _ in range(_ATTEMPTS):
        try:
            enr, outcome = _measure(trial, effect, change_at(high))
        except DiagnosisError:
            high *= 0.6
        else:
            return high, enr, outcome
    raise DiagnosisError(f"{effect.name} makes the loop of {trial.spec} unstable at any amplitude: draw another seed")


def _choose_form(effect: Effect, name: str | None, rng: np.random.Generator) -> Form:
    drawn = effect.forms[int(rng.random() * len(effect.forms))]
    if name is None:
        return drawn
    named = [form for form in effect.forms if form.name == name]
    if not named:
        raise DiagnosisError(f"{effect.name} has no form {name!r}: valid are {', '.join(f.name for f in effect.forms)}")
    return named[0]
