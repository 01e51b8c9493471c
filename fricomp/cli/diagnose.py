"""`fricomp diagnose`: find the physics that a simulation leaves out, in recordings of the real joint."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fricomp.cli.diagnosis.arm import (
    ArmOptions,
    Channel,
    Gain,
    LogMapping,
    Match,
    Payload,
    choose_joint,
    find_arm_log,
    find_payload,
    read_joint,
    run_arm,
)
from fricomp.cli.diagnosis.fleet import diagnose_fleet
from fricomp.cli.diagnosis.joint import DiagnosisRun, interruptible, print_diagnosis, print_record, run_diagnosis
from fricomp.cli.fleet import Executor, FailIf, FleetRun, Resume, Workers
from fricomp.cli.option.cut import Cut, From, To
from fricomp.cli.option.page import OpenPage, open_page
from fricomp.cli.option.panel import Overwrite, fleet_option, option_under, output_option
from fricomp.cli.output import hearing
from fricomp.extras import REPORT, require

if TYPE_CHECKING:
    pass

app = typer.Typer(add_completion=False)

simulation_option = option_under("Simulation")
diagnosis_option = option_under("Diagnosis")

EXIT_BAD_DATA = 1
"""Exit status where everything was written, and the verdict is that the data cannot be diagnosed."""

_EXAMPLES = """fricomp diagnose elbow.csv --simulation robot.xml --joint elbow --out runs/why

fricomp diagnose light.csv heavy.csv --out runs/payloads

fricomp diagnose log.parquet --joint elbow --from 12 --to 90 --open --out runs/elbow

fricomp diagnose real.csv --simulated from_my_simulator.csv --out runs/why

fricomp diagnose arm_log/ --simulation arm.urdf --out runs/arm

fricomp diagnose log.parquet --simulation arm.xml --match joint_1=shoulder,joint_2=elbow --out runs/arm

fricomp diagnose 'fleet/*.parquet' --each --out runs/fleet

fricomp diagnose joints.toml --executor dask://scheduler:8786 --resume --out runs/fleet

Exit status of one joint: 0 with an answer, 1 where the report is written and says that the data cannot be diagnosed, 2
where nothing could be done. A fleet says it in its table and ends with 0.

