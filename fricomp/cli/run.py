"""`fricomp run`: a reference motion on a joint, with and without friction compensation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricomp.cli.option.loop import DELAY, VELOCITY_FILTER, Delay, Gain, VelocityFilter, loop_option
from fricomp.cli.option.motion_log import LogFile
from fricomp.cli.option.page import Live, OpenPages
from fricomp.cli.option.panel import Overwrite, option_under, output_option
from fricomp.cli.output import say_interrupted

if TYPE_CHECKING:
    from fricomp.cli.sine_loop import LoopSetup
    from fricomp.control import ControlLoop, LoopResult
    from fricomp.control.loop.loop_log import LoopLog
    from fricomp.live.feed import LiveFeed
    from fricomp.model import FrictionModel
    from fricomp.recording import RecordingMetadata
    from fricomp.report import Chart
    from fricomp.results import Claim

app = typer.Typer(add_completion=False)

_WORSE = 1.1
"""Times the error without compensation from which one with it is told to be worse; runs differ by less."""

drive_option = option_under("Drive")
motion_option = option_under("Motion")

EPILOG = """fricomp run friction.json --out runs/run

fricomp run friction.json --backend canopen --config joints.toml --inertia 0.12 --amplitude 0.2 --out runs/run

fricomp run friction.json --live --log runs/elbow.mcap --out runs/watched"""


@app.command(epilog=EPILOG)
def run(
    models: Annotated[
        list[Path], typer.Argument(help="Model file of each joint (friction.json), in the order of the bus.")
    ],
    backend: Annotated[
        str | None, drive_option(help="Adapter: `fricomp adapters` lists them; what --config says, or sim.")
    ] = None,
    config: Annotated[Path | None, drive_option(help="Configuration of bus and joints (TOML).")] = None,
    inertia: Annotated[
        list[float], loop_option(help="Inertia at each joint [kg·m²] or [kg]; one value serves all joints.")
    ] = [0.1],  # noqa: B006
    bandwidth: Annotated[float, loop_option(help="Bandwidth of the PD position loop [Hz].")] = 5.0,
    amplitude: Annotated[float, motion_option(help="Amplitude of the sine [rad] or [m].")] = 0.2,
    frequency: Annotated[float, motion_option(help="Frequency of the sine [Hz].")] = 0.1,
    cycles: Annotated[float, motion_option(help="Number of cycles of the sine.")] = 2.0,
    rate: Annotated[float, loop_option(help="Rate of the control loop [Hz].")] = 1000.0,
    delay: Delay = DELAY,
    velocity_filter: VelocityFilter = VELOCITY_FILTER,
    gain: Gain = None,
    priority: Annotated[int, drive_option(min=0, max=99, help="FIFO priority on real hardware; 0 for none.")] = 80,
    out: Annotated[Path, output_option(help="Folder for recordings and plots.")] = Path("runs/run"),
    overwrite: Overwrite = False,
    log: LogFile = None,
    live: Live = False,
    open_report: OpenPages = False,
) -> None:
    """Follow a sine twice, without and with compensation, and show the difference.

    The joints move at once: nothing is asked first. Ctrl-C stops them at zero torque at any time; what was recorded is
    in --out.
    """
    from fricomp.adapters import open_adapter
    from fricomp.adapters.configuration import choose_adapter
    from fricomp.cli.option.motion_log import claim_log, log_runs
    from fricomp.cli.option.page import open_page, watching
    from fricomp.cli.output import answer
    from fricomp.cli.sine_loop import LoopSetup, Sine
    from fricomp.cli.terminal import console
    from fricomp.control.compensation.trust import require_usable
    from fricomp.extras import REPORT, require
    from fricomp.model import load_model
    from fricomp.result_kinds import RUN
    from fricomp.results import claim_folder

    _require_above_zero(
        inertia=inertia, bandwidth=[bandwidth], amplitude=[amplitude], frequency=[frequency], cycles=[cycles],
        rate=[rate],
    )  # fmt: skip
    _require_not_negative(delay=delay, velocity_filter=velocity_filter)
    require(*REPORT)
    friction = [load_model(path) for path in models]
    for model in friction:
        require_usable(model)
    chosen = choose_adapter(backend, config)
    title = f"Run of {', '.join(model.joint for model in friction)}"
    with (
        claim_log(log, overwrite=overwrite),
        log_runs(log, friction) as runs,
        claim_folder(out, RUN, overwrite=overwrite, inputs=models) as claim,
        watching(title, live=live, opened=open_report) as feed,
    ):
        sine = Sine(amplitude, frequency, cycles)
        results: dict[str, LoopResult] = {}
        for name in ("without", "with"):
            with _kept(claim, name) as record, open_adapter(*chosen) as adapter:
                setup = LoopSetup(adapter, friction, inertia, (bandwidth, delay, velocity_filter), 1.0 / rate)
                compensators = setup.choose_compensators(gain) if name == "with" else None
                loop = setup.build_loop(sine, compensators, priority)
                record(loop.log, setup.read_metadata())
                runs.append(loop.log)
                results[name] = _follow(name, setup, loop, sine.duration, feed)
        figures = _write_results(results, friction, out, 1.0 / rate)
    _print(figures, friction, results["with"])
    answer({"joints": [model.joint for model in friction], "out": out, **figures})
    console().print(f"Recordings, plots, figures and run.html in {out}")
    open_page(out / "run.html", wanted=open_report)


def _follow(name: str, setup: LoopSetup, loop: ControlLoop, duration: float, feed: LiveFeed | None) -> LoopResult:
    """Run the loop for its time [s], watched where there is a live page.

    Raises:
        SafetyTrip: The safety gate stopped it.
    """
    from fricomp.errors import SafetyTrip

    if feed is not None:
        feed.attach(setup.adapter)
        feed.show_duration(f"{name} compensation", duration)
    result = loop.run(duration)
    try:
        result.raise_if_tripped()
    except SafetyTrip as trip:
        raise SafetyTrip(f"{trip}{setup.explain_standing(result)}") from trip
    return result


def _write_results(
    results: dict[str, LoopResult], models: list[FrictionModel], out: Path, period: float
) -> dict[str, dict[str, Any]]:
    """Write plots and figures; gives the figures."""
    from fricomp.control.loop.loop_charts import build_run_page, run_chart, timing_chart
    from fricomp.report import draw_png, write_report
    from fricomp.whole_file import write_json

    logs = {f"{name} compensation": result.log for name, result in results.items()}
    charts: list[Chart] = []
    for joint, model in enumerate(models):
        chart = run_chart(logs, joint, (model.position_unit, model.torque_unit))
        charts.append(chart)
    charts.append(timing_chart(results["with"].log, period))
    for chart in charts:
        draw_png(chart, out / f"{chart.name}.png")
    figures = {name: _figures(result) for name, result in results.items()}
    write_json(out / "figures.json", figures)
    write_report(build_run_page(models, figures, charts, list(results["with"].real_time.refused)), out / "run.html")
    return figures


def _require_above_zero(**options: list[float]) -> None:
    """Refuse what would divide by zero, or move nothing, before a drive is opened."""
    from fricomp.errors import ParameterError

    for name, values in options.items():
        for value in values:
            if not 0.0 < value < inf:
                raise ParameterError(f"--{name} must be above 0 and finite, got {value:g}")


def _require_not_negative(**options: float) -> None:
    from fricomp.errors import ParameterError

    for name, value in options.items():
        if not 0.0 <= value < inf:
            raise ParameterError(f"--{name.replace('_', '-')} must be finite and at least 0, got {value:g}")


@contextmanager
def _kept(claim: Claim, name: str) -> Iterator[Callable[[LoopLog, list[RecordingMetadata]], None]]:
    """Write the log that is handed over once the adapter is closed, however the motion has ended."""
    given: list[tuple[LoopLog, list[RecordingMetadata]]] = []
    try:
        yield lambda log, metadata: given.append((log, metadata))
    except KeyboardInterrupt:
        say_interrupted(f"; the joints are at zero torque. What was recorded is in {claim.folder}")
        raise
    finally:
        _write_log(given, claim, name)


def _write_log(given: list[tuple[LoopLog, list[RecordingMetadata]]], claim: Claim, name: str) -> None:
    from fricomp.recording import write_recording
    from fricomp.results import plain_name

    if name == "without":
        claim.clear()

    for log, metadata in given:
        for joint, facts in enumerate(metadata if len(log) > 1 else ()):
            write_recording(
                log.recording(joint, facts), claim.folder / f"{name}_compensation_{plain_name(facts.joint)}.csv"
            )


def _figures(result: LoopResult) -> dict[str, Any]:
    import numpy as np

    from fricomp.cli.sine_loop import REST

    moving = result.log.time > REST
    error = (result.log.signal("position_reference") - result.log.signal("position"))[moving]
    return {
        "rms_error": np.sqrt(np.mean(error**2, axis=0)).tolist(),
        "largest_error": np.max(np.abs(error), axis=0).tolist(),
        "cycles": result.cycles,
        "skipped": result.skipped,
        "rejected": result.rejected,
        "timing": result.log.timing()._asdict(),
        "granted": result.real_time.granted,
        "refused": result.real_time.refused,
    }


def _list_worse(figures: dict[str, dict[str, Any]], models: list[FrictionModel]) -> list[str]:
    """Joints whose motion a compensation has made clearly worse."""
    pairs = zip(models, figures["without"]["rms_error"], figures["with"]["rms_error"], strict=True)
    return [model.joint for model, without, compensated in pairs if compensated > _WORSE * without]


def _print(figures: dict[str, dict[str, Any]], models: list[FrictionModel], result: LoopResult) -> None:
    from fricomp.cli.terminal import Table, console

    table = Table("joint", "RMS error without", "with compensation", "change")
    rows = zip(models, figures["without"]["rms_error"], figures["with"]["rms_error"], strict=True)
    for model, without, compensated in rows:
        unit = f"m{model.position_unit}"
        change = f"{compensated / without - 1.0:+.0%}" if without > 0.0 else "–"
        table.add_row(model.joint, f"{1e3 * without:.3f} {unit}", f"{1e3 * compensated:.3f} {unit}", change)
    out, timing = console(), result.log.timing()
    out.print(table)
    for joint in _list_worse(figures, models):
        out.print(
            f"Careful: with compensation joint {joint} follows worse than without. Its model is of another joint or "
            "state: identify it anew, and do not use this one.",
            soft_wrap=True,
            markup=False,
        )
    out.print(
        f"A cycle takes {1e6 * timing.busy_p50:.0f} µs (99.9 %: {1e6 * timing.busy_p999:.0f} µs); "
        f"lateness {1e6 * timing.lateness_p50:.0f} µs (99.9 %: {1e6 * timing.lateness_p999:.0f} µs); "
        f"{result.skipped} cycles skipped."
    )
    for refused in result.real_time.refused:
        out.print(f"- {refused}")
