"""A fleet's identifications: rows, table, page, and all tables of a fleet in one call."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal, cast

import numpy as np

from fricomp.calibration import IdentificationResult
from fricomp.calibration.batch import BatchIdentification, identify_batch
from fricomp.calibration.batch.points import observe_all
from fricomp.calibration.identification.estimation.observation import observe
from fricomp.calibration.identification.identify import require_choice
from fricomp.calibration.identification.provenance import compute_provenance
from fricomp.calibration.identification.report.chart import REACH
from fricomp.calibration.identification.result import NoiseEstimate
from fricomp.calibration.table import FrictionTable, read_friction_table
from fricomp.errors import FricompError, IdentificationError
from fricomp.extras import needing
from fricomp.folder_lock import FolderLock
from fricomp.model import Covariance, FrictionModel, Validity, encode_model
from fricomp.recording.checks.degrees import suspect_degrees_per_second
from fricomp.report import Bars, Chart, Panel, ReportPage, Section, Table, write_report
from fricomp.result_kinds import FLEET
from fricomp.results import make_folder

from .joint import FleetJoint
from .rows import FleetRow, begin_fleet, collect_rows
from .run import Parcel, at_home, failed_row, is_kept, land, pack, write_failed
from .severity import Severity, rate_row

_DEVIATION = ".standard_deviation"
_FACTS = (
    *("name", "error", "seconds", "recordings", "simulation", "joint", "friction", "sha256", "written"),
    *("status", "message", "warnings", "noise", "noise_level", "torque_unit"),
)


def identification_row(result: IdentificationResult) -> FleetRow:
    """What a fleet's table keeps of an identification: status, noise, and each parameter with its deviation."""
    row: FleetRow = {
        "status": str(result.status),
        "message": result.message,
        "noise": result.noise.kind,
        "noise_level": result.noise.level,
        "torque_unit": result.model.torque_unit,
    }
    for name, value in result.parameters.items():
        row |= {name: value, name + _DEVIATION: result.standard_deviations[name]}
    return row


def identify_tables(
    joints: Sequence[FleetJoint], out: Path, noise: str, device: str = "cpu", *, resume: bool = False
) -> list[FleetRow]:
    """Identify the tables of velocity and torque of all joints in one call; one that fails stops no other.

    Args:
        joints: With names that differ and one table each; a normal load must be the same in all rows of a table.
        out: Folder; each joint gets one in it with its model, and the fleet its rows as from `run_fleet`.
        noise: `auto`, `relative` or `absolute`.
        device: Of torch.
        resume: Keep what is finished, and do what failed, is missing, or was done from other files.

    Returns:
        The rows of all joints, in their order; `fleet.parquet` holds them too.

    Raises:
        IdentificationError: There is no such noise model, or no such device.
        MissingExtraError: torch is not installed.
        RecordingError: The folder holds a run and is not to be resumed, or with other settings.
        OutputError: Another process writes there.
    """
    require_choice("noise", noise, ("auto", "relative", "absolute"))
    _require_device(device)
    joints = [at_home(joint) for joint in joints]
    make_folder(out)
    with FolderLock.take(out) as lock:
        lock.note(FLEET.kind)
        before = begin_fleet(out, {"command": "identify --batch", "noise": noise}, resume)
        return _identify_all(joints, out, noise, device, before)


def _identify_all(
    joints: Sequence[FleetJoint], out: Path, noise: str, device: str, before: Mapping[str, FleetRow]
) -> list[FleetRow]:
    todo = [each for joint in joints if (each := _prepare(joint, before.get(joint.name), out)) is not None]
    if todo:
        tables = [table for _, table in todo]
        kind = cast(Literal["auto", "relative", "absolute"], noise)
        found = identify_batch([t.velocity for t in tables], [t.torque for t in tables], kind, device=device)
        for index, (parcel, table) in enumerate(todo):
            _write_joint(parcel, table, found, index, out, before.get(parcel.joint.name))
    return collect_rows(joints, out)


def _prepare(joint: FleetJoint, before: FleetRow | None, out: Path) -> tuple[Parcel, FrictionTable] | None:
    """A joint's table, or None where it is finished or has failed; its row says so then."""
    try:
        parcel = pack(joint)
        return None if parcel.gave(before) else (parcel, _read_table(joint))
    except OSError as error:
        if not is_kept(before, joint, error):
            write_failed(joint, error, before, out)
    except FricompError as error:
        write_failed(joint, error, before, out)
    return None


def _require_device(device: str) -> None:
    """Refuse a device that is not there, before a folder is begun with it."""
    with needing("torch", "calibrate"):
        import torch
    try:
        torch.empty(1, device=device)
    except (RuntimeError, AssertionError, NotImplementedError) as error:  # a build without CUDA asserts
        reason = str(error).partition("\n")[0]
        raise IdentificationError(f"there is no device {device!r}: {reason}; --device cpu is always there") from error


def _read_table(joint: FleetJoint) -> FrictionTable:
    """The table of a joint, if a batch can identify it."""
    if len(joint.recordings) != 1:
        raise IdentificationError(f"joint {joint.name} has {len(joint.recordings)} files: a batch takes one table each")
    table = read_friction_table(joint.recordings[0])
    if table.normal_load is not None and np.ptp(table.normal_load) > 0.0:
        raise IdentificationError(f"joint {joint.name} has a normal load that varies: leave out --batch")
    observe(table.velocity, table.torque, table.normal_load)
    observe_all([table.velocity], [table.torque])
    return table


