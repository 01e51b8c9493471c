"""A fleet's identifications: rows, table, page, and all tables of a fleet in one call."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal, cast

import numpy as np

import fricomp
from fricomp.calibration import IdentificationResult
from fricomp.calibration.batch import BatchIdentification, identify_batch
from fricomp.calibration.table import FrictionTable, read_friction_table
from fricomp.errors import IdentificationError
from fricomp.model import Covariance, FrictionModel, Provenance, Validity, save_model
from fricomp.report import Chart, Panel, Points, ReportPage, Section, Table, write_report

from .joint import FleetJoint
from .run import FleetRow, write_rows

__all__ = ["identification_row", "identification_table", "identify_tables", "write_identification_fleet"]

_DEVIATION = ".standard_deviation"
_FACTS = ("name", "error", "seconds", "recordings", "status", "message", "noise", "noise_level", "torque_unit")


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


def identify_tables(joints: Sequence[FleetJoint], out: Path, noise: str, device: str = "cpu") -> list[FleetRow]:
    """Identify the tables of velocity and torque of all joints in one call; write models and `fleet.parquet`.

    Raises:
        IdentificationError: A joint has no table of its own, a normal load, or cannot be identified.
        RecordingError: A table cannot be read.
    """
    tables = [_read_table(joint) for joint in joints]
    kind = cast(Literal["auto", "relative", "absolute"], noise)
    found = identify_batch([t.velocity for t in tables], [t.torque for t in tables], kind, device=device)
    status, rows = found.status, []
    for index, (joint, table) in enumerate(zip(joints, tables, strict=True)):
        folder = out / joint.name
        folder.mkdir(parents=True, exist_ok=True)
        save_model(_model(joint, table, found, index), folder / "friction.json")
        row: FleetRow = {"name": joint.name, "error": "", "seconds": 0.0, "recordings": str(joint.recordings[0])}
        row |= {"status": str(status[index]), "message": "", "noise": str(found.noise[index])}
        row |= {"noise_level": float(found.noise_level[index]), "torque_unit": "N·m"}
        deviations = found.standard_deviations[index]
        for name, value, deviation in zip(found.parameter_names, found.values[index], deviations, strict=True):
            row |= {name: float(value), name + _DEVIATION: float(deviation)}
        rows.append(row)
    write_rows(rows, out / "fleet.parquet")
    return rows


def _read_table(joint: FleetJoint) -> FrictionTable:
    if len(joint.recordings) != 1:
        raise IdentificationError(f"joint {joint.name} has {len(joint.recordings)} files: a batch takes one table each")
    table = read_friction_table(joint.recordings[0])
    if table.normal_load is not None and np.ptp(table.normal_load) > 0.0:
        raise IdentificationError(f"joint {joint.name} has a normal load that varies: leave out --batch")
    return table


def _model(joint: FleetJoint, table: FrictionTable, found: BatchIdentification, index: int) -> FrictionModel:
    return FrictionModel(
        law=found.law(index),
        joint=joint.joint or joint.name,
        validity=Validity(velocity=(float(table.velocity.min()), float(table.velocity.max()))),
        covariance=Covariance(found.parameter_names, found.covariance[index]),
        provenance=Provenance(
            method="least_squares",
            created=datetime.now(UTC).isoformat(timespec="seconds"),
            fricomp_version=fricomp.__version__,
            notes={"noise": str(found.noise[index]), "noise_level": f"{found.noise_level[index]:.6g}"},
        ),
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
    charts = (_chart(done),) if done else ()
    sections = (Section("Parameters of the joints", charts), Section("Each", (identification_table(rows),)))
    return write_report(ReportPage(f"Friction of {len(rows)} joints", summary, sections), folder / "fleet.html")


def _chart(rows: Sequence[FleetRow]) -> Chart:
    """Each parameter over the joints, with its 95 % interval."""
    panels = []
    for name in _parameters(rows):
        given = [(i, row[name], row[name + _DEVIATION]) for i, row in enumerate(rows) if row.get(name) is not None]
        index, value, deviation = np.array(given, dtype=np.float64).T
        panels.append(Panel((Points(index, value, error=1.96 * deviation),), "joint", name.partition(".")[2] or name))
    return Chart("parameters", "Parameters with 95 % intervals", tuple(panels), columns=2)
