"""What `fricomp calibrate --dry-run` prints: what would move, how far, how fast and for how long; nothing moves."""

import numpy as np
from rich.text import Text

from fricomp.calibration.sweep import (
    CalibrationRequest,
    SweepContext,
    SweepPlan,
    assume_friction,
    check_feasible,
    expected_deviations,
    fit_into,
    loop_period,
    open_joint,
    read_motion,
    travel_now,
)
from fricomp.calibration.sweep.planning.plan import Travel, move_speed
from fricomp.calibration.sweep.planning.profile import move_profile
from fricomp.calibration.sweep.weight import HungWeight, plan_passes
from fricomp.cli.calibration.torque_constant import N_PASSES
from fricomp.cli.terminal import Table, console


def print_sweep_plan(request: CalibrationRequest) -> None:
    """The plan of a sweep and the accuracy to expect."""
    with open_joint(request) as context:
        plan = check_feasible(context, request.options)
        _print_head(request, context)
        _print_sweep(context, plan)
        _print_accuracy(context, plan)


def print_motion_plan(request: CalibrationRequest) -> None:
    """The plan of a motion from a file."""
    motion = read_motion(request.motion)
    with open_joint(request) as context:
        travel = travel_now(context)
        start = fit_into(motion, travel)
        _print_head(request, context)
        unit, (low, high) = _unit(context), motion.reach
        farthest = max(start - travel.low, travel.high - start)
        way = move_profile(farthest, move_speed(travel), context.settings.ramp).duration
    _print_travel(start + low, start + high, travel, unit)
    place = (
        "where the column position of the file says"
        if motion.start is not None
        else "in the middle: the file has no column position"
    )
    console().print(f"  start     {round(start, 6) + 0.0:.4g} {unit}, {place}")
    _print_speeds(float(np.max(np.abs(motion.velocity))), travel, unit)
    screen, tare = console(), 2.0 * context.settings.tare
    screen.print(
        f"  duration  {motion.time[-1]:.4g} s, after the zero of the torque sensor, the check of signs and the way to "
        f"its start, up to {tare + way:.0f} s more"
    )


def print_torque_constant_plan(request: CalibrationRequest, weight: HungWeight) -> None:
    """The plan of finding the torque constant with a hung weight."""
    with open_joint(request) as context:
        plan = plan_passes(context, N_PASSES)
        _print_head(request, context)
        unit = _unit(context)
    _print_travel(plan.travel.low, plan.travel.high, plan.travel, unit)
    screen = console()
    screen.print(
        f"  passes    {plan.n_passes} to and fro at {plan.speed:.3g} {unit}/s without the weight, as many with "
        f"{weight.mass:g} kg at {weight.lever:g} m, up to {weight.moment:.3g} N·m"
    )
    _print_speeds(plan.speed, plan.travel, unit)
    screen.print(f"  duration  about {2.0 * plan.duration / 60.0:.1f} min, and the time to hang the weight")


def _print_head(request: CalibrationRequest, context: SweepContext) -> None:
    name = context.adapter.capabilities.joints[context.joint].name
    console().print(Text.assemble((f"Plan for joint {name}", "bold"), f" ({request.backend}), nothing has moved"))


def _print_travel(low: float, high: float, travel: Travel, unit: str) -> None:
    console().print(
        f"  travel    {low:.3g} to {high:.3g} {unit}, of {travel.low:.3g} to {travel.high:.3g} that may be used"
    )


def _print_speeds(fastest: float, travel: Travel, unit: str) -> None:
    console().print(
        f"  fastest   {max(fastest, move_speed(travel)):.3g} {unit}/s; from place to place at up to "
        f"{move_speed(travel):.3g} {unit}/s"
    )


def _print_sweep(context: SweepContext, plan: SweepPlan) -> None:
    unit, settings, screen = _unit(context), context.settings, console()
    _print_travel(*plan.reach, plan.travel, unit)
    speeds = ", ".join(f"{speed:.3g}" for speed in plan.speeds)
    screen.print(f"  speeds    {speeds} {unit}/s, {len(plan.plateaus)} plateaus in both directions, shuffled")
    _print_speeds(float(plan.speeds[-1]), plan.travel, unit)
    extra = 2.0 * settings.tare + settings.warm_up + 6.0 * settings.breakaway_positions
    dense = 0.0 if settings.speeds else plan.duration / len(plan.speeds) * settings.dense_count
    screen.print(
        f"  duration  about {(plan.duration + dense + extra) / 60:.1f} min: sweep {plan.duration:.0f} s, denser where "
        f"the curve bends {dense:.0f} s, sensor zero, warm-up and breakaway {extra:.0f} s"
    )


def _print_accuracy(context: SweepContext, plan: SweepPlan) -> None:
    declared = context.adapter.capabilities.joints[context.joint]
    rate = 1.0 / loop_period(context.adapter, context.settings, context.choose_mode())
    limit = context.adapter.options.limits[context.joint].torque
    assumption, screen = assume_friction(float(plan.speeds[-1]), limit, rate), console()
    table = Table("parameter", "expected standard deviation", title_justify="left", box=None, pad_edge=False)
    for name, deviation in expected_deviations(plan, assumption).items():
        table.add_row(f"  {name}", f"{deviation:.2%}" if np.isfinite(deviation) else "cannot be determined")
    forward = assumption.law.parameters()
    screen.print(
        f"  accuracy  at best (Cramér-Rao bound, first pass alone), for an assumed joint with Coulomb torque "
        f"{forward['stribeck.forward.coulomb_torque']:.3g}, static torque "
        f"{forward['stribeck.forward.static_torque']:.3g} {declared.torque_unit}, Stribeck velocity "
        f"{forward['stribeck.forward.stribeck_velocity']:.3g} {_unit(context)}/s, noise {assumption.torque_noise:.2g} "
        "a sample:"
    )
    screen.print(table)


def _unit(context: SweepContext) -> str:
    return "rad" if context.adapter.capabilities.joints[context.joint].motion == "rotary" else "m"
