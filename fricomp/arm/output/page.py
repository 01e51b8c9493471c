"""The page on an arm: joint by joint, link by link, and how the errors fall."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fricomp.report import Bars, Chart, Line, Panel, ReportPage, Section, Table
from fricomp.results import plain_name

from ..confirmation import fit_plainly
from ..examination import ArmExamination
from ..record import ArmRecord
from ..words.opening import write_title
from ..words.quantity import show_interval, show_quantity

_STATES = {"as_simulated": "as simulated", "off": "off", "not_determined": "not determined"}
_TO_JOINTS = "Each joint has a page of its own, behind its name: where its mismatch sits, and what the effects explain."
_MOST_JOINTS = 8
"""Joints whose torques are drawn: more would be too small to look into."""


def build_joint_table(record: ArmRecord) -> Table:
    """One joint a row."""
    rows = []
    for joint in record.joints:
        names = ", ".join(effect.name for effect in joint.effects) or "–"
        fall = 1.0 - joint.error_model / max(joint.error_simulation, 1e-300)
        errors = (f"{value:.3g}" for value in (joint.error_simulation, joint.error_plain, joint.error_model))
        rows.append((joint.name, names, *errors, joint.unit, f"{fall:.0%}"))
    heads = ("joint", "left out", "simulation", "refitted", "this model", "unit", "fall")
    return Table(heads, tuple(rows), "Held-out RMS torque errors.")


def build_friction_table(record: ArmRecord) -> Table:
    """Plain friction, one joint a row."""
    rows = tuple(
        (joint.name, *(show_quantity(joint.friction[name]) for name in ("coulomb", "viscous")))
        for joint in record.joints
    )
    return Table(("joint", "Coulomb", "viscous"), rows, "Friction that was fitted, with 95 % intervals.")


def build_link_table(record: ArmRecord) -> Table:
    """One link a row."""
    rows = tuple(
        (
            link.name,
            f"{link.simulated_mass:.4g}",
            f"{link.mass.value:.4g}",
            show_interval(link.mass),
            _STATES[link.state],
            ", ".join(name for name in ("mass", "x", "y", "z") if name not in link.determined) or "–",
        )
        for link in record.links
    )
    caption = "What the links weigh [kg], and which of mass and centre (x, y, z) this motion does not show."
    return Table(("link", "simulated", "found", "95 %", "state", "not shown"), rows, caption)


def build_file_table(record: ArmRecord) -> Table | None:
    """What the written files are worth, one joint a row; None where it was not measured."""
    known = [(joint, joint.files) for joint in record.joints if joint.files is not None]
    if not known:
        return None
    times = [each.after for each in known[0][1].positions]
    rows = tuple(
        (
            joint.name,
            f"{files.torque_simulation:.3g} → {files.torque:.3g} {joint.unit}",
            f"{files.torque_fit:.3g} {joint.unit}",
            *(_show_way(at.simulation, at.files, at.unit) for at in files.positions),
        )
        for joint, files in known
    )
    heads = ("joint", "torque error", "of the fit", *(f"position after {time:g} s" for time in times))
    caption = (
        "Simulation with Coulomb and viscous friction → arm.xml with friction.json, made without the blocks on which "
        "they are measured. Positions: median error of the whole arm in MuJoCo from measured states, driven by the "
        "recorded torques."
    )
    return Table(heads, rows, caption)


def draw_arm_charts(examination: ArmExamination) -> dict[str, Chart]:
    """Errors by joint, and what each joint's torque leaves over time."""
    return {"errors": _draw_errors(examination.record), "residuals": _draw_residuals(examination)}


def build_arm_page(examination: ArmExamination, charts: Mapping[str, Chart], notes: tuple[str, ...]) -> ReportPage:
    """The page."""
    record = examination.record
    links = {joint.name: f"joints/{plain_name(joint.name)}/report.html" for joint in record.joints}
    table = replace(build_joint_table(record), links=links)
    sections = [
        Section("Joint by joint", (_TO_JOINTS, table, charts["errors"], build_friction_table(record))),
        *([Section("The written files", (files,))] if (files := build_file_table(record)) is not None else []),
        Section("Link by link", (build_link_table(record),)),
        Section("Before and after", (charts["residuals"],)),
        Section("Files", notes),
    ]
    named = sum(len(joint.effects) for joint in record.joints)
    return ReportPage(
        title=write_title(record),
        subtitle=f"Compared up to {record.cutoff:g} Hz over {record.duration:.4g} s",
        summary=record.sentences,
        sections=tuple(sections),
        facts={"joints": str(len(record.joints)), "effects named": str(named), "delay": show_quantity(record.delay)},
    )


def _draw_errors(record: ArmRecord) -> Chart:
    names = tuple(joint.name for joint in record.joints)
    base = np.array([max(joint.error_simulation, 1e-300) for joint in record.joints])
    plain = np.array([joint.error_plain for joint in record.joints]) / base
    model = np.array([joint.error_model for joint in record.joints]) / base
    marks = (
        Bars(names, np.ones(len(names)), "simulation, Coulomb and viscous friction"),
        Bars(names, plain, "links and rotors fitted as well"),
        Bars(names, model, "this model"),
    )
    panel = Panel(marks, x_label="joint", y_label="error / that of the simulation [1]")
    return Chart("errors", "Held-out torque errors", (panel,), caption="Of data that took no part; lower is better.")


def _draw_residuals(examination: ArmExamination) -> Chart:
    """What the simulation and the model leave of each joint's torque, in the rows that are compared."""
    found = examination.answer.identification
    rows, moving = found.rows, found.equations.moving
    after, (_, before) = (
        found.fit.residuals(found.equations),
        fit_plainly(found.fit.arm, found.equations, np.ones(len(rows), dtype=bool)),
    )
    drawn = moving & (np.diff(rows.part, prepend=rows.part[0]) == 0)[:, None]  # no line goes over a gap
    panels = []
    for j, name in enumerate(found.fit.arm.joints[:_MOST_JOINTS]):
        unit = found.recording.metadata[j].torque_unit
        marks = tuple(
            Line(rows.time, np.where(drawn[:, j], left[:, j], np.nan), label)
            for left, label in ((before, "by the simulation, Coulomb and viscous friction"), (after, "by this model"))
        )
        panels.append(Panel(marks, title=name, x_label="time [s]", y_label=f"torque error [{unit}]"))
    caption = (
        "Measured less computed torque where the joint moves. What the model leaves should look like noise; it is "
        "widest near a reversal, where a joint sticks."
    )
    return Chart("residuals", "Torque errors over time", tuple(panels), caption=caption, share_x=True)


def _show_way(before: float, after: float, unit: str) -> str:
    """Two errors of a position [rad] or [m], in thousandths where both are less than one."""
    factor, called = (1.0, unit) if max(before, after) >= 1.0 else (1e3, f"m{unit}")
    return f"{factor * before:.3g} → {factor * after:.3g} {called}"
