"""The folder of a diagnosis: record, report, pictures, and the extended model in every form that can hold it."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import msgspec
import numpy as np

from fricomp.errors import DiagnosisError, FricompError
from fricomp.evaluation import fit_mjcf
from fricomp.export import apply_to_mjcf, export_mjcf
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel, encode_model, save_model
from fricomp.report import draw_png, write_report
from fricomp.untrusted import read_whole
from fricomp.whole_file import write_whole

from ..effects import EFFECTS
from ..effects.spring import SPRING_CHANGE
from ..record.record_file import save_diagnosis
from ..record.result import FRICTION_CHANGES, Diagnosis
from .network import save_extended_network
from .over_time import list_motion_columns
from .page import build_diagnosis_page, draw_diagnosis_charts

_WRITTEN = (SPRING_CHANGE, *FRICTION_CHANGES)  # changes that the written model holds
_MECHANICAL = {"rotary": "N·m", "linear": "N"}


@dataclass(frozen=True)
class WrittenDiagnosis:
    """What a diagnosis left in its folder.

    Attributes:
        folder: Where.
        files: Every file.
        notes: One sentence for each model file, with what it loses, or why it is not there.
    """

    folder: Path
    files: tuple[Path, ...]
    notes: tuple[str, ...]


def write_diagnosis(
    diagnosis: Diagnosis,
    folder: str | os.PathLike[str],
    *,
    simulation: Path | None = None,
    joint: str | None = None,
    facts: Mapping[str, str] | None = None,
    pictures: bool = True,
) -> WrittenDiagnosis:
    """Write the record, the report with its pictures, and where there are any the models and the proposed motion.

    Args:
        diagnosis: What was found.
        folder: Where; made if needed.
        simulation: MJCF file of the joint, to write the friction into; a snippet is written without it.
        joint: Name of the joint in it; its only joint, or the one that the recording names, if not given.
        facts: Lines for the section on how it was made.
        pictures: Whether the charts of the report are written as PNG beside it, too.

    Raises:
        DiagnosisError: The record cannot be written.
        MissingExtraError: plotly, jinja2 or matplotlib is not installed.
        OutputError: Another file cannot be written.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    save_diagnosis(diagnosis, target / "diagnosis.json")
    models, notes = _write_models(diagnosis, target, simulation, joint)
    charts = draw_diagnosis_charts(diagnosis)
    drawn = [draw_png(chart, target / f"{name}.png") for name, chart in charts.items()] if pictures else []
    page = build_diagnosis_page(diagnosis, charts, tuple(notes), facts or {}, target)
    report = write_report(page, target / "report.html")
    return WrittenDiagnosis(target, (target / "diagnosis.json", report, *models, *drawn), tuple(notes))


def _write_models(
    diagnosis: Diagnosis, folder: Path, simulation: Path | None, joint: str | None
) -> tuple[list[Path], list[str]]:
    files, notes = [], []
    model = diagnosis.extended_model or diagnosis.base_model
    if model is None:
        notes.append("No friction model is written: the data allow none.")
    else:
        kind = "extended" if diagnosis.extended_model is not None else "refitted"
        made = replace(model.provenance, created=datetime.now(UTC).isoformat(timespec="seconds"))
        save_model(replace(model, provenance=made), folder / "friction.json")
        files.append(folder / "friction.json")
        law = " + ".join(term.name for term in model.law.terms)
        spring = _describe_spring(diagnosis)
        notes.append(f"friction.json: the {kind} friction law: {law}{_describe_missing(diagnosis)}.{spring}")
        for name, write in (
            ("friction.onnx", save_extended_network),
            ("friction.xml", _save_mjcf(diagnosis, simulation, joint)),
        ):
            try:
                notes.append(f"{name}: {write(model, folder / name)}.")
                files.append(folder / name)
                moved = any(change.name not in _WRITTEN for change in diagnosis.record.changes)
                if name == "friction.xml" and simulation is not None and moved:
                    notes[-1] += " Inertia and gravity in it are those of the simulation given, not the refitted ones."
            except FricompError as error:
                (folder / name).unlink(missing_ok=True)
                notes.append(f"{name} is not written: {error}.")
    if diagnosis.folds:
        files.append(_write_folds(diagnosis, folder / "held_out.json"))
    if diagnosis.motion is not None:
        files.append(_write_motion(diagnosis.motion, folder / "motion.csv"))
        notes.append(
            "motion.csv: the motion to record next, by fricomp calibrate --motion; "
            "then fricomp diagnose this recording together with its motion-alone.csv."
        )
    return files, notes


