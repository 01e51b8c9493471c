"""Charts of the study of tracking: errors over time, bars of all figures, maps of robustness."""

from collections.abc import Sequence

import numpy as np

from fricomp.report import Bars, Chart, HeatMap, Line, Panel

from .case import TrackingFigures
from .close_loop import CloseLoopMethod, CloseLoopResult
from .robustness import RobustnessMap
from .study import StudyRow

_NAMES = {"coulomb_viscous": "tanh-Coulomb-viscous", "stribeck": "Stribeck", "default": "default"}
_CLOSE_LOOP_NAMES = {"stribeck": "Stribeck, calibrated", "extended": "extended by the diagnosis"}


def tracking_charts(rows: Sequence[StudyRow]) -> list[Chart]:
    """For each condition the error over time, and bars of all figures."""
    charts = []
    for row in rows:
        panels = []
        for method, figures in row.figures.items():
            if method != "none":
                panels.append(_draw_error(figures, row.figures["none"], _NAMES[method], 0))
        name = f"tracking-{row.joint.name}-{row.bandwidth:g}hz-{row.amplitude:g}rad"
        title = f"{row.joint.title}, {row.bandwidth:g} Hz, {row.amplitude:g} rad"
        charts.append(Chart(name, title, tuple(panels), share_x=True, panel_height=220))
    return [_draw_bars(rows), *charts]


def _draw_error(figures: TrackingFigures, base: TrackingFigures, name: str, color: int) -> Panel:
    """Error over time with a compensation and without any."""
    marks = (
        Line(base.time, 1e3 * base.error, "none", 6, width=1.0),
        Line(figures.time, 1e3 * figures.error, name, color, width=1.0),
    )
    rms, reversal = figures.change_from(base)
    return Panel(marks, "time [s]", "error [mrad]", f"{name}: RMS {rms:+.0%}, reversals {reversal:+.0%}")


def _draw_bars(rows: Sequence[StudyRow]) -> Chart:
    names = tuple(f"{row.joint.name} {row.bandwidth:g} Hz {row.amplitude:g} rad" for row in rows)
    panels = []
    for index, title in enumerate(("whole motion", "0.3 s after reversals")):
        marks = tuple(
            Bars(names, np.array([100.0 * (1.0 + row.change(method)[index]) for row in rows]), _NAMES[method])
            for method in rows[0].figures
            if method != "none"
        )
        panels.append(Panel(marks, "", "RMS error, % of that without", title))
    caption = "Lower is better. True error of the stand-in joint, which sticks."
    return Chart("tracking", "Tracking with friction compensation", tuple(panels), caption=caption)


def robustness_chart(found: RobustnessMap) -> Chart:
    """Maps over gain and friction, and over gain and delay: our RMS against none, and against the rival."""
    middle_delay = int(np.argmin(np.abs(found.delay - 0.001)))
    middle_scale = int(np.argmin(np.abs(found.scale - 1.0)))
    panels = []
    for title, ours, rival in (
        ("whole motion", found.ours, found.rival),
        ("reversals", found.ours_reversal, found.rival_reversal),
    ):
        for against, ratio in (("none", ours), ("tanh-Coulomb-viscous", (1.0 + ours) / (1.0 + rival) - 1.0)):
            shown = np.clip(100.0 * ratio, -100.0, 100.0)
            over_scale, over_delay = shown[:, :, middle_delay].T, shown[:, middle_scale, :].T
            head = f"{title}, against {against}"
            for y_label, y, values in (
                ("true over modelled friction [1]", found.scale, over_scale),
                ("delay [ms]", 1e3 * found.delay, over_delay),
            ):
                heat = HeatMap(found.gain, y, values, "change of RMS [%]", diverging=True)
                panels.append(Panel((heat,), "gain [1]", y_label, head))
    caption = (
        f"Negative is better. The default wins against tanh-Coulomb-viscous in {found.share_won:.0%} and helps in "
        f"{found.share_helps:.0%} of all {found.ours.size} combinations; settings are those for a delay of 1 ms."
    )
    name = f"robustness-{found.joint.name}-{found.bandwidth:g}hz"
    return Chart(name, f"Robustness, {found.joint.title}, {found.bandwidth:g} Hz", tuple(panels), 2, caption)


def close_loop_chart(result: CloseLoopResult, bandwidth: float) -> Chart:
    """Error over time without compensation, with the calibrated model, and with the extended one."""
    figures = result.figures[bandwidth]
    compensated: tuple[CloseLoopMethod, ...] = ("stribeck", "extended")
    panels = [
        _draw_error(figures[method], figures["none"], _CLOSE_LOOP_NAMES[method], number)
        for number, method in enumerate(compensated)
    ]
    both = tuple(
        Line(figures[method].time, 1e3 * figures[method].error, _CLOSE_LOOP_NAMES[method], number, width=1.0)
        for number, method in enumerate(compensated)
    )
    panels.append(Panel(both, "time [s]", "error [mrad]", "both compensations on their own scale"))
    named = ", ".join(effect.name for effect in result.diagnosis.effects if effect.kind == "physics")
    caption = f"Sine of 0.5 rad at 0.1 Hz on a joint with concealed effects; the diagnosis named {named}."
    title = f"Calibrate, compensate, diagnose, compensate again: PD {bandwidth:g} Hz"
    return Chart(f"close-loop-{bandwidth:g}hz", title, tuple(panels), share_x=True, panel_height=240, caption=caption)
