"""`fricomp convert`: recordings of other formats become native ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricomp.cli.option.cut import Cut, From, To
from fricomp.cli.option.panel import Overwrite
from fricomp.errors import RecordingError
from fricomp.untrusted import find_place

if TYPE_CHECKING:
    from fricomp.recording import NamedRecording
    from fricomp.recording.inspection.inspection import Inspection

__all__ = ["app", "convert"]

app = typer.Typer(add_completion=False)

EXIT_SOME_REFUSED = 1
"""Exit status where some recordings were written, and the checks refuse others."""

_EPILOG = """
fricomp convert log.csv --inspect

fricomp convert log.csv --inspect --out log.toml

fricomp convert DATA_EMPS.mat --mapping emps --out train.csv

fricomp convert log.csv --joint elbow --from 12 --to 60 --out elbow.csv

fricomp convert log.mcap --mapping my_robot.toml --rate 500 --out elbow.parquet

fricomp convert ur-20_02_19_14harm50sec.csv --mapping ur10e --only joint_2 --out joint_2.csv

docs/recordings.md says what a mapping file holds.
"""


@app.command(epilog=_EPILOG)
def convert(
    source: Annotated[
        Path, typer.Argument(help="MAT, HDF5, NPZ, NPY, JSON, CSV, text, Parquet, binary, MCAP or rosbag2.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="CSV or Parquet file; several recordings add their names to it.")
    ] = None,
    mapping: Annotated[
        str,
        typer.Option(help="TOML file, or the name of a mapping in the package; without it names of columns decide."),
    ] = "",
    only: Annotated[
        list[str] | None, typer.Option("--only", "--joint", help="Joint or recording to take; repeat for more.")
    ] = None,
    rate: Annotated[float | None, typer.Option(help="Resample to this rate [Hz].")] = None,
    skip_bad_rows: Annotated[
        bool, typer.Option("--skip-bad-rows", help="Leave out rows without a number or a later time.")
    ] = False,
    row_rate: Annotated[
        float | None, typer.Option(help="Rows a second [Hz] in place of stamps that are held or missing.")
    ] = None,
    split: Annotated[
        bool, typer.Option("--split", help="Write the usable parts, each into a file of its own, without the rest.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Write even what the checks call an error.")] = False,
    inspect: Annotated[
        bool,
        typer.Option("--inspect", help="Say what each column is taken for and why; --out FILE.toml writes a mapping."),
    ] = False,
    channel: Annotated[
        list[str] | None, typer.Option(help="CHANNEL=COLUMN, where several could be one: torque=tau_measured.")
    ] = None,
    start: From = None,
    stop: To = None,
    overwrite: Overwrite = False,
) -> None:
    """Bring recordings of other formats into the native one, and check them."""
    from fricomp.cli.diagnosis.arm import ArmOptions
    from fricomp.cli.output import answer
    from fricomp.recording import intake, raise_errors, write_recording
    from fricomp.results import claim_single_files

    how = intake.Intake(mapping, ArmOptions(channel=channel).channels, rate, row_rate, skip_bad_rows)
    if inspect:
        _inspect(source, out, how.channels, overwrite=overwrite)
        return
    if out is None:
        raise RecordingError("say where with --out FILE.csv, or look at the log with --inspect")
    cut = Cut(start, stop)
    read = intake.select_recordings(intake.read_source(source, how), only or [])
    found = [replace(one, recording=cut.apply(one.recording)) for one in read]
    if split:
        found = [part for named in found for part in intake.split_usable(named)]
    else:
        found = [intake.note_unusable(named) for named in found]
    targets = {named.name: _target(out, named.name, alone=len(found) == 1) for named in found}
    places = [targets[named.name] for named in found]  # two of one name would be one file
    _require_different(places)
    with claim_single_files(places, overwrite=overwrite, inputs=(source, Path(mapping))):
        found = [intake.check_named(named) for named in found]
        refused = [] if force else [named for named in found if named.faults]
        if len(refused) == len(found):
            raise_errors(refused[0].findings, f"{source}, {refused[0].name}")
        written = [named for named in found if force or not named.faults]
        for named in written:
            write_recording(named.recording, targets[named.name])
    answer([_describe(one, targets[one.name]) for one in written] + [_describe(one, None) for one in refused])
    _show(written, targets)
    _show_refused(refused)
    if refused:
        raise typer.Exit(EXIT_SOME_REFUSED)


def _inspect(source: Path, out: Path | None, channels: Mapping[str, str], *, overwrite: bool) -> None:
    """Say what a log holds, and write the mapping or show it."""
    from fricomp.recording.inspection.inspection import inspect_log
    from fricomp.results import claim_single_files

    with claim_single_files([] if out is None else [out], overwrite=overwrite, inputs=[source]):
        _show_inspection(inspect_log(source, channels), source, out)


def _show_inspection(seen: Inspection, source: Path, out: Path | None) -> None:
    from fricomp.cli.terminal import Table, console
    from fricomp.recording.inspection.mapping_text import render_mapping

    screen = console()
    table = Table("column", "numbers", "from", "to", "taken for", "why", box=None, pad_edge=False)
    for column in seen.columns:
        edges = (f"{column.lowest:.4g}", f"{column.highest:.4g}")
        table.add_row(column.name, str(column.rows), *edges, column.taken_for or "–", column.why)
    screen.print(table)
    if seen.log is None:
        screen.print(f"\n{seen.refusal}", soft_wrap=True, markup=False)
        _show_mapping(source, seen.guess, out, "As a mapping, by what the numbers do")
        return
    for note in seen.log.notes[:-1]:  # the last one says what the table says
        screen.print(f"\n{note}", soft_wrap=True, markup=False)
    for one in seen.log.recordings:
        rate = 1.0 / one.sample_period
        screen.print(f"\n{one.metadata.joint}: {len(one)} samples, {one.duration:.4g} s at {rate:.5g} Hz", style="bold")
        for finding in seen.findings[one.metadata.joint]:
            screen.print(f"  {finding.severity}: {finding}", soft_wrap=True)
    _show_mapping(source, render_mapping(source, seen.log, seen.findings), out, "As a mapping")


def _show_mapping(source: Path, text: str, out: Path | None, what: str) -> None:
    """Write a mapping to edit, or show it."""
    from fricomp.cli.terminal import console
    from fricomp.whole_file import write_whole

    screen = console()
    if out is None:
        screen.print(f"\n{what} (--out FILE.toml writes it):\n\n{text}", soft_wrap=True, markup=False)
    else:
        write_whole(out, text, RecordingError)
        screen.print(
            f"\nMapping {out}: edit it, then fricomp convert {source} --mapping {out} --out FILE.csv", soft_wrap=True
        )


def _require_different(targets: list[Path]) -> None:
    """Refuse to write one recording over another."""
    places = [find_place(target) for target in targets]
    for target, place in zip(targets, places, strict=True):
        if places.count(place) > 1:
            raise RecordingError(
                f"{places.count(place)} recordings would be {target}: choose one by --only, or give the joints names "
                "of their own in the mapping"
            )


def _target(out: Path, name: str, *, alone: bool) -> Path:
    from fricomp.results import plain_name

    return out if alone else out.with_stem(f"{out.stem}_{plain_name(name)}")


def _show_refused(refused: Sequence[NamedRecording]) -> None:
    """Say of the recordings that were not written why."""
    from fricomp.cli.terminal import console

    for named in refused:
        fault = f"{named.name}: not written: {named.faults[0]}"
        console().print(fault, style="yellow", soft_wrap=True, markup=False)


def _describe(named: NamedRecording, target: Path | None) -> dict[str, Any]:
    """What a program wants of a recording that was written, or refused: then there is no file."""
    recording = named.recording
    return {
        "name": named.name,
        "joint": recording.metadata.joint,
        "file": target,
        "samples": len(recording),
        "duration": recording.duration,
        "rate": 1.0 / recording.sample_period,
        "torque_unit": recording.metadata.torque_unit,
        "channels": list(recording.channels),
        "findings": [{"severity": one.severity, "code": one.code, "text": str(one)} for one in named.findings],
    }


def _show(found: Sequence[NamedRecording], targets: Mapping[str, Path]) -> None:
    from rich.text import Text

    from fricomp.cli.terminal import console

    screen = console()
    for named in found:
        recording = named.recording
        channels = ", ".join(name for name in recording.channels if name != "time")
        rate, unit = 1 / recording.sample_period, recording.metadata.torque_unit
        facts = f"{len(recording)} samples, {recording.duration:.4g} s at {rate:.5g} Hz, torque in {unit}: {channels}"
        screen.print(Text.assemble((named.name, "bold"), f" → {targets[named.name]}"), soft_wrap=True)
        screen.print(f"  {facts}", soft_wrap=True)
        for finding in named.findings:
            screen.print(f"  {finding.severity}: {finding}", soft_wrap=True)
