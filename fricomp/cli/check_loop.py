"""`fricomp check-loop`: is this loop safe with this compensation, before it runs on a drive?"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from fricomp.cli.option.loop import DELAY, VELOCITY_FILTER, Delay, Gain, VelocityFilter, loop_option
from fricomp.cli.option.panel import Overwrite, option_under, output_option
from fricomp.cli.output import answer

if TYPE_CHECKING:
    from fricomp.control import DriveLimits, LoopDynamics
    from fricomp.control.loop.loop_check import LoopCheck
    from fricomp.model import FrictionModel

app = typer.Typer(add_completion=False)

drive_option = option_under("Drive")

EPILOG = """fricomp check-loop runs/elbow/friction.json --bandwidth 5

fricomp check-loop friction.json --inertia 0.1 --bandwidth 5 --torque-limit 5 --torque-rate 250

fricomp check-loop friction.json --inertia 0.1 --stiffness 98.7 --damping 6.28 --gain 0.8"""


@app.command(name="check-loop", epilog=EPILOG)
def check_loop(
    model: Annotated[Path, typer.Argument(help="Model file of the joint (friction.json).")],
    inertia: Annotated[
        float | None, loop_option(help="Inertia at the joint [kg·m²] or [kg]; the model's own if left out.")
    ] = None,
    bandwidth: Annotated[float | None, loop_option(help="Bandwidth of a critically damped PD loop [Hz].")] = None,
    stiffness: Annotated[float | None, loop_option(help="Proportional gain [N·m/rad] or [N/m].")] = None,
    damping: Annotated[float | None, loop_option(help="Derivative gain [N·m·s/rad] or [N·s/m].")] = None,
    delay: Delay = DELAY,
    velocity_filter: VelocityFilter = VELOCITY_FILTER,
    gain: Gain = None,
    source: Annotated[
        Literal["reference", "blend", "measured"] | None,
        loop_option(help="Where the compensator takes the direction of motion from; chosen if left out."),
    ] = None,
    period: Annotated[float, loop_option(help="Control period [s].")] = 1e-3,
    quantum: Annotated[float, loop_option(help="Step of the measured velocity [rad/s] or [m/s].")] = 0.0,
    torque_limit: Annotated[
        float | None, drive_option(help="Largest torque of drive or safety gate, for the simulation [N·m] or [N].")
    ] = None,
    torque_rate: Annotated[float | None, drive_option(help="Fastest change of that torque [N·m/s] or [N/s].")] = None,
    velocity_limit: Annotated[
        float | None,
        drive_option(help="Velocity limit of the safety gate [rad/s] or [m/s]; the model's highest speed if left out."),
    ] = None,
    out: Annotated[Path | None, output_option(help="Folder for the chart.")] = None,
    overwrite: Overwrite = False,
) -> None:
    """Say how far a loop with this compensation is from a limit cycle, by describing function and by simulation.

    Exit status 1 where the margin is under 15 %.
    """
    from fricomp.cli.terminal import console
    from fricomp.control import DriveLimits, LoopDynamics, PositionController
    from fricomp.control import check_loop as check
    from fricomp.control.compensation.choice import choose_settings
    from fricomp.errors import ParameterError
    from fricomp.model import load_model
    from fricomp.results import claim_single_files

    if velocity_limit is not None and not 0.0 < velocity_limit < float("inf"):
        raise ParameterError(f"--velocity-limit must be above 0 and finite, got {velocity_limit:g}")
    if bandwidth is not None and (stiffness is not None or damping is not None):
        raise ParameterError("give either --bandwidth, or --stiffness and --damping")
    friction = load_model(model)
    if inertia is None:
        if friction.dynamics is None:
            raise ParameterError(f"{model} holds no inertia: give --inertia")
        inertia = friction.dynamics.inertia
    if bandwidth is not None:
        controller = PositionController.from_bandwidth([inertia], bandwidth)
        stiffness, damping = controller.stiffness[0], controller.damping[0]
    if stiffness is None or damping is None:
        raise ParameterError("the loop's gains are needed: --bandwidth, or --stiffness and --damping")
    loop = LoopDynamics(inertia, stiffness, damping, delay, velocity_filter)
    given = {name: value for name, value in (("gain", gain), ("source", source)) if value is not None}
    settings = choose_settings(friction, loop=loop, velocity_quantum=quantum, **given)
    limits = {"torque": torque_limit, "torque_rate": torque_rate}
    drive = DriveLimits(**{name: value for name, value in limits.items() if value is not None})
    charts = [] if out is None else [out / "gain-scan.png"]
    with claim_single_files(charts, overwrite=overwrite):
        result = check(friction, loop, settings, period=period, velocity_quantum=quantum, drive=drive)
        fastest = settings.velocity_range[1] if velocity_limit is None else velocity_limit
        travels = list(_travels(loop, drive, fastest, period, friction.position_unit))
        answer(_as_answer(result, friction, travels))
        _print_check(result, friction, travels)
        for chart in charts:
            from fricomp.control.loop.loop_charts import gain_scan_chart
            from fricomp.report import draw_png

            draw_png(gain_scan_chart(result, f"joint {friction.joint}"), chart)
            console().print(f"Chart in {chart}")
    if not result.is_safe:
        raise typer.Exit(1)


def _as_answer(result: LoopCheck, friction: FrictionModel, travels: list[tuple[str, str]]) -> dict[str, Any]:
    """What a program wants of the check; distances in the model's unit of position, gains without one."""
    names = ("predicted_limit", "simulated_limit", "margin", "safe_gain", "sticks_without", "drift", "unsettled_from")
    return {
        "safe": result.is_safe,
        "joint": friction.joint,
        "position_unit": friction.position_unit,
        "gain": result.settings.gain,
        **{name: getattr(result, name) for name in names},
        "travel": dict(travels),
        "notes": result.settings.notes,
        "left_out": result.left_out,
    }


