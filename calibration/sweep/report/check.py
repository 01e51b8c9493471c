"""What was checked on the way, with a verdict each."""

from collections import Counter

import numpy as np

from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.report import Check, Outcome

from ...identification import Status
from ...identification.report.chart import REACH
from ..analysis.analysis import HALF_DIFFERENCE, SweepAnalysis
from ..analysis.steadiness import REASONS
from ..calibrate import Calibration
from ..motion.sign_check import SignCheck

__all__ = ["calibration_checks", "compensation_check"]

# Share of the plateaus that may be rejected without a warning [1].
MANY_REJECTED = 0.2
# Standard errors beyond which a change is one, and the fraction of the friction below which it does not matter.
SIGNIFICANT = 3.0
NEGLIGIBLE = 0.01
# Friction in motion below this fraction of the breakaway torque is hardly a joint's own [1].
COMPENSATED = 0.08
# Torque that a drive adds in the direction of motion, as a fraction of friction, that is more than a scale error [1].
ASSISTED = 0.1
BREAKAWAY_AGREES = 0.05
MODEL_AGREES = 0.03


def calibration_checks(calibration: Calibration) -> tuple[Check, ...]:
    """All checks of a calibration."""
    analysis = calibration.analysis
    checks = [
        _check_signs(calibration.signs),
        _check_offset(analysis),
        _check_plateaus(analysis),
        _check_drift(analysis),
        *_check_breakaway(calibration),
        compensation_check(analysis),
        _check_rigid_body(analysis),
        _check_age(analysis),
        _check_unit(analysis),
        _check_convergence(calibration),
        _fit(calibration),
        _check_timing(calibration),
    ]
    return tuple(check for check in checks if check is not None)


def _check_signs(signs: SignCheck | None) -> Check:
    if signs is None:
        return Check("Signs and scales", "note", "not checked: the drive takes no torque commands")
    ratios = [
        f"{what} reads {ratio:.3g} of what it should"
        for what, ratio in (("velocity", signs.velocity_ratio), ("torque", signs.torque_ratio))
        if ratio is not None
    ]
    said = "; ".join((f"moved {signs.moved:+.3g} under {signs.torque:+.3g}", *ratios))
    return Check("Signs and scales", "passed", said)


def _check_offset(analysis: SweepAnalysis) -> Check:
    offset, unit = analysis.offset, analysis.metadata.torque_unit
    if offset.deviation == 0.0:
        return Check(
            "Zero of the torque sensor", "warning", "not measured: an offset shifts both directions oppositely"
        )
    return Check(
        "Zero of the torque sensor", "passed", f"{offset.value:+.3g} ± {REACH * offset.deviation:.1g} {unit}, taken off"
    )


def _check_plateaus(analysis: SweepAnalysis) -> Check:
    rejected, total = analysis.rejected, len(analysis.points)
    if not rejected:
        return Check("Plateaus", "passed", f"all {total} settled and slid steadily")
    why = Counter(REASONS[p.verdict] for p in rejected)
    reasons = ", ".join(f"{count} {reason}" for reason, count in why.most_common())
    speeds = ", ".join(f"{v:.3g}" for v in sorted({round(p.velocity, 6) for p in rejected}))
    outcome: Outcome = "warning" if len(rejected) > MANY_REJECTED * total else "note"
    return Check("Plateaus", outcome, f"{len(rejected)} of {total} rejected ({reasons}), at {speeds}")


def _check_drift(analysis: SweepAnalysis) -> Check | None:
    if not analysis.drift:
        return None
    level = float(np.median([abs(p.torque) for p in analysis.steady])) if analysis.steady else 1.0
    worst = max(analysis.drift, key=lambda d: abs(d.change))
    said = f"first speed again after {worst.elapsed:.0f} s: {worst.change:+.2g} ± {REACH * worst.deviation:.1g} "
    said += analysis.metadata.torque_unit
    moved = abs(worst.change) > max(SIGNIFICANT * worst.deviation, NEGLIGIBLE * level)
    return Check("Drift", "warning" if moved else "passed", said + (": warm up longer" if moved else ""))


def _check_breakaway(calibration: Calibration) -> list[Check]:
    found, analysis, model = [], calibration.analysis, calibration.estimate.result.model
    sides = [(1, "Breakaway, forward"), (-1, "Breakaway, reverse")]
    if analysis.torque_source == HALF_DIFFERENCE:
        sides = [(1, "Breakaway, mean of both directions")]
    for direction, name in sides:
        static = analysis.static_torque(direction)
        if static is None or not analysis.steady:
            continue
        slowest = min(abs(p.velocity) for p in analysis.steady)
        curve = abs(float(model.torque(direction * 1e-3 * slowest, normal_load=analysis.mean_load)))
        gap = static.value / curve - 1.0
        said = f"{static.value:.4g} {analysis.metadata.torque_unit} measured, {curve:.4g} from the sweep ({gap:+.1%})"
        found.append(Check(name, "passed" if abs(gap) < BREAKAWAY_AGREES else "warning", said))
    return found


