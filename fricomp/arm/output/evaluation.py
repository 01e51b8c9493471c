"""What the written files are worth: torque error and open-loop motion on blocks that took no part in their fit."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.errors import FricompError
from fricomp.evaluation.arm import ArmEvaluation, JointErrors, evaluate_arm
from fricomp.laws import BidirectionalStribeck, FloatArray, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel

from ..answer import ArmAnswer
from ..equations import ArmEquations
from ..fit import fit_arm
from ..friction_model import build_friction_model
from ..record import ArmRecord, FileErrors, JointRecord, PositionErrors
from .corrected_simulation import correct_simulation

__all__ = ["add_file_errors", "evaluate_files"]

_BLOCK = 5.0
"""[s] of a block: open-loop simulations of 2 s have to lie within one."""

_HELD_OUT = 4
"""One block of so many takes no part in the fit."""

_LEAST_PART = 1e-3
"""Of the mean level, that a level of one direction has at least."""

_SAID = 0.5
"""[s] of the open-loop simulation whose errors are told in words; the others stand in the table."""

_WORSE = 1.1
"""Torque error of the files over that of the fit from which both are told."""

Spans = list[tuple[float, float]]


def add_file_errors(record: ArmRecord, answer: ArmAnswer, simulation: str | Path) -> ArmRecord:
    """The record with what the files of each joint are worth; as it was where the recording is too short for it."""
    from msgspec.structs import replace as change

    errors = evaluate_files(answer, simulation)
    joints = tuple(change(joint, files=errors.get(joint.name)) for joint in record.joints)
    said = _say_files(joints)
    return change(record, joints=joints, sentences=(*record.sentences, *said))


def evaluate_files(answer: ArmAnswer, simulation: str | Path) -> dict[str, FileErrors]:
    """Errors of each joint by its simulation with plain friction, and by `arm.xml` with `friction.json`.

    Both are fitted to three blocks of four, and measured on the others. The corrected simulation and the models are
    made as those that are written are, which take all blocks.

    Args:
        answer: The confirmed fit.
        simulation: The file that was compared.

    Returns:
        By joint; nothing where the recording has no stretch that an open-loop simulation fits into.
    """
    found = answer.identification
    arm, equations, rows = found.fit.arm, found.equations, found.rows
    held, spans = _hold_out(rows.time)
    plain = _fit_plain(answer, equations, ~held)
    fit = fit_arm(arm, equations.with_rows(~held), found.fit.model, found.prior, found.fit, steps=5)
    part = replace(found, fit=fit)
    models = {name: build_friction_model(part, j) for j, name in enumerate(arm.joints)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.xml"
        try:
            path.write_text(correct_simulation(replace(answer, identification=part), simulation)[0], encoding="utf-8")
            before = _evaluate(answer, Path(simulation), plain, spans)
            after = _evaluate(answer, path, models, spans)
        except (FricompError, ValueError):
            return {}
    left = np.where((equations.moving & held[:, None]), fit.residuals(equations), 0.0)
    own = np.sqrt(np.sum(left**2, axis=0) / np.maximum(np.sum(equations.moving & held[:, None], axis=0), 1))
    pairs = zip(arm.joints, own.tolist(), strict=True)
    return {name: _compare(before.joint(name), after.joint(name), fitted) for name, fitted in pairs}


def _hold_out(time: FloatArray) -> tuple[np.ndarray, Spans]:
    """Rows that take no part in the fit, and their spans [s]."""
    first, last = float(time[0]), float(time[-1])
    blocks = max(_HELD_OUT, int((last - first) // _BLOCK))
    edges = np.linspace(first, last, blocks + 1)
    chosen = [k for k in range(blocks) if k % _HELD_OUT == _HELD_OUT // 2]
    spans = [(float(edges[k]), float(edges[k + 1])) for k in chosen]
    return np.any([(time >= a) & (time < b) for a, b in spans], axis=0), spans


def _evaluate(answer: ArmAnswer, simulation: Path, friction: dict[str, FrictionModel], spans: Spans) -> ArmEvaluation:
    found = answer.identification
    return evaluate_arm(
        simulation,
        found.recording.recordings,
        friction=friction,
        spans=spans,
        band=found.rows.cutoff,
        torque_delay=found.delay[0],
    )


def _fit_plain(answer: ArmAnswer, equations: ArmEquations, trained: np.ndarray) -> dict[str, FrictionModel]:
    """Coulomb, viscous and constant torques beside the simulation's inverse dynamics."""
    arm = answer.identification.fit.arm
    first, models = arm.inertia.size, {}
    for j, (name, columns) in enumerate(zip(arm.joints, equations.columns, strict=True)):
        torque = columns[:, -1] - columns[:, :first] @ arm.inertia.ravel() - arm.armature[j] * columns[:, first]
        kept = trained & equations.moving[:, j]
        friction = columns[kept, first + 1 : first + 4]
        level, offset, viscous = np.linalg.lstsq(friction, torque[kept], rcond=None)[0].tolist()
        models[name] = _build_plain(answer, j, (level, offset, viscous))
    return models


def _build_plain(answer: ArmAnswer, joint: int, values: Sequence[float]) -> FrictionModel:
    level, offset, viscous = max(values[0], 1e-9), values[1], max(values[2], 0.0)
    least = _LEAST_PART * level
    curves = [StribeckCurve(one, one, 1.0, viscous) for one in (max(level + offset, least), max(level - offset, least))]
    whole = build_friction_model(answer.identification, joint)
    return replace(whole, law=FrictionLaw((BidirectionalStribeck(curves[0], curves[1]),)))


def _compare(before: JointErrors, after: JointErrors, fitted: float) -> FileErrors:
    pairs = zip(before.position, after.position, strict=True)
    return FileErrors(
        torque_simulation=before.torque.rms,
        torque_fit=fitted,
        torque=after.torque.rms,
        band=after.torque.band,
        positions=tuple(
            PositionErrors(after=b.after, simulation=a.median, files=b.median, travel=b.travel, unit=b.unit)
            for a, b in pairs
        ),
    )


def _say_files(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """How far a simulation with the written files goes wrong, and which files hold less than the fit."""
    lines = []
    known = [(joint, joint.files) for joint in joints if joint.files is not None]
    times = [tuple(each for each in files.positions if each.after == _SAID) for _, files in known]
    if known and all(times):
        parts = ", ".join(
            f"{joint.name} {1e3 * at.simulation:.3g} to {1e3 * at.files:.3g} m{at.unit}"
            for (joint, _), (at,) in zip(known, times, strict=True)
        )
        lines.append(
            f"Simulated for {_SAID:g} s from measured states with the recorded torques, on held-out data, the median "
            f"position error changes from the simulation with Coulomb and viscous friction to these files: {parts}."
        )
    for joint, files in known:
        if files.torque > _WORSE * files.torque_fit:
            lines.append(
                f"{joint.name}: the files hold less than the fit; their held-out torque error is {files.torque:.3g} "
                f"{joint.unit}, that of the fit {files.torque_fit:.3g} {joint.unit}."
            )
    return tuple(lines)
