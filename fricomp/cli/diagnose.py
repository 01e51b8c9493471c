"""`fricomp diagnose`: find the physics that a simulation leaves out, in recordings of the real joint."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from fricomp.recording import Recording
    from fricomp.report import Table
    from fricomp.sim_bench.diagnosis import Diagnosis

app = typer.Typer()

_EXAMPLES = """[bold]Examples[/bold]

fricomp diagnose elbow.csv --simulation robot.xml --joint elbow --out runs/why

fricomp diagnose light.csv heavy.csv --out runs/payloads

fricomp diagnose real.csv --simulated from_my_simulator.csv --out runs/why

fricomp diagnose 'fleet/*.parquet' --each --out runs/fleet
"""


@app.command(epilog=_EXAMPLES)
def diagnose(
    recordings: Annotated[list[str], typer.Argument(help="Recordings of one joint: files, folders or patterns.")],
    out: Annotated[Path, typer.Option(help="Folder for the report, the record and the models.")],
    simulation: Annotated[
        Path | None, typer.Option(help="MJCF or URDF of the joint; a rigid joint is identified without it.")
    ] = None,
    joint: Annotated[
        str | None, typer.Option(help="Name of the joint; needed where the simulation has several.")
    ] = None,
    friction: Annotated[Path | None, typer.Option(help="Friction model of the simulation (friction.json).")] = None,
    simulated: Annotated[
        Path | None, typer.Option(help="Recording that your simulator made under the same commands.")
    ] = None,
    controller: Annotated[
        Path | None, typer.Option(help="PD or PID loop that moved the joint (TOML); it is estimated without it.")
    ] = None,
    thorough: Annotated[bool, typer.Option("--thorough", help="More nulls for the thresholds; takes longer.")] = False,
    each: Annotated[
        bool, typer.Option("--each", help="Every recording on its own, each into a subfolder of --out.")
    ] = False,
    seed: Annotated[int, typer.Option(help="Of nulls and bootstraps; the same seed gives the same answer.")] = 0,
) -> None:
    """Say where simulation and recording differ, which physics is missing, and how much the fit improves.

    Plain sentences come first, here and in report.html. Several recordings are taken as one joint's, such as with
    two payloads; --each takes them as different joints.
    """
    options = {"thorough": thorough, "seed": seed, "joint": joint, "simulation": simulation}
    given = {"friction": friction, "simulated": simulated, "controller": controller}
    paths = find_recordings(recordings)
    if not each:
        _print_diagnosis(run_diagnosis(paths, out, options, given), out)
        return
    rows = []
    for path, folder in zip(paths, _subfolders(paths, out), strict=True):
        rows.append((path.stem, folder, run_diagnosis([path], folder, options, given)))
    _print_fleet(rows, out)


def find_recordings(sources: Sequence[str]) -> list[Path]:
    """Files that are meant by files, folders and patterns, in the order given.

    Raises:
        RecordingError: A source matches no recording.
    """
    from fricomp.errors import RecordingError

    found: list[Path] = []
    for source in sources:
        path = Path(source)
        if path.is_dir():
            matches = sorted(p for p in path.iterdir() if p.suffix in (".csv", ".parquet"))
        elif any(character in source for character in "*?[") and not path.exists():
            matches = sorted(map(Path, glob(source, recursive=True)))
        else:
            matches = [path]
        if not matches:
            raise RecordingError(
                f"{source} holds no recording: give .csv or .parquet files; fricomp convert makes them"
            )
        found += matches
    return list(dict.fromkeys(found))


def run_diagnosis(
    paths: Sequence[Path], out: Path, options: dict[str, Any], given: dict[str, Path | None]
) -> Diagnosis:
    """Read, diagnose, and write the folder.

    Args:
        paths: Recordings of one joint.
        out: Folder to write.
        options: Of `diagnose`, and the simulation.
        given: Files by option; None where the option was not used.
    """
    from time import perf_counter

    from fricomp.cli.terminal import progress
    from fricomp.recording import read_recording
    from fricomp.sim_bench.diagnosis.presentation import with_names, write_diagnosis

    start = perf_counter()
    with progress() as bar:
        task = bar.add_task("reading", total=None)
        series = [read_recording(path) for path in paths]

        def say(what: str) -> None:
            bar.update(task, description=what)

        diagnosis = with_names(_diagnose(series, options, given, say), [path.stem for path in paths])
        say("writing the report")
        facts = _facts(paths, series, options, given) | {"time taken": f"{perf_counter() - start:.1f} s"}
        write_diagnosis(diagnosis, out, simulation=options["simulation"], joint=options["joint"], facts=facts)
    return diagnosis


def _diagnose(
    series: Sequence[Recording], options: dict[str, Any], given: dict[str, Path | None], say: Callable[[str], None]
) -> Diagnosis:
    """Compare with the simulation that was given as a file, as its own recording, or not at all."""
    from fricomp.errors import DiagnosisError
    from fricomp.model import load_model
    from fricomp.recording import read_recording
    from fricomp.sim_bench.diagnosis import diagnose as diagnose_joint
    from fricomp.sim_bench.diagnosis import read_controller
    from fricomp.sim_bench.diagnosis.simulated import read_simulated, without_known

    settings: dict[str, Any] = {**options, "progress": say}
    settings["controller"] = read_controller(given["controller"]) if given["controller"] is not None else None
    if given["simulated"] is None:
        friction = load_model(given["friction"]) if given["friction"] is not None else None
        return diagnose_joint(series, friction=friction, **settings)
    if options["simulation"] is not None or given["friction"] is not None:
        raise DiagnosisError("--simulated is the simulation: leave out --simulation and --friction")
    say("reading the simulation from its recording")
    known = read_simulated(read_recording(given["simulated"]), seed=options["seed"], progress=say)
    settings["simulation"] = known.rigid
    return without_known(diagnose_joint(series, friction=known.friction, **settings), known)


def _facts(
    paths: Sequence[Path], series: Sequence[Recording], options: dict[str, Any], given: dict[str, Path | None]
) -> dict[str, str]:
    from fricomp import __version__

    facts = {"version of fricomp": __version__}
    for path, one in zip(paths, series, strict=True):
        size = f"{len(one)} samples, {one.duration:.4g} s, {1.0 / one.sample_period:.4g} Hz"
        facts[str(path)] = f"{size}, sha256 {one.content_hash[:16]}"
    used = {name: value for name, value in {**options, **given}.items() if value not in (None, False)}
    return facts | {name: str(value) for name, value in used.items()}


def _print_diagnosis(diagnosis: Diagnosis, out: Path) -> None:
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.diagnosis.presentation import change_table, effect_table, error_table, forward_table

    show, record = console(), diagnosis.record
    for number, sentence in enumerate(record.sentences):
        show.print(sentence, style="bold" if number == 0 else None, markup=False)
    for table in (effect_table(record), change_table(record), error_table(record), forward_table(record)):
        if table is not None:
            show.print()
            show.print(_rich(table))
    if record.next_experiment is not None:
        show.print(f"\nTo tell more: {record.next_experiment.why}", markup=False)
    files = ", ".join(sorted(path.name for path in out.iterdir() if path.suffix != ".png"))
    show.print(f"\nVerdict: {record.verdict}. In {out}: {files}", soft_wrap=True, markup=False)


def _rich(table: Table) -> Any:
    """A table of the report for the terminal."""
    from rich.markup import escape
    from rich.table import Table as RichTable

    shown = RichTable(title=table.caption or None, title_justify="left", box=None, pad_edge=False)
    for column in table.columns:
        shown.add_column(escape(column), overflow="fold")
    for row in table.rows:
        shown.add_row(*map(escape, row))
    return shown


def _subfolders(paths: Sequence[Path], out: Path) -> list[Path]:
    """A folder for each recording, named after it; the folder above it is added where names repeat."""
    stems = [path.stem for path in paths]
    names = [path.stem if stems.count(path.stem) == 1 else f"{path.parent.name}-{path.stem}" for path in paths]
    return [out / name for name in names]


def _print_fleet(rows: Sequence[tuple[str, Path, Diagnosis]], out: Path) -> None:
    from fricomp.cli.terminal import console
    from fricomp.report import Table
    from fricomp.sim_bench.diagnosis.presentation import write_fleet

    columns = ("recording", "verdict", "named", "held-out error", "report")
    entries = []
    for name, folder, diagnosis in rows:
        held = diagnosis.heldout
        error = "–" if held is None else f"{held.rmse_before:.3g} → {held.rmse_after:.3g} {held.unit}"
        named = ", ".join(effect.name for effect in diagnosis.effects) or "–"
        entries.append((name, diagnosis.verdict, named, error, str(folder.relative_to(out) / "report.html")))
    table = Table(columns, tuple(entries))
    page = write_fleet(table, [(name, diagnosis) for name, _, diagnosis in rows], out)
    show = console()
    show.print(_rich(table))
    show.print(f"\nThe whole fleet: {page}", soft_wrap=True, markup=False)