def compensation_check(analysis: SweepAnalysis) -> Check | None:
    """Whether the drive already compensates friction, which would then be done twice."""
    name, steady = "Compensation in the drive", analysis.steady
    if not steady:
        return None
    friction = float(np.median([p.torque * np.sign(p.velocity) for p in steady]))
    assistance = analysis.assistance
    if assistance is not None and abs(assistance.value) > max(ASSISTED * abs(friction), 3.0 * assistance.deviation):
        return Check(
            name,
            "warning",
            f"the drive adds {assistance.value:+.3g} {analysis.metadata.torque_unit} in the direction of motion to "
            "what it is told: switch its own friction compensation off and calibrate again, or friction is "
            "compensated twice",
        )
    static = max((s.value for d in (1, -1) if (s := analysis.static_torque(d)) is not None), default=0.0)
    if friction < COMPENSATED * static or friction <= 0.0:
        return Check(
            name,
            "warning",
            f"friction in motion ({friction:.3g}) is next to nothing beside breakaway ({static:.3g}): the drive seems "
            "to compensate friction already; switch that off and calibrate again",
        )
    seen = "nothing added to the command" if assistance is not None else "no sign of it"
    return Check(name, "passed", seen)


def _check_rigid_body(analysis: SweepAnalysis) -> Check | None:
    fit = analysis.rigid_body
    if not fit.motions:
        return None
    said = (
        f"measured over modelled torque {fit.scale:.3f} ± {REACH * fit.scale_deviation:.1g} in {fit.motions} fast "
        f"motions; torque signal {1e3 * fit.lag:.2g} ms behind the position, taken off"
    )
    wrong = abs(fit.scale - 1.0) > max(MODEL_AGREES, SIGNIFICANT * fit.scale_deviation)
    return Check("Rigid-body model", "warning" if wrong else "passed", said)


def _check_age(analysis: SweepAnalysis) -> Check | None:
    """How old the torque is, where gravity is known from the mean of both directions only."""
    gravity = analysis.gravity
    if gravity is None or not analysis.steady:
        return None
    level = float(np.median([abs(p.torque) for p in analysis.steady]))
    unknown = gravity.lag_deviation * max(abs(p.load_rate) for p in analysis.steady)
    age = f"{1e3 * gravity.lag:.2g} ± {1e3 * REACH * gravity.lag_deviation:.1g} ms"
    if gravity.is_measured or unknown < NEGLIGIBLE * level:
        return Check("Age of the torque", "passed", f"{age} behind the position, taken off along gravity's slope")
    return Check(
        "Age of the torque",
        "warning",
        f"not to be told from these plateaus and taken as {age}: along gravity's slope that leaves ± "
        f"{REACH * unknown:.2g} {analysis.metadata.torque_unit} of friction open at speed, which is in the intervals; "
        "visit more high --speeds, or give a --model",
    )


def _check_unit(analysis: SweepAnalysis) -> Check | None:
    unit = analysis.metadata.torque_unit
    if unit in ("N·m", "N"):
        return None
    return Check(
        "Unit of torque",
        "note",
        f"everything is in {unit}, the actuator's own unit, in which the model is also applied, so that an error of "
        "the torque constant cancels; for newton metres hang a known weight (--torque-constant)",
    )


def _check_convergence(calibration: Calibration) -> Check:
    result = calibration.estimate.result
    outcome: Outcome = "passed" if result.status == Status.CONVERGED else "warning"
    if find_doubt_in_status(result.status, "") is not None:
        outcome = "failed"
    said = f"{result.message}; {result.distance_to_optimum:.2g} standard deviations from the likelihood optimum"
    return Check("Identification", outcome, said)


def _fit(calibration: Calibration) -> Check:
    estimate = calibration.estimate
    level = float(np.median(estimate.deviation))
    scale = float(np.max(np.abs([p.torque for p in estimate.used])))
    unit = calibration.analysis.metadata.torque_unit
    outcome: Outcome = "passed" if level < 0.05 * scale else "warning"
    return Check("Scatter about the curve", outcome, f"{level:.2g} {unit}, {level / scale:.2%} of the largest friction")


def _check_timing(calibration: Calibration) -> Check:
    late = calibration.late_cycles
    return Check("Timing", "passed" if late == 0 else "note", f"{late} cycles of the loop missed")
