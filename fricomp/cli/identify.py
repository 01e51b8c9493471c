"""`fricomp identify`: friction from a recording, or from a table of velocity and torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from fricomp.cli.diagnosis.arm import ArmOptions, Channel, Gain, LogMapping, Match, find_arm_log, read_joint, run_arm
from fricomp.cli.fleet import Executor, FailIf, FleetRun, Resume, Workers, run_joints, say_same_joint, show_fleet
from fricomp.cli.option.cut import Cut, From, To
from fricomp.cli.option.page import OpenPage, open_page
from fricomp.cli.option.panel import Overwrite, arm_option, fleet_option, log_option, option_under, output_option
from fricomp.cli.output import answer
from fricomp.extras import REPORT, require

if TYPE_CHECKING:
    from fricomp.api.identification import Identification
    from fricomp.api.identify import IdentifySettings
    from fricomp.arm.log import ArmLog
    from fricomp.calibration.identification import DiscrepancyNetwork
    from fricomp.cli.terminal import Table
    from fricomp.fleet import FleetJoint, FleetRow
    from fricomp.recording import Recording

__all__ = ["app", "identify"]

app = typer.Typer(add_completion=False)

table_option = option_under("Of a table")
friction_option = option_under("Friction")
recording_option = option_under("Of a recording")


@app.command(
    epilog="fricomp identify points.csv --out runs/joint_1\n\n"
    "fricomp identify recording.csv --gravity --out runs/shoulder\n\n"
    "fricomp identify arm.bag --simulation arm.urdf --out runs/arm\n\n"
    "fricomp identify points.csv --noise relative --loss robust --law auto\n\n"
    "fricomp identify points.csv --depart --out runs/joint_1\n\n"
    "fricomp identify 'fleet/*.csv' --resume --out runs/fleet\n\n"
    "fricomp identify 'fleet/*.csv' --batch --out runs/fleet\n\n"
    "fricomp identify arm_log.csv --joint elbow --from 12 --to 60 --open --out runs/elbow\n\n"
    "Exit status of one file: 0 where the model is usable (converged, or with care lack_of_fit and "
    "wrong_basin_suspected) or a network departs, 1 where the files are written and the model is not usable (such as "
    "not_identifiable), 2 where nothing could be done. A fleet says it in its table and "
    "ends with 0."
)
def identify(
    files: Annotated[
        list[str],
        typer.Argument(
            help="Recording, or CSV with the columns velocity [rad/s], torque [N·m] and if wanted "
            "normal_load; several files, a folder, a pattern or a table of joints are a fleet."
        ),
    ],
    out: Annotated[Path, output_option(help="Folder for friction.json, friction.onnx and report.html.")] = Path(
        "runs/identify"
    ),
    method: Annotated[
        Literal["pinn", "least_squares"], table_option(help="For tables only; both ways lead to the same parameters.")
    ] = "pinn",
    noise: Annotated[Literal["auto", "relative", "absolute"], table_option(help="For tables only.")] = "auto",
    loss: Annotated[
        Literal["gaussian", "robust"], table_option(help="For tables only; robust: against outliers.")
    ] = "gaussian",
    law: Annotated[
        str,
        friction_option(
            help="stribeck, free_stribeck (its exponent too), symmetric_stribeck, coulomb, coulomb_viscous, "
            "asymmetric_coulomb_viscous, tanh or arctan; for tables also auto. By default stribeck; for a table that "
            "asks for another exponent free_stribeck, of a recording that does not determine it symmetric_stribeck, "
            "asymmetric_coulomb_viscous or coulomb_viscous.",
            show_default=False,
        ),
    ] = "",
    gravity: Annotated[
        bool | None,
        recording_option(
            "--gravity/--no-gravity",
            help="Whether gravity acts on the joint and is fitted; by default, where the torque shows it.",
            show_default=False,
        ),
    ] = None,
    seed: Annotated[int, friction_option(min=0, help="Seed of the network's first weights.")] = 0,
    depart: Annotated[
        bool, friction_option("--depart", help="Let a network leave the law where held-out points ask for it.")
    ] = False,
    batch: Annotated[bool, fleet_option("--batch", help="Tables of a fleet: all joints in one call.")] = False,
    device: Annotated[str, fleet_option(help="torch device for --batch: cpu, cuda.")] = "cpu",
    executor: Executor = "processes",
    workers: Workers = None,
    resume: Resume = False,
    fail_if: FailIf = None,
    overwrite: Overwrite = False,
    simulation: Annotated[
        Path | None, arm_option(help="MJCF or URDF of an arm whose joints all move in the log.")
    ] = None,
    match: Match = None,
    gain: Gain = None,
    channel: Channel = None,
    mapping: LogMapping = "",
    joint: Annotated[str | None, log_option(help="Joint to take from a log of several.")] = None,
    start: From = None,
    stop: To = None,
    open_report: OpenPage = False,
) -> None:
    """Identify friction; with a recording, inertia, gravity and offset first; with an arm, all joints together."""
    from fricomp.api.identification import write_identification
    from fricomp.api.identify import IdentifySettings, identify_source
    from fricomp.recording.sources.table import refuse_data_set
    from fricomp.result_kinds import IDENTIFICATION
    from fricomp.results import claim_folder, require_folder

    require(*REPORT, "onnx")
    _refuse_unknown(law or "stribeck")
    require_folder(out)
    arm = ArmOptions(match, gain, channel, mapping)
    cut = Cut(start, stop)
    if simulation is not None:
        _refuse({"--joint": bool(joint)}, "is of one joint; with --simulation all joints of an arm are identified")
        log = cut.apply_to_log(_require_arm(files, simulation, arm))
        run_arm(log, simulation, out, arm, seed, overwrite=overwrite)
        open_page(out / "report.html", wanted=open_report)
        return
    arm.refuse("is of an arm: give its --simulation too, or leave it out")
    settings = IdentifySettings(method, noise, loss, law, gravity, seed, depart)
    fleet = FleetRun(executor, workers, resume, fail_if)
    several = batch or _is_fleet(files)
    chosen = {"--channel": bool(channel), "--mapping": bool(mapping), **cut.given, "--joint": joint is not None}
    if several:
        refuse_data_set(Path(files[0]))  # whose files are logs, with which such options go
        _refuse(chosen, "is of one file")
        _refuse({"--overwrite": overwrite}, "is of one file, and a fleet goes on with --resume")
    if batch:
        _refuse(replace(fleet, resume=False, fail_if=None).given, "has no use with --batch")
        _identify_batch(files, out, settings, device, fleet)
        return
    _refuse({"--device": device != "cpu"}, "is for --batch")
    if several:
        _identify_fleet(files, out, settings, fleet)
        return
    _refuse(fleet.given, "is of fleets; this is one file")
    file = Path(files[0])
    with claim_folder(out, IDENTIFICATION, overwrite=overwrite, inputs=(file,)) as claim:
        source = _read(file, arm, joint, cut) if any(chosen.values()) else file
        found = identify_source(source, settings, flag="--")
        claim.clear()
        written = write_identification(found, out)
    _end(found, written, out, open_report=open_report)


def _end(found: Identification, written: Sequence[Path], out: Path, *, open_report: bool) -> None:
    """Say what was found, and exit with a status of its own where the model is not usable."""
    from fricomp.cli.parameter_table import end_as_usable

    answer(_as_answer(found, written))
    _print(found, written)
    open_page(out / "report.html", wanted=open_report)
    end_as_usable(usable=found.is_usable)


def _read(file: Path, arm: ArmOptions, joint: str | None, cut: Cut) -> Recording:
    """The part of a recording that is meant.

    Raises:
        IdentificationError: It is a table, which has no time.
        RecordingError: It cannot be read, or nothing is left of it.
    """
    from fricomp.calibration.table import is_friction_table

    if not arm.mapping and is_friction_table(file):  # what a mapping makes is a recording
        _refuse(cut.given | {"--joint": joint is not None}, f"is of recordings, and {file.name} is a table of friction")
    return cut.apply(read_joint(file, arm, joint))


def _require_arm(files: Sequence[str], simulation: Path, options: ArmOptions) -> ArmLog:
    """The log of an arm, for its joints together.

    Raises:
        ParameterError: The files are recordings of one joint.
    """
    from fricomp.errors import ParameterError

    log = find_arm_log(files, simulation, options)
    if log is None or not log.is_arm:
        raise ParameterError(
            "--simulation is of arms: give the log of all joints, or leave it out and say --gravity of one joint"
        )
    return log


def _is_fleet(files: Sequence[str]) -> bool:
    from fricomp.fleet import is_joint_table
    from fricomp.recording.named.quantity_files import is_log_folder

    only = Path(files[0])
    is_folder = only.is_dir() and not is_log_folder(only)
    several = len(files) > 1 or is_folder or is_joint_table(files[0])
    return several or (not only.exists() and any(character in files[0] for character in "*?["))


def _identify_fleet(files: Sequence[str], out: Path, settings: IdentifySettings, run: FleetRun) -> None:
    """Every joint into a folder of its own, and a page on all of them."""
    from functools import partial

    from fricomp.fleet import FleetJoint, list_joints

    require("pyarrow")
    joints = list_joints(files, FleetJoint("", ()))
    work = partial(_identify_one, settings=settings)
    rows = run_joints(joints, work, out, run, asdict(settings) | {"command": "identify"}, "identifying joints")
    say_same_joint(rows, files, out)
    _show_fleet(rows, out, run)


def _identify_one(joint: FleetJoint, out: Path, *, settings: IdentifySettings) -> FleetRow:
    """On a worker: identify one joint of a fleet."""
    from fricomp.api.identification import write_identification
    from fricomp.api.identify import identify_source
    from fricomp.calibration import IdentificationOptions
    from fricomp.errors import IdentificationError
    from fricomp.fleet.identification import identification_row

    if len(joint.recordings) > 1:
        raise IdentificationError(f"joint {joint.name} has {len(joint.recordings)} recordings: give one to identify")
    found = identify_source(joint.recordings[0], settings, IdentificationOptions(joint=joint.name), flag="--")
    write_identification(found, out)
    warnings = [note for note in found.notes if note.startswith("Careful: ")]
    return identification_row(found.result) | {"warnings": "\n".join(warnings)}


def _identify_batch(files: Sequence[str], out: Path, settings: IdentifySettings, device: str, run: FleetRun) -> None:
    """All tables in one call: parameters and models, no reports of their own."""
    from fricomp.errors import IdentificationError
    from fricomp.fleet import FleetJoint, list_joints
    from fricomp.fleet.identification import identify_tables

    if settings.law not in ("", "stribeck") or (settings.loss, settings.depart) != ("gaussian", False):
        raise IdentificationError("--batch fits the Stribeck law to Gaussian noise: leave out --law, --loss, --depart")
    others = {
        "--method": settings.method != "pinn",
        "--gravity": settings.gravity is not None,
        "--seed": settings.seed != 0,
    }
    _refuse(others, "has no use with --batch, which fits tables by least squares")
    require("pyarrow")
    joints = list_joints(files, FleetJoint("", ()))
    _show_fleet(identify_tables(joints, out, str(settings.noise), device, resume=run.resume), out, run)


def _show_fleet(rows: Sequence[FleetRow], out: Path, run: FleetRun) -> None:
    from fricomp.fleet.identification import identification_table, write_identification_fleet

    show_fleet(rows, identification_table, write_identification_fleet(rows, out), run)


def _refuse_unknown(law: str) -> None:
    """Refuse laws that no file can be identified with, before a fleet is begun with them.

    Laws with a state need the friction torque over time, which this command does not take.
    """
    from fricomp.api.identify import require_law
    from fricomp.calibration.identification.estimation.form import separable_law_names
    from fricomp.errors import IdentificationError

    if law in ("lugre", "dahl"):
        raise IdentificationError(
            f"--law {law} has a bristle state, which this command does not identify; it knows "
            f"{', '.join(separable_law_names())}. In Python, fricomp.identify_dynamic takes time, velocity and "
            f"friction torque of a motion with reversals for {law}"
        )
    require_law(law)


def _refuse(options: dict[str, bool], why: str) -> None:
    """Refuse an option that would be ignored: the first that is used, with what is said of it."""
    from fricomp.errors import IdentificationError

    for name in (name for name, used in options.items() if used):
        raise IdentificationError(f"{name} {why}: leave it out")


def _as_answer(found: Identification, written: Sequence[Path]) -> dict[str, Any]:
    """What a program wants of an identification; units stand in the model, which is among the files."""
    result = found.result
    parameters = {
        name: {
            "value": value,
            "standard_deviation": result.standard_deviations[name],
            "at_bound": name in result.at_bound,
        }
        for name, value in result.parameters.items()
    }
    return {
        "usable": found.is_usable,
        "status": str(result.status),
        "message": result.message,
        "parameters": parameters,
        "torque_unit": result.model.torque_unit,
        "noise": {"kind": result.noise.kind, "level": result.noise.level},
        "notes": found.notes,
        "files": written,
    }


def _print(found: Identification, written: Sequence[Path]) -> None:
    """Whether it can be used, the parameters, the files, and what to know."""
    from fricomp.cli.parameter_table import parameter_table, print_verdict
    from fricomp.cli.terminal import console

    result, screen = found.result, console()
    print_verdict(screen, result)
    screen.print(parameter_table(result))
    model, network, report, *departed = written
    screen.print(f"Model {model}, network {network}, report {report}")
    if found.network is not None:
        screen.print(_held_out_table(found.network))
    for path in departed:
        screen.print(f"Network that departs {path}")
    for note in found.notes:
        screen.print(note)


def _held_out_table(free: DiscrepancyNetwork) -> Table:
    """Closed form, networks held by it less and less, and the one held by the data alone."""
    from fricomp.calibration.identification.discrepancy import DATA_DRIVEN
    from fricomp.cli.terminal import Table

    names = {float("inf"): "closed form", DATA_DRIVEN: "network, data alone"}
    table = Table("predicted by", "held-out error [noise deviations]", "", box=None, pad_edge=False)
    for weight, error in free.held_out.items():
        name = names.get(weight, f"network, closed form weighs {weight:g}")
        table.add_row(name, f"{error:.3f}", "chosen" if weight == free.weight else "")
    return table