def _write_joint(
    parcel: Parcel,
    table: FrictionTable,
    found: BatchIdentification,
    index: int,
    out: Path,
    before: FleetRow | None,
) -> None:
    """The model of one joint of a batch, and its row; a joint that gives no model has a row that says why."""
    joint = parcel.joint
    try:
        model = _model(joint, table, found, index)
        content = encode_model(model)
    except FricompError as error:
        land(joint, failed_row(joint, str(error)), {}, before, out)
        return
    row: FleetRow = {"name": joint.name, "error": "", "seconds": 0.0, **parcel.origin}
    row |= {"status": model.provenance.status, "message": model.provenance.message, "noise": str(found.noise[index])}
    row |= {"noise_level": float(found.noise_level[index]), "torque_unit": model.torque_unit}
    found_fast = suspect_degrees_per_second(float(np.max(np.abs(table.velocity))))
    row["warnings"] = "\n".join(f"Careful: {finding}." for finding in found_fast)
    deviations = found.standard_deviations[index]
    for name, value, deviation in zip(found.parameter_names, found.values[index], deviations, strict=True):
        row |= {name: float(value), name + _DEVIATION: float(deviation)}
    land(joint, row, {"friction.json": content}, before, out)


def _model(joint: FleetJoint, table: FrictionTable, found: BatchIdentification, index: int) -> FrictionModel:
    law, loads, points = found.law(index), None, observe(table.velocity, table.torque, table.normal_load)
    largest = float(np.max(np.abs(law.torque(points.velocity))))
    if table.normal_load is not None:  # the same in all rows, so that the parameters hold there
        loads = (float(table.normal_load[0]), float(table.normal_load[0]))
        law = law.replace({"stribeck.load.reference_load": loads[0]})
    names, kind = found.parameter_names, str(found.noise[index])
    noise = NoiseEstimate(kind, float(found.noise_level[index]), {kind: float(found.negative_log_likelihood[index])})
    return FrictionModel(
        law=law,
        joint=joint.joint or joint.name,
        validity=Validity(velocity=(float(points.velocity.min()), float(points.velocity.max())), normal_load=loads),
        covariance=Covariance(names, found.covariance[index], max(points.size - len(names), 1)),
        provenance=compute_provenance(points, noise, found.verdict(index), largest, method="least_squares"),
    )


def _parameters(rows: Sequence[FleetRow]) -> list[str]:
    names = dict.fromkeys(key for row in rows for key in row if key not in _FACTS)
    return [name for name in names if not name.endswith(_DEVIATION)]


def identification_table(rows: Sequence[FleetRow]) -> Table:
    """One line a joint: status, noise, parameters."""
    names = _parameters(rows)
    short = [name.partition(".")[2] or name for name in names]
    return Table(("joint", "status", "noise", *short), tuple(_line(row, names) for row in rows))


def _line(row: FleetRow, names: Sequence[str]) -> tuple[str, ...]:
    if row["error"]:
        return (row["name"], f"failed: {row['error']}", "–", *("–" for _ in names))
    level = f"{row['noise']} {row['noise_level']:.3g}"
    values = [f"{row[name]:.4g}" if row.get(name) is not None else "–" for name in names]
    return (row["name"], row["status"], level, *values)


def write_identification_fleet(rows: Sequence[FleetRow], folder: Path) -> Path:
    """Write `fleet.html`: how the joints ended, their parameters beside each other, and the table."""
    states = Counter("failed" if row["error"] else str(row["status"]) for row in rows)
    summary = tuple(f"{count} of {len(rows)}: {state.replace('_', ' ')}." for state, count in states.most_common())
    done = [row for row in rows if not row["error"]]
    usable = [row for row in done if rate_row(row) < Severity.UNUSABLE]
    charts: tuple[Chart | str, ...] = (_chart(usable),) if usable else ()
    if len(usable) < len(done):
        left = ", ".join(str(row["name"]) for row in done if row not in usable)
        charts += (f"Not drawn, as their models are not usable: {left}.",)
    reports = {str(row["name"]): f"{row['name']}/report.html" for row in done}
    links = {name: report for name, report in reports.items() if (folder / report).exists()}
    table = replace(identification_table(rows), links=links, filtered=True)
    sections = (Section("Parameters of the joints", charts), Section("Each", (table,)))
    worst = len(usable) < len(rows)
    page = ReportPage(
        f"Friction of {len(rows)} joints", summary, sections,
        outcome="warning" if worst else "passed",
        verdict=f"{len(rows) - len(usable)} of {len(rows)} not usable" if worst else "All usable",
    )  # fmt: skip
    return write_report(page, folder / "fleet.html")


def _unit_of(parameter: str, torque: str) -> str:
    """Unit of a parameter in brackets, where the torque has this one; empty where it is not known."""
    position = "m" if torque == "N" else "rad"
    known = {"torque": torque, "velocity": f"{position}/s", "viscous_coefficient": f"{torque}·s/{position}"}
    unit = next((unit for end, unit in known.items() if parameter.endswith(end)), "")
    return f"[{unit}]" if unit else ""


def _chart(rows: Sequence[FleetRow]) -> Chart:
    """Each parameter over the joints, with its 95 % interval."""
    panels = []
    unit = str(rows[0].get("torque_unit") or "N·m")
    for name in _parameters(rows):
        given = [(str(r["name"]), r[name], r[name + _DEVIATION]) for r in rows if r.get(name) is not None]
        names, value, deviation = zip(*given, strict=True)
        bars = Bars(names, np.array(value, dtype=np.float64), error=REACH * np.array(deviation, dtype=np.float64))
        label = f"{(name.partition('.')[2] or name).replace('_', ' ')} {_unit_of(name, unit)}".strip()
        panels.append(Panel((bars,), "joint", label))
    return Chart("parameters", "Parameters with 95 % intervals", tuple(panels), columns=2)
