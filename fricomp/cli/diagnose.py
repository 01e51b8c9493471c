"""`fricomp diagnose`: find the physics that a simulation leaves out, in recordings of the real joint."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

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
from fricomp.cli.fleet import Executor, FailIf, FleetRun, Resume, Workers, rich_table, run_joints, show_fleet
from fricomp.cli.option.cut import Cut, From, To
from fricomp.cli.option.page import OpenPage, open_page
from fricomp.cli.option.panel import Overwrite, fleet_option, option_under, output_option
from fricomp.cli.output import hearing, say_interrupted
from fricomp.extras import REPORT, require

if TYPE_CHECKING:
    from fricomp.diagnosis import Diagnosis
    from fricomp.fleet import FleetJoint, FleetRow
    from fricomp.recording import Recording

app = typer.Typer(add_completion=False)

simulation_option = option_under("Simulation")
diagnosis_option = option_under("Diagnosis")

EXIT_BAD_DATA = 1
"""Exit status where everything was written, and the verdict is that the data cannot be diagnosed."""

_EXAMPLES = """[bold]Examples[/bold]

fricomp diagnose elbow.csv --simulation robot.xml --joint elbow --out runs/why

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
    from fricomp.errors import ParameterError
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
        if any(cut.given.values()):
            raise ParameterError("--from and --to are of one joint or one arm: cut the recordings by fricomp convert")
        if overwrite:
            raise ParameterError("--overwrite is of one joint, and a fleet goes on with --resume: leave it out")
        _diagnose_fleet(recordings, out, options, given, fleet)
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
    with _interruptible(out):
        if log is not None and simulation is not None:
            run = DiagnosisRun(find_payload(log, simulation, out, arm, overwrite=overwrite), (), ())
        else:
            said = replace(arm, match=None) if joint is not None else arm
            said.refuse("is of an arm: leave it out, or give the log of all joints and their --simulation")
            paths = find_recordings(recordings)
            chosen = channel or mapping or joint or any(cut.given.values())
            asked = {path: cut.apply(read_joint(path, arm, joint, simulation)) for path in paths} if chosen else {}
            run = run_diagnosis(paths, out, options, given, overwrite=overwrite, asked=asked)
    if hearing().as_json:
        _print_record(out)
    else:
        _print_diagnosis(run, out)
    open_page(out / "report.html", wanted=open_report)
    if run.diagnosis.verdict == "bad_data":
        raise typer.Exit(EXIT_BAD_DATA)


def _refuse_fleet_options(run: FleetRun) -> None:
    """Nothing, where one joint is diagnosed with none of a fleet's options.

    Raises:
        ParameterError: One is given.
    """
    from fricomp.errors import ParameterError

    for name in (name for name, is_given in run.given.items() if is_given):
        raise ParameterError(f"{name} is of fleets: give --each or a table of joints too, or leave it out")


@contextmanager
def _interruptible(out: Path) -> Iterator[None]:
    """One joint's diagnosis: on Ctrl-C it says what is left in its folder."""
    from fricomp.cli.diagnosis.folder import RECORD

    before = _changed_at(out / RECORD)
    try:
        yield
    except KeyboardInterrupt:
        nothing = f"nothing was written into {out}"
        left = nothing if _changed_at(out / RECORD) == before else f"the files in {out} are incomplete"
        say_interrupted(f"; {left}. The same command begins anew.")
        raise


def _changed_at(path: Path) -> float | None:
    """Time of the last change of a file [s]; None where there is none."""
    return path.stat().st_mtime if path.exists() else None


class DiagnosisRun(NamedTuple):
    """A diagnosis, the files that it wrote, what the checks of its recordings warn of, and what each file loses."""

    diagnosis: Diagnosis
    files: tuple[Path, ...]
    warnings: tuple[str, ...]
    notes: tuple[str, ...] = ()


def run_diagnosis(
    paths: Sequence[Path],
    out: Path,
    options: dict[str, Any],
    given: dict[str, Path | None],
    *,
    quiet: bool = False,
    overwrite: bool = False,
    asked: Mapping[Path, Recording] | None = None,
) -> DiagnosisRun:
    """Read, diagnose, and write the folder; what an earlier diagnosis wrote there is removed right before.

    Args:
        paths: Recordings of one joint.
        out: Folder to write.
        options: Of `diagnose`, and the simulation.
        given: Files by option; None where the option was not used.
        quiet: Show no progress.
        overwrite: Whether an earlier diagnosis in the folder may be replaced.
        asked: Recordings that were read already, as the command line says of their columns.

    Raises:
        DiagnosisError: A recording is too short, or the diagnosis cannot be made.
        OutputError: Something in the folder would be replaced that is not to be, or another process writes there.
        RecordingError: A recording cannot be read.
    """
    from time import perf_counter

    from fricomp.api.diagnose import read_long_recording
    from fricomp.cli.diagnosis.folder import require_own
    from fricomp.cli.diagnosis.warnings import diagnosis_warnings, distinct_names
    from fricomp.cli.terminal import progress
    from fricomp.diagnosis.report import write_diagnosis
    from fricomp.results import DIAGNOSIS, claim_folder

    start, inputs = perf_counter(), [path for path in (options["simulation"], *given.values()) if path is not None]
    require_own(out)
    claimed = claim_folder(out, DIAGNOSIS, overwrite=overwrite, inputs=(*paths, *inputs))
    with claimed as claim, progress(quiet=quiet) as bar:
        task = bar.add_task("reading", total=None)
        simulated = [given["simulated"]] if given["simulated"] is not None else []
        names = (options["joint"], options["simulation"])
        read = {path: read_long_recording((asked or {}).get(path, path), *names) for path in (*paths, *simulated)}
        series = [read[path] for path in paths]

        def say(what: str) -> None:
            bar.update(task, description=what)

        named = {**options, "names": distinct_names(paths)}
        diagnosis = _diagnose(read, series, named, given, say)
        warnings = diagnosis_warnings(read, diagnosis)
        say("writing the report")
        facts = _facts(paths, series, options, given) | {"time taken": f"{perf_counter() - start:.1f} s"}
        facts |= {f"check of the data {number}": text for number, text in enumerate(warnings, 1)}
        claim.clear()
        settings = {"simulation": options["simulation"], "joint": options["joint"]}
        written = write_diagnosis(diagnosis, out, **settings, facts=facts)
    return DiagnosisRun(diagnosis, written.files, warnings, written.notes)


