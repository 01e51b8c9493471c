"""The whole way: sweep, friction points, identification."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from fricomp.control.loop.ending import stopping_on_error
from fricomp.errors import IdentificationError
from fricomp.model import FrictionModel
from fricomp.overview import Overview, Shown, format_range
from fricomp.report import draw_figure

from ..identification import IdentificationResult, identify
from ..identification.design import plan_informative_speeds
from .analysis.analysis import HALF_DIFFERENCE, SweepAnalysis, analyse_sweep
from .analysis.block import SweepData
from .analysis.curve import friction_curve
from .estimate import Estimate, IdentificationSettings, estimate_friction
from .feasibility import check_feasible
from .motion.context import SweepContext
from .motion.sign_check import SignCheck
from .planning.plan import SweepPlan, first_again, plan_plateaus, plan_velocities, top_speed
from .planning.speed import FALLING_BRANCH, dense_around
from .request import CalibrationOptions
from .run_folder import RunFolder
from .sweep import Progress, Sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "Calibration",
    "calibrate",
    "channels_of",
    "identify_recorded",
    "mean_relative_deviation",
    "stribeck_velocity",
]

# Plateaus of one round of an adaptive sweep, and the most rounds.
ROUND = 16
ROUNDS = 6


@dataclass(frozen=True, repr=False)
class Calibration(Shown):
    """The outcome of a calibration.

    Attributes:
        data: Blocks of the recording.
        analysis: Friction points and checks.
        estimate: The identified friction.
        late_cycles: Cycles of the loop that were missed.
        signs: What a low torque did; None where the drive takes none.
    """

    data: SweepData
    analysis: SweepAnalysis
    estimate: Estimate
    late_cycles: int
    signs: SignCheck | None

    @property
    def result(self) -> IdentificationResult:
        """The identification: parameters, intervals, status, network."""
        return self.estimate.result

    @property
    def model(self) -> FrictionModel:
        """The friction model, to be given to a `Compensator` or to `fricomp.save_model`."""
        return self.result.model

    def headline(self) -> str:
        """Joint, status and number of plateaus."""
        used, all_points = len(self.analysis.steady), len(self.analysis.points)
        return f"of joint {self.analysis.metadata.joint}: {self.result.status}, {used} of {all_points} plateaus"

    def overview(self) -> Overview:
        """Parameters with their 95 % intervals, and how the sweep went."""
        found, analysis = self.result.overview(), self.analysis
        unit = analysis.metadata.position_unit
        speeds = [abs(point.velocity) for point in analysis.points]
        swept = (
            f"{len(analysis.steady)} of {len(analysis.points)} plateaus used, at "
            f"{format_range((min(speeds), max(speeds)), f'{unit}/s')}; friction is the {analysis.torque_source}."
        )
        spread = f"Mean standard deviation of the parameters: {mean_relative_deviation(self.estimate):.2%}."
        return replace(
            found,
            title=f"Calibration of joint {analysis.metadata.joint}",
            sentences=(
                *found.sentences,
                swept,
                spread,
                *((f"{self.late_cycles} cycles came late.",) if self.late_cycles else ()),
            ),
        )

    def plot(self) -> Figure:
        """Draw the plateaus and the identified curve with its 95 % band, with matplotlib.

        Raises:
            MissingExtraError: matplotlib is not installed.
        """
        return draw_figure(friction_curve(self.analysis, self.result, network=False))


def calibrate(
    context: SweepContext,
    folder: RunFolder,
    options: CalibrationOptions,
    report: Progress = lambda text, done: None,
) -> Calibration:
    """Sweep a joint and identify its friction; the recording grows in the run's folder.

    The joint ends at zero torque; what goes wrong stops it before the recording is closed.

    Raises:
        FricompError: See `Sweep`, `analyse_sweep` and `estimate_friction`; what was recorded stays.
    """
    check_feasible(context, options)
    data = folder.load_data()
    with folder.open_writer(context.metadata(), channels_of(context)) as writer, stopping_on_error(context.adapter):
        sweep = Sweep(context, writer, data, report)
        sweep.prepare()
        sweep.warm_up()
        first = sweep.runner.meanwhile(sweep.plan_first_pass)
        sweep.run_plan(first)
        number = _refine(sweep, options, len(first.plateaus))
        _repeat_first(sweep, first, number)
        sweep.measure_breakaways(float(first.speeds[0]))
        sweep.finish()
    late, signs = sweep.runner.late_cycles, sweep.sign_check
    folder.note("recorded", late_cycles=late, signs=None if signs is None else asdict(signs))
    report("identifying", 0.0)
    return _identify(sweep.data, options, late, signs)


def identify_recorded(folder: RunFolder, options: CalibrationOptions) -> Calibration:
    """Identify from a sweep that is on disk to its end; nothing moves.

    Raises:
        FricompError: See `analyse_sweep` and `estimate_friction`.
    """
    late, signs = folder.results.get("late_cycles", 0), folder.results.get("signs")
    return _identify(folder.load_data(), options, int(late), None if signs is None else SignCheck(**signs))


def _identify(data: SweepData, options: CalibrationOptions, late_cycles: int, signs: SignCheck | None) -> Calibration:
    analysis = _analyse(data, options)
    estimate = estimate_friction(analysis, options.identification)
    return Calibration(data, analysis, estimate, late_cycles, signs)


def channels_of(context: SweepContext) -> tuple[str, ...]:
    """Columns of the recording: what the joint reports and what was asked of it."""
    command = ("torque_command",) if context.choose_mode() == "torque" else ()
    load = ("load_torque",) if context.body is not None else ()
    return ("time", "position", "torque", "velocity", "velocity_reference", *command, *load)


def _analyse(data: SweepData, options: CalibrationOptions) -> SweepAnalysis:
    return analyse_sweep(data, normal_load=options.normal_load, gravity_unknown=options.gravity_unknown)


def _refine(sweep: Sweep, options: CalibrationOptions, number: int) -> int:
    """Further plateaus where the first pass says they tell most; returns the number of the next."""
    if options.adaptive:
        return _adapt(sweep, options, number)
    settings = sweep.context.settings
    if not settings.dense_count or settings.speeds:
        return number
    bend = sweep.runner.meanwhile(lambda: stribeck_velocity(_analyse(sweep.data, options)))
    if bend is None:
        return number
    low, high = (edge * bend for edge in FALLING_BRANCH)
    if high <= top_speed(sweep.travel, settings):
        speeds = dense_around(bend, settings.dense_count)
        plan = sweep.runner.meanwhile(lambda: plan_plateaus(speeds, sweep.travel, settings, first=number))
        sweep.run_plan(plan, f"denser from {low:.3g} to {high:.3g}")
        number += len(plan.plateaus)
    return number


def _repeat_first(sweep: Sweep, first: SweepPlan, number: int) -> None:
    """The first speed again, both ways, as far as it is not on disk; `number` is the least that a plateau may have.

    Of a sweep that is gone on with, `number` may be less than what is on disk, where it would count as visited.
    """
    seen = {label.velocity for label, _ in sweep.data.of_kind("plateau") if label.is_first_again}
    plan = first_again(first, max(number, sweep.data.next_plateau))
    missing = tuple(plateau for plateau in plan.plateaus if plateau.velocity not in seen)
    sweep.run_plan(replace(plan, plateaus=missing), "first speed again")


def stribeck_velocity(analysis: SweepAnalysis) -> float | None:
    """Where the curve bends, roughly [rad/s] or [m/s]; None if the first pass does not show it."""
    points = analysis.steady
    law = "symmetric_stribeck" if analysis.torque_source == HALF_DIFFERENCE else "stribeck"
    try:
        result = identify([p.velocity for p in points], [p.torque for p in points], method="least_squares", law=law)
    except IdentificationError:
        return None
    found = [v for name, v in result.parameters.items() if name.endswith("stribeck_velocity")]
    slowest, fastest = min(abs(p.velocity) for p in points), max(abs(p.velocity) for p in points)
    bend = float(np.exp(np.mean(np.log(found))))
    return bend if slowest < bend < 0.3 * fastest else None


def _adapt(sweep: Sweep, options: CalibrationOptions, number: int) -> int:
    """Rounds of plateaus at the speeds that shrink the covariance most, until it is small enough.

    Those on disk count; a round that was interrupted is not ended but planned anew from what it has shown.
    """
    last = number + ROUNDS * ROUND
    number = max(number, sweep.data.next_plateau)
    while number < last:
        deviation, plan = sweep.runner.meanwhile(partial(_plan_round, sweep, options, number))
        if plan is None:
            break
        sweep.run_plan(plan, f"adaptive, now {100.0 * deviation:.2g} %")
        number += len(plan.plateaus)
    return number


def _plan_round(sweep: Sweep, options: CalibrationOptions, first: int) -> tuple[float, SweepPlan | None]:
    """Mean relative deviation of what there is, and the next round, numbered from `first`; None if it is enough."""
    settings, top = sweep.context.settings, top_speed(sweep.travel, sweep.context.settings)
    quick = IdentificationSettings(method="least_squares", noise=options.identification.noise)
    estimate = estimate_friction(_analyse(sweep.data, options), quick)
    deviation = mean_relative_deviation(estimate)
    if deviation <= options.accuracy:
        return deviation, None
    slowest = float(sweep.plan_first_pass().speeds[0])
    design = plan_informative_speeds(estimate.result.model, top, ROUND, "absolute", slowest=slowest)
    velocities = np.repeat(design.velocity, design.plateaus)
    return deviation, plan_velocities(velocities, sweep.travel, settings, first=first)


def mean_relative_deviation(estimate: Estimate) -> float:
    """Mean over the parameters of standard deviation over value [1]."""
    result = estimate.result
    return float(np.mean([result.standard_deviations[n] / result.parameters[n] for n in result.parameter_names]))
