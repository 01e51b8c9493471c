"""The parts of the study of tracking, each as figures for machines and a section for people."""

from collections.abc import Callable, Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

from fricomp.control import DriveLimits, check_loop
from fricomp.control.loop.loop_charts import gain_scan_chart
from fricomp.control.loop.loop_check import LoopCheck
from fricomp.report import Chart, Section, Table

from ...stand_in import SensorSettings, StandIn, default_joint, default_limits
from ..kit.outcome import StudyOutcome
from .case import TrackingCase, run_standstill
from .charts import close_loop_chart, robustness_chart, tracking_charts
from .joint import JOINTS, PERIOD, TrackedJoint, loop_of
from .robustness import compute_robustness
from .study import run_study

Step = Callable[[], None]


class TrackingPart(NamedTuple):
    """One part of the study.

    Attributes:
        figures: In SI; anything that JSON can hold.
        section: Table, then charts.
    """

    figures: Any
    section: Section


def join_parts(parts: Mapping[str, TrackingPart]) -> StudyOutcome:
    """One outcome of all parts that were studied."""
    summary = "Tracking on the stand-in joint, with and without friction compensation, and where it wins and loses."
    figures = {name: part.figures for name, part in parts.items()}
    return StudyOutcome("Tracking", (summary,), figures, tuple(part.section for part in parts.values()))


def study_sines(amplitudes: Sequence[float], bandwidths: Sequence[float], step: Step) -> TrackingPart:
    """Track sines without compensation, with tanh-Coulomb-viscous, Stribeck and the default, on every joint."""
    rows, figures, cells = [], [], []
    for row in run_study(amplitudes, bandwidths):
        base = row.figures["none"]
        changes = [row.change(method) for method in row.figures if method != "none"]
        rows.append(row)
        figures.append(
            {"joint": row.joint.name, "amplitude": row.amplitude, "bandwidth": row.bandwidth}
            | {name: {m: getattr(one, name) for m, one in row.figures.items()} for name in ("rms", "reversal_rms")}
        )
        head = (row.joint.title, f"{row.bandwidth:g} Hz", f"{row.amplitude:g} rad")
        without = f"{1e3 * base.rms:.2f} / {1e3 * base.reversal_rms:.2f}"
        cells.append((*head, without, *(f"{rms:+.0%} / {reversal:+.0%}" for rms, reversal in changes)))
        step()
    columns = ("joint", "PD", "sine", "none [mrad]", "tanh-Coulomb-viscous", "Stribeck", "default")
    title = "True error: RMS / RMS within 0.3 s after reversals"
    return TrackingPart(figures, _make_section(title, columns, cells, tracking_charts(rows)))


def study_robustness(bandwidths: Sequence[float], axes: Mapping[str, Any], step: Step) -> TrackingPart:
    """Map the error over gain, friction and delay, beside that of the rival."""
    figures, cells, charts = [], [], []
    for joint in JOINTS.values():
        for bandwidth in bandwidths:
            found = compute_robustness(joint, bandwidth, **axes)
            maps = ("gain", "scale", "delay", "ours", "rival", "ours_reversal", "rival_reversal")
            shares = {"share_won": found.share_won, "share_helps": found.share_helps}
            named = {name: getattr(found, name).tolist() for name in maps}
            figures.append({"joint": joint.name, "bandwidth": bandwidth, **shares, **named})
            cells.append((joint.title, f"{bandwidth:g} Hz", *(f"{share:.0%}" for share in shares.values())))
            charts.append(robustness_chart(found))
            step()
    columns = ("joint", "PD", "wins against tanh-CV", "better than none")
    return TrackingPart(figures, _make_section("Robustness: share of combinations", columns, cells, charts))