def _diagnose(
    read: Mapping[Path, Recording],
    series: Sequence[Recording],
    options: dict[str, Any],
    given: dict[str, Path | None],
    say: Callable[[str], None],
) -> Diagnosis:
    """Compare with the simulation that was given as a file, as its own recording, or not at all."""
    from fricomp.api.diagnose import diagnose as diagnose_joint
    from fricomp.errors import DiagnosisError

    files: dict[str, Any] = dict(given)
    if files["simulated"] is not None:
        if options["simulation"] is not None or files["friction"] is not None:
            raise DiagnosisError("--simulated is the simulation: leave out --simulation and --friction")
        files["simulated"] = read[files["simulated"]]
    return diagnose_joint(series, **options, **files, progress=say)


def _facts(
    paths: Sequence[Path], series: Sequence[Recording], options: dict[str, Any], given: dict[str, Path | None]
) -> dict[str, str]:
    from fricomp.version import __version__

    facts = {"version of fricomp": __version__}
    for path, one in zip(paths, series, strict=True):
        size = f"{len(one)} samples, {one.duration:.4g} s, {1.0 / one.sample_period:.4g} Hz"
        facts[str(path)] = f"{size}, sha256 {one.content_hash[:16]}"
    used = {name: value for name, value in {**options, **given}.items() if value not in (None, False)}
    return facts | {name: str(value) for name, value in used.items()}


def _print_diagnosis(run: DiagnosisRun, out: Path) -> None:
    """What is wrong, where, and what to do; numbers of what was named; where all the rest is."""
    from fricomp.cli.terminal import console
    from fricomp.diagnosis.report import build_brief_effect_table, build_change_table, describe_next_step

    show, record = console(), run.diagnosis.record
    for warning in run.warnings:
        show.print(warning, style="yellow", markup=False)
    for number, sentence in enumerate(record.summary):
        style = "bold" if number == 0 else "yellow" if "Careful: " in sentence else None
        show.print(sentence, style=style, markup=False)
    step = describe_next_step(record, out)
    if step is not None:
        show.print(step, markup=False, soft_wrap=True)
    table = build_brief_effect_table(record) or build_change_table(record)
    if table is not None:
        show.print(rich_table(replace(table, caption="")))
    files = ", ".join(sorted(path.name for path in run.files if path.suffix != ".png"))
    where = (
        f"Verdict: {record.verdict}. All figures, pictures and remarks: report.html. In {out}{files and f': {files}'}"
    )
    show.print(where, soft_wrap=True, markup=False)


def _print_record(out: Path) -> None:
    """The record as it was written, which --schema describes."""
    from fricomp.cli.diagnosis.folder import RECORD

    hearing().answered = True
    print((out / RECORD).read_text(encoding="utf-8"), end="")


def _diagnose_fleet(
    sources: Sequence[str], out: Path, options: dict[str, Any], given: dict[str, Path | None], run: FleetRun
) -> None:
    """Every joint into a folder of its own, and a page on all of them."""
    from functools import partial

    from fricomp.cli.diagnosis.folder import check_folder
    from fricomp.diagnosis.report import build_fleet_table, write_fleet
    from fricomp.fleet import FleetJoint, list_joints

    require("pyarrow")
    defaults = FleetJoint("", (), options["simulation"], options["joint"], given["friction"])
    joints = list_joints(sources, defaults)
    work = partial(_diagnose_one, options=options, given=given)

    def check(joint: FleetJoint, folder: Path) -> None:
        inputs = (joint.simulation, joint.friction, given["simulated"], given["controller"])
        check_folder(folder, (*joint.recordings, *(path for path in inputs if path is not None)))

    settings = _fleet_settings(options, given) | {"command": "diagnose"}
    rows = run_joints(joints, work, out, run, settings, "diagnosing joints", check=check)
    show_fleet(rows, build_fleet_table, write_fleet(rows, out), run)


def _fleet_settings(options: dict[str, Any], given: dict[str, Path | None]) -> dict[str, str]:
    """What the rows of a fleet depend on: options, whole paths, and the content of the files that all joints share.

    The content of a simulation or a friction model is kept with the row of each joint.
    """
    from hashlib import sha256

    from fricomp.untrusted import read_whole

    settings = {}
    for name, value in {**options, **given}.items():
        settings[name] = str(value.absolute() if isinstance(value, Path) else value)
        if name in ("simulated", "controller") and value is not None:
            settings[name] += f", sha256 {sha256(read_whole(value)).hexdigest()}"
    return settings


def _diagnose_one(joint: FleetJoint, out: Path, *, options: dict[str, Any], given: dict[str, Path | None]) -> FleetRow:
    """On a worker: diagnose one joint of a fleet."""
    from fricomp.diagnosis.report import build_fleet_row

    options = options | {"simulation": joint.simulation, "joint": joint.joint}
    run = run_diagnosis(joint.recordings, out, options, given | {"friction": joint.friction}, quiet=True)
    return build_fleet_row(run.diagnosis.record) | {"warnings": "\n".join(run.warnings)}