docs/diagnosis.md says what to do with each answer; fricomp convert makes recordings of logs in other formats.
"""


def _print_schema(wanted: bool) -> None:
    if wanted:
        import json

        from fricomp.diagnosis import diagnosis_json_schema

        print(json.dumps(diagnosis_json_schema(), indent=2))
        raise typer.Exit


@app.command(epilog=_EXAMPLES)
def diagnose(
    recordings: Annotated[
        list[str],
        typer.Argument(
            help="Recordings (CSV or Parquet: time, position, torque): files, folders, patterns; the log of an arm, "
            "also as a bag, MAT or NPZ; or a table of joints."
        ),
    ],
    out: Annotated[Path, output_option(help="Folder for the report, the record and the models.")],
    simulation: Annotated[
        Path | None,
        simulation_option(help="MJCF or URDF of the joint or the arm; a rigid joint is identified without it."),
    ] = None,
    joint: Annotated[
        str | None, simulation_option(help="Name of the joint; needed where the simulation has several.")
    ] = None,
    simulation_error: Annotated[
        float | None, simulation_option(help="How wrong its inertia and gravity may be: 0.2 for 20 %, the default.")
    ] = None,
    friction: Annotated[
        Path | None, simulation_option(help="Friction model of the simulation (friction.json).")
    ] = None,
    simulated: Annotated[
        Path | None, simulation_option(help="Recording that your simulator made under the same commands.")
    ] = None,
    controller: Annotated[
        Path | None, diagnosis_option(help="PD or PID loop that moved the joint (TOML); it is estimated without it.")
    ] = None,
    thorough: Annotated[
        bool, diagnosis_option("--thorough", help="Repeat it with other noise; say if the names stay.")
    ] = False,
    each: Annotated[
        bool, fleet_option("--each", help="Every recording on its own, each into a subfolder of --out.")
    ] = False,
    executor: Executor = "processes",
    workers: Workers = None,
    resume: Resume = False,
    fail_if: FailIf = None,
    overwrite: Overwrite = False,
    match: Match = None,
    gain: Gain = None,
    channel: Channel = None,
    mapping: LogMapping = "",
    payload: Payload = False,
    start: From = None,
    stop: To = None,
    open_report: OpenPage = False,
    seed: Annotated[
        int, diagnosis_option(min=0, help="Seed of the bands drawn in the report; no answer depends on it.")
    ] = 0,
    schema: Annotated[
        bool,
        output_option(
            "--schema", help="Print the JSON schema of diagnosis.json and exit.", callback=_print_schema, is_eager=True
        ),
    ] = False,
) -> None:
    """Say where simulation and recording differ, which physics is missing, and how much the fit improves.

    Plain sentences come first, here and in report.html. Recordings of different joints from the same time, with the
    simulation of their arm, are examined together. Several recordings of one joint are taken as one joint's, such as
    with two payloads; --each takes them as different joints, and so does a table of joints: CSV or TOML with recording,
    and where wanted name, simulation, joint and friction.
    """
    from fricomp.fleet import find_recordings, is_joint_table
    from fricomp.results import require_folder
    from fricomp.simulation_file import list_joints

    require(*REPORT, "ruptures")
    require_folder(out)
    options = {
        "thorough": thorough, "seed": seed, "joint": joint, "simulation": simulation,
        "simulation_error": simulation_error,
    }  # fmt: skip
    given = {"friction": friction, "simulated": simulated, "controller": controller}
    fleet = FleetRun(executor, workers, resume, fail_if)
    cut = Cut(start, stop)
    if each or any(map(is_joint_table, recordings)):
        _refuse_joint_options(cut, overwrite=overwrite)
        diagnose_fleet(recordings, out, options, given, fleet)
        return
    _refuse_fleet_options(fleet)
    arm = ArmOptions(match, gain, channel, mapping)
    log = None if joint is not None else find_arm_log(recordings, simulation, arm)
    if log is not None and simulation is not None and len(list_joints(simulation)) == 1:
        options["joint"] = joint = choose_joint(log, simulation)
        log = None
    log = None if log is None else cut.apply_to_log(log)
    if log is not None and simulation is not None and len(log.sessions) == 1 and not payload:
        run_arm(log, simulation, out, arm, seed, overwrite=overwrite)
        open_page(out / "report.html", wanted=open_report)
        return
    with interruptible(out):
        if log is not None and simulation is not None:
            run = DiagnosisRun(find_payload(log, simulation, out, arm, overwrite=overwrite), (), ())
        else:
            said = replace(arm, match=None) if joint is not None else arm
            said.refuse("is of an arm: leave it out, or give the log of all joints and their --simulation")
            paths = find_recordings(recordings)
            chosen = channel or mapping or joint or any(cut.given.values())
            asked = {path: cut.apply(read_joint(path, arm, joint, simulation)) for path in paths} if chosen else {}
            run = run_diagnosis(paths, out, options, given, overwrite=overwrite, asked=asked)
    _end(run, out, open_report=open_report)


def _end(run: DiagnosisRun, out: Path, *, open_report: bool) -> None:
    """Say what was found, and exit with a status of its own where the data cannot be diagnosed."""
    if hearing().as_json:
        print_record(out)
    else:
        print_diagnosis(run, out)
    open_page(out / "report.html", wanted=open_report)
    if run.diagnosis.verdict == "bad_data":
        raise typer.Exit(EXIT_BAD_DATA)


def _refuse_joint_options(cut: Cut, *, overwrite: bool) -> None:
    """Nothing, where a fleet is diagnosed with none of a joint's options.

    Raises:
        ParameterError: One is given.
    """
    from fricomp.errors import ParameterError

    if any(cut.given.values()):
        raise ParameterError("--from and --to are of one joint or one arm: cut the recordings by fricomp convert")
    if overwrite:
        raise ParameterError("--overwrite is of one joint, and a fleet goes on with --resume: leave it out")


def _refuse_fleet_options(run: FleetRun) -> None:
    """Nothing, where one joint is diagnosed with none of a fleet's options.

    Raises:
        ParameterError: One is given.
    """
    from fricomp.errors import ParameterError

    for name in (name for name, is_given in run.given.items() if is_given):
        raise ParameterError(f"{name} is of fleets: give --each or a table of joints too, or leave it out")
