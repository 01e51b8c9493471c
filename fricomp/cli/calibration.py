"""What `fricomp calibrate` does on the terminal: start, resume, plan only, record a motion."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from math import floor, log10
from pathlib import Path

from rich.markup import escape
from rich.progress import Progress as Bar
from rich.table import Table

from fricomp.adapters import JointAdapter, open_adapter
from fricomp.calibration.identification import save_identification
from fricomp.calibration.sweep import (
    Calibration,
    CalibrationRequest,
    RigidBody,
    RunFolder,
    Sweep,
    SweepContext,
    SweepData,
    assume_friction,
    calibrate,
    channels_of,
    default_speeds,
    expected_deviations,
    loop_period,
    plan_plateaus,
    read_motion,
    record_motion,
    travel_of,
)
from fricomp.calibration.sweep.check import calibration_checks
from fricomp.calibration.sweep.report import write_calibration_report
from fricomp.calibration.sweep.sweep import Progress
from fricomp.cli.terminal import console, progress
from fricomp.control.interruption import interrupt_on_ending_signals
from fricomp.errors import ParameterError

__all__ = ["dry_run_plan", "follow", "open_joint", "record_file", "resume_run", "start_run"]


def start_run(request: CalibrationRequest, out: Path, *, overwrite: bool) -> None:
    """Calibrate into a new folder, or in place of the run that is there."""
    with open_joint(request) as context:
        _run(context, RunFolder.create(out, request, overwrite=overwrite))


def resume_run(out: Path) -> None:
    """Go on with the run in a folder."""
    folder = RunFolder.resume(out)
    with open_joint(folder.request) as context:
        _run(context, folder)


def record_file(request: CalibrationRequest, motion: Path, out: Path) -> None:
    """Record a motion from a file into a new folder."""
    wanted = read_motion(motion)
    with open_joint(request) as context:
        folder = RunFolder.create(out, request)
        with folder.open_writer(context.metadata(), channels_of(context)) as writer, _interruptible(folder):
            sweep = Sweep(context, writer, SweepData())
            sweep.prepare()
            record_motion(sweep, wanted)
            sweep.finish()
        folder.note("recorded")
    console().print(f"The motion is in [bold]{folder.recording}[/bold]; identify it with fricomp identify.")


def dry_run_plan(request: CalibrationRequest) -> None:
    """Print the plan, its travel, its duration and the accuracy to expect; nothing is energised."""
    with open_joint(request) as context:
        adapter, index, settings = context.adapter, context.joint, context.settings
        declared, limits = adapter.capabilities.joints[index], adapter.options.limits[index]
        travel = travel_of(declared, limits.position, limits.velocity, 0.0)
        plan = plan_plateaus(default_speeds(travel, settings), travel, settings)
        rate = 1.0 / loop_period(adapter, settings, context.choose_mode())
    unit, screen = ("rad" if declared.motion == "rotary" else "m"), console()
    screen.print(f"[bold]Plan for joint {declared.name}[/bold] ({request.backend}), nothing has moved")
    low, high = plan.reach
    screen.print(
        f"  travel    {low:.3g} to {high:.3g} {unit}, of {travel.low:.3g} to {travel.high:.3g} that may be used"
    )
    speeds = ", ".join(f"{speed:.3g}" for speed in plan.speeds)
    screen.print(f"  speeds    {speeds} {unit}/s, {len(plan.plateaus)} plateaus in both directions, shuffled")
    extra = 2.0 * settings.tare + settings.warm_up + 6.0 * settings.breakaway_positions
    dense = 0.0 if settings.speeds else plan.duration / len(plan.speeds) * settings.dense_count
    screen.print(
        f"  duration  about {(plan.duration + dense + extra) / 60:.1f} min: sweep {plan.duration:.0f} s, denser where "
        f"the curve bends {dense:.0f} s, sensor zero, warm-up and breakaway {extra:.0f} s"
    )
    assumption = assume_friction(float(plan.speeds[-1]), limits.torque, rate)
    table = Table("parameter", "expected standard deviation", title_justify="left", box=None, pad_edge=False)
    for name, deviation in expected_deviations(plan, assumption).items():
        table.add_row(f"  {name}", f"{deviation:.2%}")
    forward = assumption.law.parameters()
    screen.print(
        f"  accuracy  at best (Cramér-Rao bound, first pass alone), for an assumed joint with Coulomb torque "
        f"{forward['stribeck.forward.coulomb_torque']:.3g}, static torque "
        f"{forward['stribeck.forward.static_torque']:.3g} {declared.torque_unit}, Stribeck velocity "
        f"{forward['stribeck.forward.stribeck_velocity']:.3g} {unit}/s, noise {assumption.torque_noise:.2g} a sample:"
    )
    screen.print(table)


@contextmanager
def open_joint(request: CalibrationRequest) -> Iterator[SweepContext]:
    """The joint, open; zero torque and closed at the end, whatever happens."""
    interrupt_on_ending_signals()
    adapter: JointAdapter = open_adapter(request.backend, request.configuration)
    with adapter:
        names = [joint.name for joint in adapter.capabilities.joints]
        if request.joint and request.joint not in names:
            raise ParameterError(f"no joint {request.joint!r}; this backend has {', '.join(names)}")
        body = RigidBody(request.model, names) if request.model else None
        joint = names.index(request.joint) if request.joint else 0
        yield SweepContext(adapter, joint, request.settings, body)


@contextmanager
def _interruptible(folder: RunFolder) -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        print(
            f"\nInterrupted; the joint is at zero torque. What was recorded is safe in {folder.recording}: go on with "
            f"fricomp calibrate --resume --out {folder.path}",
            file=sys.stderr,
        )
        raise


def _run(context: SweepContext, folder: RunFolder) -> None:
    with progress() as bar, _interruptible(folder):
        calibration = calibrate(context, folder, folder.request.options, follow(bar))
        context.adapter.close()
        bar.update(bar.task_ids[0], description="writing the report", completed=0.0)
        checks = calibration_checks(calibration)
        files = save_identification(calibration.estimate.result, folder.path)
        facts = {**_facts(folder), "hash of the model": files.model_sha256}
        page, pictures = write_calibration_report(calibration, checks, facts, folder.path)
    result = calibration.estimate.result
    folder.note(
        "done",
        parameters=result.parameters,
        standard_deviations=result.standard_deviations,
        identification=str(result.status),
        checks={check.name: f"{check.outcome}: {check.detail}" for check in checks},
        recording_points=len(calibration.analysis.points),
        model_sha256=files.model_sha256,
    )
    _print_result(calibration)
    written = [files.model, files.network, page, folder.recording, folder.path / "run.json"]
    screen = console()
    for check in checks:
        if check.outcome in ("warning", "failed"):
            screen.print(f"[yellow]{check.name}: {check.detail}[/yellow]")
    screen.print(f"In [bold]{folder.path}[/bold]: {', '.join(file.name for file in written)}, {len(pictures)} pictures")


def follow(bar: Bar) -> Progress:
    """What shows progress on a bar."""
    task = bar.add_task("starting", total=1.0)

    def report(text: str, done: float) -> None:
        bar.update(task, description=text, completed=done)

    return report


def _facts(folder: RunFolder) -> dict[str, str]:
    request = folder.request
    chosen = {"backend": request.backend, "configuration": str(request.configuration), "model": request.model or "none"}
    settings = {name: str(getattr(request.settings, name)) for name in request.settings.__dataclass_fields__}
    return chosen | settings | {f"version of {name}": version for name, version in folder.versions.items()}


def _print_result(calibration: Calibration) -> None:
    """A small table: one row a parameter, one column a direction, with half of the 95 % interval."""
    result = calibration.estimate.result
    sides: dict[str, dict[str, str]] = {}
    for name in result.parameter_names:
        reach, value = result.interval(name).upper - result.parameters[name], result.parameters[name]
        decimals = max(0, min(9, 1 - floor(log10(reach)))) if reach > 0.0 else 6
        *group, last = name.split(".")
        rows = sides.setdefault(group[-1] if len(group) > 1 else "value", {})
        rows[f"{last.replace('_', ' ')} [{result.model.units()[name]}]"] = (
            f"{value:.{decimals}f} ± {reach:.{decimals}f}"
        )
    table = Table(title=f"Friction of joint {calibration.analysis.metadata.joint}, ± 95 %", title_justify="left")
    table.add_column("parameter")
    for side in sides:
        table.add_column(side, justify="right")
    for label in dict.fromkeys(label for rows in sides.values() for label in rows):
        table.add_row(escape(label), *(rows.get(label, "") for rows in sides.values()))
    console().print(table)