def study_loops(bandwidths: Sequence[float], step: Step) -> TrackingPart:
    """Check the loop of every joint, and watch it at rest."""
    figures, cells, charts = [], [], []
    for joint in JOINTS.values():
        for bandwidth in bandwidths:
            check = _check_tracked(joint, bandwidth)
            travel = run_standstill(TrackingCase(joint, "default", 0.2, bandwidth))
            limits = {name: getattr(check, name) for name in ("margin", "unsettled_from", "unsettled_without")}
            figures.append(
                {"joint": joint.name, "bandwidth": bandwidth, "source": check.settings.source}
                | {"gain": check.settings.gain, "drift": check.drift, "standstill_travel": travel}
                | {name: value if value != inf else None for name, value in limits.items()}
            )
            margin = "none found up to 2.5 times the gain" if check.margin == inf else f"{check.margin:.0%}"
            thrown = "settles" if check.unsettled_from == inf else f"{check.unsettled_from:g} rad"
            also = ", also without" if check.unsettled_without <= check.unsettled_from < inf else ""
            head = (joint.title, f"{bandwidth:g} Hz", check.settings.source)
            cells.append((*head, margin, thrown + also, f"{travel:.2g} rad"))
            charts.append(gain_scan_chart(check, f"{joint.title}, {bandwidth:g} Hz"))
            step()
    columns = ("direction from", "margin to the limit cycle", "keeps oscillating when thrown off by", "travel at rest")
    title = "Default loop; thrown off with the drive's limits of 5 N·m, 250 N·m/s"
    return TrackingPart(figures, _make_section(title, ("joint", "PD", *columns), cells, charts))


def _check_tracked(joint: TrackedJoint, bandwidth: float) -> LoopCheck:
    """Check the loop of `bandwidth` [Hz] around the stand-in's default drive, with the limits of its safety gate."""
    sensor = SensorSettings()
    _, loop = loop_of(bandwidth, sensor)
    (limits,) = default_limits(StandIn(default_joint()))
    drive = DriveLimits(limits.torque, limits.torque_rate)
    return check_loop(joint.model, loop, period=PERIOD, velocity_quantum=sensor.velocity_quantum(PERIOD), drive=drive)


def study_close_loop(bandwidths: Sequence[float], folder: Path, progress: Callable[[str], None]) -> TrackingPart:
    """Calibrate, compensate, record, diagnose, and compensate with what was found."""
    from .close_loop import close_loop

    result = close_loop(folder, bandwidths=bandwidths, progress=progress)
    tracked, cells = [], []
    for bandwidth, by_method in result.figures.items():
        row = [f"{bandwidth:g} Hz"]
        for method, one in by_method.items():
            rms, reversal = one.change_from(by_method["none"])
            change = "" if method == "none" else f" ({rms:+.0%} / {reversal:+.0%})"
            row.append(f"{1e3 * one.rms:.3f} / {1e3 * one.reversal_rms:.3f}{change}")
            errors = {"rms": one.rms, "reversal_rms": one.reversal_rms}
            tracked.append({"bandwidth": bandwidth, "method": method, **errors})
        cells.append(tuple(row))
    figures = {
        "true": {name: value for joint in result.settings.joints for name, value in joint.law.parameters().items()},
        "calibrated": result.calibrated.law.parameters(),
        "extended": result.extended.law.parameters(),
        "verdict": result.diagnosis.verdict,
        "named": [effect.name for effect in result.diagnosis.effects],
        "tracking": tracked,
    }
    columns = ("PD", "none", "Stribeck, calibrated", "extended by the diagnosis")
    charts = [close_loop_chart(result, bandwidth) for bandwidth in bandwidths]
    title = "Closed loop: RMS / RMS within 0.3 s after reversals [mrad]"
    return TrackingPart(figures, _make_section(title, columns, cells, charts, result.diagnosis.sentences))


def _make_section(
    title: str,
    columns: tuple[str, ...],
    cells: Sequence[tuple[str, ...]],
    charts: Sequence[Chart],
    sentences: Sequence[str] = (),
) -> Section:
    return Section(title, (Table(columns, tuple(cells)), *charts, *sentences))
