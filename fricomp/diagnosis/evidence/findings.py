"""The stage that computes all evidence for one case: trial, comparison with what was given, and where it sits."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..inputs.track import FloatArray
from ..joint.solver import Fit
from ..record.result import Distinguishability, Location, Quantity, RowSeries
from ..search.explanation import Explanation
from ..search.order import compute_order_spectrum
from ..search.preparation import Baseline
from ..search.tone import Tone
from .agreement import prefer_agreeing
from .alias import compare_effects
from .case import Case, compare_given, fit_given, share_between
from .comparison import PLAIN, UNEXPLAINED, Comparison, Shift, Tolerances, compute_tolerances
from .confirmation import Confirmation, confirm
from .effect_evidence import EffectEvidence, measure_effects
from .form_strays import compute_form_strays
from .gates import find_vibration, matters, measure_left, stands_out
from .in_place import BODY_SHIFTS, prefer_in_place
from .location import collect_rows, find_change_points, locate, map_excess
from .refitted import RefittedJoint
from .repetition import refit_parts
from .settings import GATES, LOCATION
from .trial import Trial, leave_out_unfit, put_to_trial
from .velocity_lag import find_velocity_lag


@dataclass(frozen=True)
class Findings:
    """What speaks for and against each answer to a case. The verdict is a function of this.

    Attributes:
        case: The case.
        trial: The best explanation on held-out data.
        unknown: Whether something is missing that no accepted effect covers.
        refitted: The joint that the verdict is about: the base with the chosen effects, or alone.
        base: Its parameters with their intervals.
        late_action: How long after its stamp the torque acts in it.
        held: Errors on held-out data.
        noise_ratio: Residual of the base over its noise.
        comparison: What differs from the given simulation and friction.
        shift_shares: Part of the repetitions in which each difference from what was given comes again, by name.
        parts: Part of each of those shifts in what putting them right explains; empty where the errors are counted from
            the refitted base, and not from the base as given.
        effects: Evidence for each chosen effect.
        lag: A recorded velocity that lags behind the position; None where it does not.
        location: Where the mismatch sits.
        series: Rows before and after.
        maps: Excess energy over bins of each quantity.
        orders: Energy that a ripple of each order explains.
        change_points: Times at which the size of the residual changes [s], for each recording.
        told_apart: Which effects these recordings could tell apart.
    """

    case: Case
    trial: Trial
    unknown: bool
    refitted: RefittedJoint
    base: dict[str, Quantity]
    late_action: Quantity
    held: Confirmation
    noise_ratio: float
    comparison: Comparison
    shift_shares: Mapping[str, float]
    parts: tuple[float, ...]
    effects: tuple[EffectEvidence, ...]
    lag: Shift | None
    location: Location
    series: tuple[RowSeries, ...]
    maps: dict[str, dict[str, FloatArray]]
    orders: dict[str, FloatArray]
    change_points: tuple[tuple[float, ...], ...]
    told_apart: Distinguishability

    @property
    def chosen(self) -> Explanation | None:
        """The explanation that held-out data bear out."""
        return self.trial.chosen

    @property
    def as_given(self) -> bool:
        """Whether the errors are counted from the base with parameters as given."""
        return bool(self.parts)

    @property
    def rmse_refitted(self) -> float:
        """Held-out error of the base refitted."""
        return self.held.rmse_after if self.as_given else self.held.rmse_before

    @property
    def named_ripple(self) -> tuple[float, float] | None:
        """Order and amplitude of the ripple that the rows show, of torque or of friction; None where they show none."""
        for one in sorted(self.effects, key=lambda effect: -effect.energy):
            values = {name: quantity.value for name, quantity in one.parameters.items()}
            named = one.overtone_of is None and bool(one.effect.wave)
            if named and {"order", "sine", "cosine"} <= set(values):
                return values["order"], float(np.hypot(values["sine"], values["cosine"]))
        return None

    @property
    def detent_order(self) -> float | None:
        """Order over the position of torque and friction that one unknown part ripples [1/rad] or [1/m]."""
        best = self.case.found.best
        return best.common_order if self.unknown and best is not None else None

    @property
    def left_aside(self) -> tuple[float, float] | None:
        """What is left beyond the noise and matters too little to be looked for [N·m] or [N], and its part of the
        Coulomb torque; None where there is nothing."""
        loud = self.case.baseline.noise_ratio > GATES.audible
        return measure_left(self.case.baseline) if self.chosen is None and not self.unknown and loud else None

    @property
    def foreign_curve(self) -> bool:
        """Whether what is unknown follows the speed in a curve that is none of the catalogue."""
        best = self.case.found.best
        return self.unknown and best is not None and best.foreign_curve


def prefer_simulation(case: Case) -> Case:
    """The case with a best explanation that agrees with the simulation, where one fits as well."""

    def differs(one: Explanation, tolerances: Tolerances) -> bool:
        shifts = compare_given(case, RefittedJoint.refit(case.baseline, one), tolerances).shifts
        return any(shift.name in BODY_SHIFTS for shift in shifts)  # friction that is uneven is so with any of them

    found = prefer_agreeing(case.baseline, case.found, case.rigid, differs)
    return prefer_in_place(replace(case, found=found))


def collect_findings(case: Case) -> Findings:
    """Compute what speaks for and against each answer."""
    case, trial = _put_to_trial(case)
    baseline, found = case.baseline, case.found
    chosen = trial.chosen
    tone = find_vibration(baseline) if chosen is None and matters(baseline) else None
    covered = trial.failed is not None
    unknown = chosen is None and (
        tone is not None or (not trial.immaterial and stands_out(found, baseline, covered=covered))
    )
    refitted = RefittedJoint.refit(baseline, chosen)
    tolerances = _choose_tolerances(baseline, trial, unknown)
    comparison = compare_given(case, refitted, tolerances)
    deviations = refitted.widen_deviations(tolerances.known, compute_form_strays(baseline, chosen, refitted))
    names = [shift.name for shift in comparison.shifts]
    given = None if unknown or chosen is not None else fit_given(case, names)
    before = given or baseline.fit if chosen is None or chosen.before is None else chosen.before
    held = trial.held or confirm(baseline, baseline.structure, baseline.fit, case.seed, given=given)
    series = _collect_series(baseline, before, refitted)
    effects, location = measure_effects(case, chosen, refitted, series) if chosen is not None else ((), {})
    if chosen is None and (unknown or given is not None):
        location = _locate_unknown(series, tone) if unknown else _locate_moved(series)
    spectrum = compute_order_spectrum(
        baseline.problem, baseline.structure.contexts, baseline.fit.residual, baseline.basis
    )
    return Findings(
        case=case,
        trial=trial,
        unknown=unknown,
        refitted=refitted,
        base=refitted.list_base(case.unit, case.position_unit, deviations),
        late_action=refitted.measure_late_action(deviations),
        held=held,
        noise_ratio=_compute_noise_ratio(baseline, trial, held),
        comparison=comparison,
        shift_shares=_repeat_comparison(case, chosen, tolerances),
        parts=() if given is None else share_between(case, names),
        effects=effects,
        lag=find_velocity_lag(case.recordings),
        location=location,
        series=series,
        maps=map_excess(series, case.bands),
        orders={"order": spectrum.order, "energy": spectrum.energy},
        change_points=find_change_points(series),
        told_apart=compare_effects(baseline, found.first),
    )


def _put_to_trial(case: Case) -> tuple[Case, Trial]:
    """The trial of the best explanation, or of the best one without what has turned out to be none, if that holds."""
    trial = put_to_trial(case.baseline, case.found, case.seed)
    without = leave_out_unfit(case.baseline, case.found, trial)
    if without is None:
        return case, trial
    other = prefer_simulation(replace(case, found=without))
    second = put_to_trial(other.baseline, other.found, other.seed)
    return (case, trial) if second.chosen is None else (other, second)


def _repeat_comparison(case: Case, chosen: Explanation | None, tolerances: Tolerances) -> Mapping[str, float]:
    """Compare again with what was given, on parts of the rows; nothing where nothing was given."""
    if case.rigid is None and case.friction is None:
        return {}
    joints = refit_parts(case.baseline, chosen)
    names = [shift.name for joint in joints for shift in compare_given(case, joint, tolerances).shifts]
    return {name: count / len(joints) for name, count in Counter(names).items()}


def _choose_tolerances(baseline: Baseline, trial: Trial, unknown: bool) -> Tolerances:
    """How far refitted parameters stray: what is unknown biases them most, a named effect less."""
    if trial.chosen is not None and trial.held is not None:
        return compute_tolerances(_compute_noise_ratio(baseline, trial, trial.held))
    return UNEXPLAINED if unknown else PLAIN


def _compute_noise_ratio(baseline: Baseline, trial: Trial, held: Confirmation) -> float:
    """Residual of the base over its noise; what was named may have been taken for a part of that."""
    ratio = baseline.noise_ratio
    return ratio if trial.chosen is None else max(ratio, held.rmse_before / held.noise_floor)


def _collect_series(baseline: Baseline, before: Fit, after: RefittedJoint) -> tuple[RowSeries, ...]:
    """Rows of the base, as given or refitted, and of the joint that the verdict is about."""
    problem, weights = baseline.problem, baseline.nulls.weights
    runs = [problem.compute_rows(baseline.structure.observe(problem, before.theta))]
    same = after.fit is before
    runs.append(runs[0] if same else problem.compute_rows(after.structure.observe(problem, after.fit.theta)))
    corrected = [[r - m for r, m in zip(rows, weights.mean, strict=True)] for rows in runs]
    return collect_rows(baseline, corrected[0], corrected[1])


def _locate_unknown(series: tuple[RowSeries, ...], tone: Tone | None) -> Location:
    """Where most of what exceeds the noise sits, and the frequency of a vibration."""
    excess = [np.maximum((one.before / one.spread) ** 2 - 1.0, 0.0) for one in series]
    location = locate(series, excess, rows=LOCATION.neighbours)
    if tone is not None:
        location["frequency"] = [(tone.frequency - tone.width, tone.frequency + tone.width)]
    return location


def _locate_moved(series: tuple[RowSeries, ...]) -> Location:
    """Where putting moved parameters right shows."""
    energy = [np.maximum(one.before**2 - one.after**2, 0.0) / one.spread**2 for one in series]
    return locate(series, energy, rows=LOCATION.neighbours)