def _write_folds(diagnosis: Diagnosis, path: Path) -> Path:
    """The models and times behind the held-out errors, as they would be in model files."""
    models = [[msgspec.Raw(encode_model(one)) for one in each] for each in diagnosis.folds]
    named = dict(zip(("before", "after"), models, strict=False))
    content = {"schema": "fricomp.held_out/1", "times": diagnosis.fold_times, **named}
    write_whole(path, msgspec.json.encode(content) + b"\n")
    return path


def _describe_spring(diagnosis: Diagnosis) -> str:
    """What a law with a spring means beside a simulation that has one of its own."""
    if all(change.name != SPRING_CHANGE for change in diagnosis.record.changes):
        return ""
    return " The spring in it is the joint's whole one, in place of that of the simulation."


def _describe_missing(diagnosis: Diagnosis) -> str:
    """What was named and is not in the law: it stands in no term of it."""
    model = diagnosis.extended_model
    named = [one.name for one in diagnosis.record.effects if one.kind == "physics"]
    missing = [name for name in named if model is None or not EFFECTS[name].is_in_law(model.law)]
    return f"; without {', '.join(missing)}, for which no term is written" if missing else ""


def _save_mjcf(diagnosis: Diagnosis, simulation: Path | None, joint: str | None):  # type: ignore[no-untyped-def]
    def write(model: FrictionModel, path: Path) -> str:
        unit = _MECHANICAL[model.motion]
        if model.torque_unit != unit:
            raise DiagnosisError(f"MuJoCo wants {unit}, and the torque of this recording is in {model.torque_unit}")
        text = read_whole(simulation).decode("utf-8-sig") if simulation is not None else None
        name = joint or (_find_only_joint(text) if text is not None else None) or model.joint
        if diagnosis.recorded is not None and model.dynamics is not None:
            with suppress(FricompError):  # a file that includes others is written into, but not simulated on its own
                fit = fit_mjcf(model, diagnosis.recorded, text, name)
                write_whole(path, _note_undetermined(fit.text, model))
                return fit.describe()
        export = export_mjcf(model)
        write_whole(path, _note_undetermined(apply_to_mjcf(export, text, name), model))
        return str(export.fidelity)

    return write


def _note_undetermined(text: str, model: FrictionModel) -> str:
    """The MJCF with a comment above its root on the numbers that the recordings do not determine."""
    names = model.provenance.notes.get("undetermined")
    if not names:
        return text
    declared, rest = text.split("?>", 1) if text.startswith("<?xml") else ("", text)
    head = f"{declared}?>\n" if declared else ""
    return f"{head}<!-- Not determined by the recording, one of many values: {names} -->\n{rest.lstrip()}"


def _find_only_joint(text: str) -> str | None:
    """The joint of a simulation that has one only: the diagnosed one, whatever the recording calls it."""
    try:
        joints = {joint.get("name") for body in ET.fromstring(text).iter("body") for joint in body.iter("joint")}
    except ET.ParseError:
        return None
    return joints.pop() if len(joints) == 1 else None


def _write_motion(motion: Mapping[str, FloatArray], path: Path) -> Path:
    columns = list_motion_columns(motion)
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(columns), *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    write_whole(path, "\r\n".join(lines) + "\r\n")
    return path
