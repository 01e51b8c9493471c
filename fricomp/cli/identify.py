"""`fricomp identify`: friction from a recording, or from a table of velocity and torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from fricomp.cli.fleet import FleetRun, run_joints, show_fleet
from fricomp.cli.out_folder import Overwrite
from fricomp.extras import REPORT, require

if TYPE_CHECKING:
    import numpy as np
    from rich.table import Table

    from fricomp.calibration import IdentificationResult
    from fricomp.calibration.identification import DiscrepancyNetwork
    from fricomp.calibration.motion.rigid_body import MotionIdentification
    from fricomp.fleet import FleetJoint, FleetRow

__all__ = ["app", "identify"]

app = typer.Typer(add_completion=False)

EXIT_NOT_USABLE = 1
"""Exit status where everything was written, and the model is one that compensator and exports refuse."""

_MASS = {"N·m": "kg·m²", "N": "kg"}  # unit of the inertia beside that of the torque


@app.command(
    epilog="fricomp identify points.csv --out runs/joint_1\n\n"
    "fricomp identify recording.csv --gravity --out runs/shoulder\n\n"
    "fricomp identify points.csv --noise relative --loss robust --law auto\n\n"
    "fricomp identify points.csv --depart --out runs/joint_1\n\n"
    "fricomp identify 'fleet/*.csv' --resume --out runs/fleet\n\n"
    "fricomp identify 'fleet/*.csv' --batch --out runs/fleet\n\n"
    "Exit status of one file: 0 where the model is usable (converged, or with care lack_of_fit and "
    "wrong_basin_suspected) or a network departs, 1 where the files are written and the model is not usable (such as "
    "not_identifiable), 2 where nothing could be done. A fleet says it in its table and "
    "ends with 0."
)
def identify(
    files: Annotated[
        list[str],
        typer.Argument(
            help="Recording, or CSV with the columns velocity \\[rad/s], torque \\[N·m] and if wanted "
            "normal_load; several files, a folder, a pattern or a table of joints are a fleet."
        ),
    ],
    out: Annotated[Path, typer.Option(help="Folder for friction.json, friction.onnx and report.html.")] = Path(
        "runs/identify"
    ),
    method: Annotated[
        Literal["pinn", "least_squares"], typer.Option(help="For tables only; both have the same optimum.")
    ] = "pinn",
    noise: Annotated[Literal["auto", "relative", "absolute"], typer.Option(help="For tables only.")] = "auto",
    loss: Annotated[
        Literal["gaussian", "robust"], typer.Option(help="For tables only; robust: against outliers.")
    ] = "gaussian",
    law: Annotated[
        str,
        typer.Option(
            help="stribeck, symmetric_stribeck, coulomb, coulomb_viscous, tanh or arctan; for tables also auto."
        ),
    ] = "stribeck",
    gravity: Annotated[bool, typer.Option(help="For a recording: gravity acts on the joint, and is fitted.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of the network's first weights.")] = 0,
    depart: Annotated[bool, typer.Option(help="Let a network leave the law where held-out points ask for it.")] = False,
    batch: Annotated[bool, typer.Option("--batch", help="Tables of a fleet: all joints in one call.")] = False,
    device: Annotated[str, typer.Option(help="Of torch, for --batch: cpu, cuda.")] = "cpu",
    executor: Annotated[str, typer.Option(help="Of a fleet: processes, serial or dask://host:port.")] = "processes",
    workers: Annotated[int | None, typer.Option(min=1, help="Of a fleet; one a core by default.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Of a fleet: go on with the one in --out.")] = False,
    overwrite: Overwrite = False,
) -> None:
    """Identify friction; with a recording, inertia, gravity and offset first."""
    from fricomp.cli.out_folder import require_folder
    from fricomp.cli.terminal import plain
    from fricomp.control.trust import find_doubt_in_status
    from fricomp.results import IDENTIFICATION, claim_folder

    require(*REPORT, "onnx")
    _refuse_unknown(law)
    require_folder(out)
    settings = _Settings(method, noise, loss, law, gravity, seed, depart)
    fleet = FleetRun(executor, workers, resume)
    several = batch or _is_fleet(files)
    _refuse({"--overwrite": overwrite and several}, "is of one file, and a fleet goes on with --resume")
    if batch:
        _refuse(replace(fleet, resume=False).given, "has no use with --batch")
        _identify_batch(files, out, settings, device, resume=resume)
        return
    _refuse({"--device": device != "cpu"}, "is for --batch")
    if several:
        _identify_fleet(files, out, settings, fleet)
    else:
        _refuse(fleet.given, "is of fleets; this is one file")
        file = Path(files[0])
        with claim_folder(out, IDENTIFICATION, overwrite=overwrite, inputs=(file,)) as claim:
            found = _identify_file(file, settings)
            claim.clear()
            _write_report(found, file, out, settings)
            _finish(found.result, found.free, out)
        for note in found.notes:
            typer.echo(plain(note))
        departs = found.free is not None and found.free.departs  # then the network is what was asked for
        if find_doubt_in_status(found.result.status, "") is not None and not departs:
            raise typer.Exit(EXIT_NOT_USABLE)


@dataclass(frozen=True)
class _Settings:
    """Options of an identification."""

    method: Literal["pinn", "least_squares"]
    noise: str
    loss: Literal["gaussian", "robust"]
    law: str
    gravity: bool
    seed: int
    depart: bool


@dataclass(frozen=True)
class _Identified:
    """What one file gave, and sentences on it."""

    result: IdentificationResult
    free: DiscrepancyNetwork | None
    notes: list[str]


def _identify_file(file: Path, settings: _Settings, joint: str = "joint") -> _Identified:
    """Identify one file, of this joint where it does not say so itself."""
    import numpy as np

    from fricomp.calibration import IdentificationOptions
    from fricomp.calibration import identify as identify_points
    from fricomp.calibration.identification import fit_discrepancy
    from fricomp.calibration.table import is_friction_table, read_friction_table
    from fricomp.cli.terminal import careful
    from fricomp.recording.unit_checks import suspect_degrees_per_second

    notes: list[str] = []
    method, noise, loss, seed = settings.method, settings.noise, settings.loss, settings.seed
    if is_friction_table(file):
        _refuse({"--gravity": settings.gravity}, f"is for recordings; {file.name} is a table, which is friction alone")
        table = read_friction_table(file)
        notes += map(careful, suspect_degrees_per_second(float(np.max(np.abs(table.velocity)))))
        law = _choose_law(settings.law, (table.velocity, table.torque, table.normal_load), notes)
        result = identify_points(
            table.velocity, table.torque, table.normal_load, method, noise, seed, law=law, loss=loss,
            options=IdentificationOptions(joint=joint),
        )  # fmt: skip
        notes += _offset_note(result)
    else:
        _refuse_point_options(file, settings)
        motion = _identify_recording(file, settings.gravity, settings.law, notes)
        result = motion.friction
        notes.insert(0, _rigid_sentence(motion))
    free = fit_discrepancy(result, seed=seed) if settings.depart else None
    notes += [f"Law or network: {free.message}."] if free else []
    return _Identified(result, free, notes)


def _write_report(found: _Identified, file: Path, out: Path, settings: _Settings) -> None:
    from fricomp.calibration.identification.page import write_identification_report

    facts = {"file": file.name, "seed": str(settings.seed), "loss": settings.loss}
    write_identification_report(found.result, out, found.notes, facts)


def _offset_note(result: IdentificationResult) -> list[str]:
    """What a table cannot tell, where the law has a curve for each direction."""
    offset = result.observations.compute_asymmetry() if result.form.bidirectional else None
    if offset is None:
        return []
    return [
        "A constant torque offset in the table counts as friction that differs between the directions; with the same "
        f"friction in both it would be {offset:.4g} {result.model.torque_unit}."
    ]


def _is_fleet(files: Sequence[str]) -> bool:
    from fricomp.fleet import is_joint_table

    only = Path(files[0])
    several = len(files) > 1 or only.is_dir() or is_joint_table(files[0])
    return several or (not only.exists() and any(character in files[0] for character in "*?["))


def _identify_fleet(files: Sequence[str], out: Path, settings: _Settings, run: FleetRun) -> None:
    """Every joint into a folder of its own, and a page on all of them."""
    from functools import partial

    from fricomp.fleet import FleetJoint, list_joints

    require("pyarrow")
    joints = list_joints(files, FleetJoint("", ()))
    work = partial(_identify_one, settings=settings)
    rows = run_joints(joints, work, out, run, asdict(settings) | {"command": "identify"}, "identifying joints")
    _show_fleet(rows, out)


def _identify_one(joint: FleetJoint, out: Path, *, settings: _Settings) -> FleetRow:
    """On a worker: identify one joint of a fleet."""
    from fricomp.calibration.identification import save_discrepancy, save_identification
    from fricomp.errors import IdentificationError
    from fricomp.fleet.identification import identification_row

    if len(joint.recordings) > 1:
        raise IdentificationError(f"joint {joint.name} has {len(joint.recordings)} recordings: give one to identify")
    file = joint.recordings[0]
    found = _identify_file(file, settings, joint.name)
    _write_report(found, file, out, settings)
    written = save_identification(found.result, out)
    if found.free is not None and found.free.departs:
        save_discrepancy(found.free, found.result, out, written.model_sha256)
    warnings = [note for note in found.notes if note.startswith("Careful: ")]
    return identification_row(found.result) | {"warnings": "\n".join(warnings)}


def _identify_batch(files: Sequence[str], out: Path, settings: _Settings, device: str, *, resume: bool) -> None:
    """All tables in one call: parameters and models, no reports of their own."""
    from fricomp.errors import IdentificationError
    from fricomp.fleet import FleetJoint, list_joints
    from fricomp.fleet.identification import identify_tables

    if (settings.law, settings.loss, settings.depart) != ("stribeck", "gaussian", False):
        raise IdentificationError("--batch fits the Stribeck law to Gaussian noise: leave out --law, --loss, --depart")
    others = {"--method": settings.method != "pinn", "--gravity": settings.gravity, "--seed": settings.seed != 0}
    _refuse(others, "has no use with --batch, which fits tables by least squares")
    require("pyarrow")
    joints = list_joints(files, FleetJoint("", ()))
    _show_fleet(identify_tables(joints, out, settings.noise, device, resume=resume), out)


def _show_fleet(rows: Sequence[FleetRow], out: Path) -> None:
    from fricomp.fleet.identification import identification_table, write_identification_fleet

    show_fleet(rows, identification_table(rows), write_identification_fleet(rows, out))


def _refuse_unknown(law: str) -> None:
    """Refuse laws that no file can be identified with, before a fleet is begun with them.

    Laws with a state need the friction torque over time, which this command does not take.
    """
    from fricomp.calibration.identification.form import separable_law_names
    from fricomp.calibration.identification.identify import require_choice
    from fricomp.errors import IdentificationError

    if law not in ("lugre", "dahl"):
        require_choice("law", law, ("auto", *separable_law_names()))
        return
    raise IdentificationError(
        f"--law {law} has a bristle state, which this command does not identify; it knows "
        f"{', '.join(separable_law_names())}. In Python, fricomp.identify_dynamic takes time, velocity and "
        f"friction torque of a motion with reversals for {law}"
    )


def _refuse(options: dict[str, bool], why: str) -> None:
    """Refuse an option that would be ignored: the first that is used, with what is said of it."""
    from fricomp.errors import IdentificationError

    for name in (name for name, used in options.items() if used):
        raise IdentificationError(f"{name} {why}: leave it out")


def _refuse_point_options(file: Path, settings: _Settings) -> None:
    """A recording is identified by filtered regression, which these options do not reach."""
    from fricomp.errors import IdentificationError

    options = (
        ("--method", settings.method != "pinn"),
        ("--noise", settings.noise != "auto"),
        ("--loss", settings.loss != "gaussian"),
        ("--law auto", settings.law == "auto"),
        ("--seed", settings.seed != 0),
        ("--depart", settings.depart),
    )
    changed = [option for option, used in options if used]
    if changed:
        names = ", ".join(changed)
        raise IdentificationError(
            f"{names} is for tables of velocity and torque; {file.name} is a recording, whose friction is identified "
            f"together with its rigid body by filtered regression: leave {'them' if len(changed) > 1 else 'it'} out"
        )


def _choose_law(law: str, data: tuple[np.ndarray, np.ndarray, np.ndarray | None], notes: list[str]) -> str:
    from fricomp.calibration.identification import choose_law

    if law != "auto":
        return law
    choice = choose_law(*data)
    notes.append(f"Law: {choice.reason}.")
    return choice.law


def _identify_recording(file: Path, gravity: bool, law: str, notes: list[str]) -> MotionIdentification:
    from fricomp.calibration.identification import IdentificationOptions
    from fricomp.calibration.motion.joint_samples import RegressionSettings, choose_settings, sample_joint, split_for
    from fricomp.calibration.motion.parts import read_motion_recording
    from fricomp.calibration.motion.rigid_body import identify_motion
    from fricomp.cli.terminal import careful

    recording, findings, about = read_motion_recording(file)
    settings = choose_settings(recording, gravity=gravity)
    if settings.torque_cutoff < RegressionSettings.torque_cutoff:
        notes.append(f"Low-pass: {settings.torque_cutoff:.3g} Hz, so that noise of the position is no acceleration.")
    of_gaps = split_for(recording, settings).notes
    notes += (*about, *of_gaps)
    notes += (careful(finding) for finding in findings if not (of_gaps and finding.code == "gap"))
    meta = recording.metadata
    options = IdentificationOptions(joint=meta.joint, motion=meta.motion, torque_unit=meta.torque_unit)
    return identify_motion(sample_joint(recording, settings), settings, law=law, options=options)


def _rigid_sentence(motion: MotionIdentification) -> str:
    body, model = motion.rigid_body, motion.friction.model
    torque, angle = model.torque_unit, model.position_unit
    of_inertia, *_, of_offset = body.standard_deviations
    (cosine, sine), (of_cosine, of_sine) = body.gravity, body.gravity_deviations
    gravity = f"({cosine:.4g} ± {of_cosine:.2g}) cos q + ({sine:.4g} ± {of_sine:.2g}) sin q {torque}"
    offset = f", offset {body.offset:.4g} ± {of_offset:.2g} {torque}" if of_offset > 0.0 else ""
    said = (
        f"Rigid body, ± its standard deviations: inertia {body.inertia:.5g} ± {of_inertia:.2g} "
        f"{_MASS.get(torque, f'{torque}·s²/{angle}')}{offset}, gravity "
        f"{gravity if any(body.gravity) else 'not asked for (--gravity)'}; symmetric friction beside it: Coulomb "
        f"{body.coulomb_torque:.5g} {torque}, viscous {body.viscous_coefficient:.5g} {torque}·s/{angle}. "
        f"{len(motion.points)} samples slide and count; standard deviations allow for their correlation. "
        f"{motion.lag.sentence}"
    )
    if body.inertia < 2.0 * of_inertia:  # a 95 % interval that holds zero
        said += " The motion does not determine the inertia: record one with quicker accelerations while it slides."
    if motion.presliding > 0.0:
        said += (
            f" Friction builds up after rests and reversals: the first {motion.presliding:.2g} {angle} are left out."
        )
    return said


def _finish(result: IdentificationResult, free: DiscrepancyNetwork | None, out: Path) -> None:
    """Write the model and the networks, print the tables."""
    from fricomp.calibration.identification import Status, save_discrepancy, save_identification
    from fricomp.cli.parameter_table import parameter_table
    from fricomp.cli.terminal import console
    from fricomp.control.trust import find_doubt_in_status

    files = save_identification(result, out)
    screen = console()
    screen.print(parameter_table(result))
    said = f"{result.status}: {result.message}"
    if find_doubt_in_status(result.status, "") is not None:
        screen.print(f"NOT USABLE, {said}", style="bold red", markup=False)
    elif result.status is Status.CONVERGED:
        screen.print(said, markup=False)
    else:
        screen.print(f"Careful, {said}", style="yellow", markup=False)
    screen.print(f"Model {files.model}, network {files.network}, report {out / 'report.html'}")
    if free is None:
        return
    screen.print(_held_out_table(free))
    if free.departs:
        screen.print(f"Network that departs {save_discrepancy(free, result, out, files.model_sha256)}")


def _held_out_table(free: DiscrepancyNetwork) -> Table:
    """Closed form, networks held by it less and less, and the one held by the data alone."""
    from rich.table import Table

    from fricomp.calibration.identification.discrepancy import DATA_DRIVEN

    names = {float("inf"): "closed form", DATA_DRIVEN: "network, data alone"}
    table = Table("predicted by", "held-out error [noise deviations]", "", box=None, pad_edge=False)
    for weight, error in free.held_out.items():
        name = names.get(weight, f"network, closed form weighs {weight:g}")
        table.add_row(name, f"{error:.3f}", "chosen" if weight == free.weight else "")
    return table