def _print_check(result: LoopCheck, friction: FrictionModel, travels: list[tuple[str, str]]) -> None:
    from fricomp.cli.terminal import Table, console

    settings = result.settings
    unit = f"{friction.position_unit}/s"
    table = Table("what", "value", title=f"Loop of joint {friction.joint}")
    table.add_row("direction from", f"{settings.source}, measured share {settings.measured_share:g}")
    table.add_row("gain of the compensation", f"{settings.gain:.3f}")
    table.add_row("smoothing", f"{settings.smoothing:.4g} {unit}")
    table.add_row("limit cycle starts at gain, predicted", _gain(result.predicted_limit))
    table.add_row("limit cycle starts at gain, simulated", _gain(result.simulated_limit))
    margin = "none found up to 2.5 times this gain" if result.margin == float("inf") else f"{result.margin:.0%}"
    table.add_row("margin", margin)
    table.add_row("largest gain with 15 % margin", f"{result.safe_gain:.2f}" if result.safe_gain else "none")
    table.add_row("without compensation", "sticks and slips" if result.sticks_without else "runs smoothly")
    table.add_row("drift after a stop", f"{result.drift:.2g} {friction.position_unit}")
    table.add_row("thrown off its reference", _thrown(result, friction.position_unit))
    table.add_row("drive in the simulation", _limits(result.drive, friction.torque_unit))
    for failure, travel in travels:
        table.add_row(failure, travel)
    screen = console()
    screen.print(table)
    for note in settings.notes:
        screen.print(f"- {note}")
    if result.left_out:
        screen.print(f"- not part of this check: {', '.join(result.left_out)}")
    if result.is_safe:
        screen.print("Safe.")
    else:
        screen.print("Not safe: less than 15 % margin, or the joint does not come to rest.", style="bold")


def _travels(
    loop: LoopDynamics, drive: DriveLimits, velocity: float, period: float, unit: str
) -> Iterator[tuple[str, str]]:
    """How far the joint comes before the gate stops it, with each failure; the gate's limits are needed for that."""
    from fricomp.control.gate.failure_travel import FAILURES, bound_travel
    from fricomp.control.gate.limits import JointLimits

    if drive.torque == float("inf"):
        yield "travel until the gate stops it", "not bounded: give --torque-limit"
        return
    rate = min(drive.torque_rate, drive.torque / period)
    found = bound_travel(loop, JointLimits(drive.torque, rate, velocity), period)
    for name in FAILURES:
        far = f"at most {found[name]:.3g} {unit}" if found[name] < float("inf") else "not bounded"
        yield f"travel until the gate stops it: {name}", f"{far}, at a velocity limit of {velocity:.3g} {unit}/s"


def _thrown(result: LoopCheck, unit: str) -> str:
    """From how far off its reference the joint no longer settles, and whether the compensation has a part in it."""
    if result.unsettled_from == float("inf"):
        return f"settles from all that was tried, up to 0.5 {unit}"
    also = "also" if result.unsettled_without <= result.unsettled_from else "but not"
    return f"keeps oscillating from {result.unsettled_from:g} {unit} on, {also} without compensation"


def _limits(drive: DriveLimits, unit: str) -> str:
    torque = "torque not limited" if drive.torque == float("inf") else f"at most {drive.torque:g} {unit}"
    rate = "rate not limited" if drive.torque_rate == float("inf") else f"{drive.torque_rate:g} {unit}/s"
    return f"{torque}, {rate}"


def _gain(limit: float) -> str:
    return "none found" if limit == float("inf") else f"{limit:.2f}"
