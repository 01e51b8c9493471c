"""What `fricomp calibrate` does on the terminal: start, resume, record a motion."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rich.progress import Progress as Bar
from rich.text import Text

from fricomp.api.calibrate import record_sweep
from fricomp.calibration.sweep import (
    Calibration,
    CalibrationRequest,
    RunFolder,
    Sweep,
    SweepData,
    at_rows_rate,
    calibrate,
    channels_of,
    fit_into,
    identify_recorded,
    open_joint,
    read_motion,
    record_motion,
    travel_now,
    write_run,
)
from fricomp.calibration.sweep.run_folder import MOTION_ALONE, RECORDING
from fricomp.calibration.sweep.sweep import Progress
from fricomp.cli.calibration.resume import changes, refuse_other
from fricomp.cli.option.motion_log import log_calibration, log_unfinished
from fricomp.cli.option.page import open_page, watching
from fricomp.cli.output import answer, say_interrupted
from fricomp.cli.parameter_table import end_as_usable, is_usable, parameter_table, print_verdict
from fricomp.cli.terminal import console, progress
from fricomp.control.loop.ending import stopping_on_error
from fricomp.errors import AdapterError, SweepAborted
from fricomp.recording import write_recording
from fricomp.untrusted import find_place

if TYPE_CHECKING:
    from fricomp.live.feed import LiveFeed


@dataclass(frozen=True)
class Shown:
    """What is shown in a browser, and in viewers of logs.

    Attributes:
        live: The joint as it moves.
        opened: That page, and the report at the end.
        log: File for viewers; None for none.
    """

    live: bool = False
    opened: bool = False
    log: Path | None = None


_UNSEEN = Shown()


def start_run(request: CalibrationRequest, out: Path, shown: Shown = _UNSEEN, *, overwrite: bool) -> None:
    """Calibrate into a new folder, or in place of the run that is there."""
    with _watching(request, shown) as feed, progress() as bar, _interruptible(out, log=shown.log) as begun:
        calibration, folder = record_sweep(
            request, out, overwrite=overwrite, progress=begun(follow(bar, feed)), watch=feed
        )
        usable = _write(calibration, folder, bar, shown)
    end_as_usable(usable=usable)


def _watching(request: CalibrationRequest, shown: Shown) -> AbstractContextManager[LiveFeed | None]:
    whose = f" of joint {request.joint}" if request.joint else ""
    title = f"Calibration{whose} ({request.backend})"
    return watching(title, live=shown.live, opened=shown.opened)


def resume_run(out: Path, asked: CalibrationRequest, given: Collection[str], shown: Shown) -> None:
    """Go on with the run in a folder; one that is recorded to its end is identified again, and nothing moves.

    Args:
        out: The folder.
        asked: What the command line says.
        given: Names of the options that stand there.
        shown: What is shown in a browser.

    Raises:
        SweepAborted: The folder holds no sweep.
        ParameterError: An option would be ignored.
    """
    folder = RunFolder.resume(out, changes(asked, given))
    refuse_other(asked, folder.request, given)
    if folder.is_motion:
        raise SweepAborted(_no_going_on(folder))
    if folder.is_recorded:
        _identify_again(folder, shown)
        return
    with _watching(folder.request, shown) as feed, progress() as bar, _interruptible(out, log=shown.log) as begun:
        with open_joint(folder.request, feed) as context:
            calibration = calibrate(context, folder, folder.request.options, begun(follow(bar, feed)))
        usable = _write(calibration, folder, bar, shown)
    end_as_usable(usable=usable)


def _no_going_on(folder: RunFolder) -> str:
    """Why a motion is not resumed: it would begin in its middle, at speed, from wherever the joint is now."""
    what = folder.request.motion or "a motion"
    ended = "is recorded to its end" if folder.is_recorded else "was interrupted, and a motion begins at its beginning"
    return (
        f"{folder.path} holds a motion ({what}), not a sweep; it {ended}: identify what there is with fricomp "
        "identify, or record it anew with --motion and --overwrite"
    )


def record_file(request: CalibrationRequest, out: Path, shown: Shown = _UNSEEN, *, overwrite: bool = False) -> None:
    """Record the motion of a request into a new folder, or in place of the run that is there."""
    wanted = read_motion(request.motion)
    if find_place(request.motion) in {find_place(out / name) for name in (RECORDING, MOTION_ALONE)}:
        raise SweepAborted(f"recording into {out} would replace the motion {request.motion}: choose another --out")
    with (
        _watching(request, shown) as feed,
        _interruptible(out, request.motion) as begun,
        open_joint(request, feed) as opened,
    ):
        context = at_rows_rate(opened, wanted)
        fit_into(wanted, travel_now(context))  # before anything moves, and before an earlier run is thrown away
        folder = RunFolder.create(out, request, overwrite=overwrite)
        alone = folder.path / MOTION_ALONE
        alone.unlink(missing_ok=True)
        channels = channels_of(context)
        with (
            folder.open_writer(context.metadata(), channels) as writer,
            stopping_on_error(context.adapter),
        ):
            sweep = Sweep(context, writer, SweepData(), begun(_report_nothing if feed is None else feed.show_progress))
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
def _interruptible(out: Path, motion: str = "", log: Path | None = None) -> Iterator[Callable[[Progress], Progress]]:
    """A motion that Ctrl-C may end: it then says what is left of it, and how to go on.

    Gives what wraps a report of progress: only what was begun has something to say.
    """
    seen: list[str] = []

    def begin(report: Progress) -> Progress:
        def follow_and_note(text: str, done: float) -> None:
            seen.append(text)
            report(text, done)

        return follow_and_note

    try:
        yield begin
    except KeyboardInterrupt:  # the joint is closed, and its last stop got through
        _say_interrupted(out, motion, "; the joint is at zero torque", _log_begun(seen, log, out))
        raise
    except (AdapterError, SweepAborted) as error:
        where = _log_begun(seen, log, out)
        if isinstance(error.__cause__, KeyboardInterrupt):
            _say_interrupted(out, motion, "", where)
        elif seen and not motion and (out / RECORDING).exists():
            print(f"What was recorded is safe in {where}: {_how_to_resume(out)}", file=sys.stderr)
        raise


def _log_begun(seen: Sequence[str], log: Path | None, out: Path) -> str:
    """Where what was recorded is, the log of it written too; empty where nothing was begun."""
    return f"{out / RECORDING}{log_unfinished(log, out / RECORDING)}" if seen else ""


def _how_to_resume(out: Path) -> str:
    return f"go on with fricomp calibrate --resume --out {out}"


def _say_interrupted(out: Path, motion: str, stopped: str, where: str) -> None:
    if not where:
        say_interrupted(f"{stopped}. Nothing was recorded.")
        return
    way = _how_to_resume(out)
    if motion:
        way = "the same command with --overwrite records the motion anew, from its beginning"
    say_interrupted(f"{stopped}. What was recorded is safe in {where}: {way}")


def _report_nothing(text: str, done: float) -> None:
    pass


def _identify_again(folder: RunFolder, shown: Shown) -> None:
    """Identify what is on disk; no joint is opened."""
    with progress() as bar:
        follow(bar)("identifying", 0.0)
        usable = _write(identify_recorded(folder, folder.request.options), folder, bar, shown)
    end_as_usable(usable=usable)


def _write(calibration: Calibration, folder: RunFolder, bar: Bar, shown: Shown) -> bool:
    """Model, network, report and run.json, and what they say in short; whether the model is usable."""
    bar.update(bar.task_ids[0], description="writing the report", completed=0.0)
    run = write_run(calibration, folder)
    log_calibration(shown.log, calibration)
    bar.stop()
    result = calibration.estimate.result
    screen = console()
    print_verdict(screen, result)
    screen.print(parameter_table(result))
    for check in run.checks:
        if check.outcome in ("warning", "failed"):
            screen.print(f"{check.name}: {check.detail}", style="yellow")
    deviations = result.standard_deviations
    answer(
        {
            "usable": is_usable(result),
            "status": str(result.status),
            "message": result.message,
            "joint": result.model.joint,
            "parameters": {
                name: {
                    "value": value,
                    "standard_deviation": deviations[name],
                    "at_bound": name in result.at_bound,
                }
                for name, value in result.parameters.items()
            },
            "units": result.model.units(),
            "checks": [asdict(check) for check in run.checks],
            "files": run.files,
        }
    )
    names = ", ".join(file.name for file in run.files)
    screen.print(Text.assemble("In ", (str(folder.path), "bold"), f": {names}, {len(run.pictures)} pictures"))
    open_page(folder.path / "report.html", wanted=shown.opened)
    return is_usable(result)


def follow(bar: Bar, feed: LiveFeed | None = None) -> Progress:
    """What shows progress on a bar, and on the live page where there is one."""
    task = bar.add_task("starting", total=1.0)

    def report(text: str, done: float) -> None:
        bar.update(task, description=text, completed=done)
        if feed is not None:
            feed.show_progress(text, done)

    return report
