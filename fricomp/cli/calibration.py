"""What `fricomp calibrate` does on the terminal: start, resume, record a motion."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.progress import Progress as Bar
from rich.text import Text

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
    at_rows_rate,
    calibrate,
    channels_of,
    check_feasible,
    fit_into,
    identify_recorded,
    read_motion,
    record_motion,
    travel_now,
)
from fricomp.calibration.sweep.check import calibration_checks
from fricomp.calibration.sweep.report import write_calibration_report
from fricomp.calibration.sweep.run_folder import MOTION_ALONE, RECORDING
from fricomp.calibration.sweep.sweep import Progress
from fricomp.cli.parameter_table import parameter_table
from fricomp.cli.resume import changes, refuse_other
from fricomp.cli.terminal import console, progress
from fricomp.control.ending import require_stopped, stopping_on_error
from fricomp.control.interruption import interrupt_on_ending_signals
from fricomp.errors import ParameterError, SweepAborted
from fricomp.recording import write_recording

__all__ = ["follow", "open_joint", "record_file", "resume_run", "start_run"]


def start_run(request: CalibrationRequest, out: Path, *, overwrite: bool) -> None:
    """Calibrate into a new folder, or in place of the run that is there."""
    with open_joint(request) as context:
        check_feasible(context, request.options)  # before an earlier run is thrown away
        _run(context, RunFolder.create(out, request, overwrite=overwrite))


def resume_run(out: Path, asked: CalibrationRequest, given: Collection[str] = ()) -> None:
    """Go on with the run in a folder; one that is recorded to its end is identified again, and nothing moves.

    Args:
        out: The folder.
        asked: What the command line says.
        given: Names of the options that stand there.

    Raises:
        SweepAborted: The folder holds no sweep.
        ParameterError: An option would be ignored.
    """
    folder = RunFolder.resume(out, changes(asked, given))
    refuse_other(asked, folder.request, given)
    if folder.is_motion:
        raise SweepAborted(_no_going_on(folder))
    if folder.is_recorded:
        _identify_again(folder)
        return
    with open_joint(folder.request) as context:
        _run(context, folder)


def _no_going_on(folder: RunFolder) -> str:
    """Why a motion is not resumed: it would begin in its middle, at speed, from wherever the joint is now."""
    what = folder.request.motion or "a motion"
    ended = "is recorded to its end" if folder.is_recorded else "was interrupted, and a motion begins at its beginning"
    return (
        f"{folder.path} holds a motion ({what}), not a sweep; it {ended}: identify what there is with fricomp "
        "identify, or record it anew with --motion and --overwrite"
    )


def record_file(request: CalibrationRequest, out: Path, *, overwrite: bool = False) -> None:
    """Record the motion of a request into a new folder, or in place of the run that is there."""
    wanted = read_motion(request.motion)
    if Path(request.motion).resolve() in {(out / name).resolve() for name in (RECORDING, MOTION_ALONE)}:
        raise SweepAborted(f"recording into {out} would replace the motion {request.motion}: choose another --out")
    with open_joint(request) as opened:
        context = at_rows_rate(opened, wanted)
        fit_into(wanted, travel_now(context))  # before anything moves, and before an earlier run is thrown away
        folder = RunFolder.create(out, request, overwrite=overwrite)
        alone = folder.path / MOTION_ALONE
        alone.unlink(missing_ok=True)
        channels = channels_of(context)
        with (
            folder.open_writer(context.metadata(), channels) as writer,
            _interruptible(folder, context.adapter),
            stopping_on_error(context.adapter),
        ):
            sweep = Sweep(context, writer, SweepData())
            sweep.prepare()
            distance = record_motion(sweep, wanted)
            sweep.finish()
        ((_, samples),) = sweep.data.of_kind("motion")
        write_recording(samples, alone)
        folder.note("recorded")
    _print_recorded(folder, f"{distance:.2g} {samples.metadata.position_unit}")


def _print_recorded(folder: RunFolder, distance: str) -> None:
    """Where the motion is, how well it was followed, and both uses of it."""
    alone, file = folder.path / MOTION_ALONE, folder.recording
    console().print(
        f"The motion is in {file}, and alone in {alone}; it was at most {distance} from where it was to be.\n"
        f"Diagnose it together with the first recording (fricomp diagnose OLD {alone} --out ...), or identify it "
        f"(fricomp identify {file}).",
        soft_wrap=True,
        markup=False,
    )


@contextmanager
def open_joint(request: CalibrationRequest) -> Iterator[SweepContext]:
    """The joint, open; zero torque and closed at the end, whatever happens.

    Raises:
        AdapterError: The last stop did not get through, whatever else has happened.
    """
    interrupt_on_ending_signals()
    adapter: JointAdapter = open_adapter(request.backend, request.configuration)
    with _told(adapter), adapter, stopping_on_error(adapter):
        names = [joint.name for joint in adapter.capabilities.joints]
        if request.joint and request.joint not in names:
            raise ParameterError(f"no joint {request.joint!r}; this backend has {', '.join(names)}")
        body = RigidBody(request.model, names) if request.model else None
        joint = names.index(request.joint) if request.joint else 0
        yield SweepContext(adapter, joint, request.settings, body)


@contextmanager
def _told(adapter: JointAdapter) -> Iterator[None]:
    try:
        yield
    finally:
        require_stopped(adapter)  # closing it has tried once more


@contextmanager
def _interruptible(folder: RunFolder, adapter: JointAdapter) -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        way = f"go on with fricomp calibrate --resume --out {folder.path}"
        if folder.request.motion:
            way = "the same command with --overwrite records the motion anew, from its beginning"
        stopped = "" if adapter.enabled or adapter.stop_failure else "; the joint is at zero torque"
        print(f"\nInterrupted{stopped}. What was recorded is safe in {folder.recording}: {way}", file=sys.stderr)
        raise


def _run(context: SweepContext, folder: RunFolder) -> None:
    with progress() as bar, _interruptible(folder, context.adapter):
        calibration = calibrate(context, folder, folder.request.options, follow(bar))
        context.adapter.close()
        _write(calibration, folder, bar)


def _identify_again(folder: RunFolder) -> None:
    """Identify what is on disk; no joint is opened."""
    with progress() as bar:
        follow(bar)("identifying", 0.0)
        _write(identify_recorded(folder, folder.request.options), folder, bar)


def _write(calibration: Calibration, folder: RunFolder, bar: Bar) -> None:
    """Model, network, report and run.json, and what they say in short."""
    bar.update(bar.task_ids[0], description="writing the report", completed=0.0)
    checks = calibration_checks(calibration)
    files = save_identification(calibration.estimate.result, folder.path)
    facts = {**_facts(folder), "hash of the model": files.model_sha256}
    page, pictures = write_calibration_report(calibration, checks, facts, folder.path)
    bar.stop()
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
    console().print(parameter_table(calibration.estimate.result))
    written = [files.model, files.network, page, folder.recording, folder.path / "run.json"]
    screen = console()
    for check in checks:
        if check.outcome in ("warning", "failed"):
            screen.print(f"{check.name}: {check.detail}", style="yellow")
    names = ", ".join(file.name for file in written)
    screen.print(Text.assemble("In ", (str(folder.path), "bold"), f": {names}, {len(pictures)} pictures"))


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
