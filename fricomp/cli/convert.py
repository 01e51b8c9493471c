"""`fricomp convert`: recordings of other formats become native ones."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricomp.cli.option.cut import Cut, From, To
from fricomp.cli.option.panel import Overwrite
from fricomp.errors import RecordingError

if TYPE_CHECKING:
    from fricomp.recording import Finding, Mapping, NamedRecording, Recording
    from fricomp.recording.inspection.inspection import Inspection
    from fricomp.recording.mapping import FileRule, JointRule

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
    source: Annotated[Path, typer.Argument(help="MAT, NPZ, NPY, JSON, CSV, text, Parquet, binary, MCAP or rosbag2.")],
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
    rate: Annotated[float | None, typer.Option(help="Resample to this rate \\[Hz].")] = None,
    skip_bad_rows: Annotated[bool, typer.Option(help="Leave out rows without a number or a later time.")] = False,
    row_rate: Annotated[
        float | None, typer.Option(help="Rows a second \\[Hz] in place of stamps that are held or missing.")
    ] = None,
    split: Annotated[
        bool, typer.Option("--split", help="Write the usable parts, each into a file of its own, without the rest.")
    ] = False,
    force: Annotated[bool, typer.Option(help="Write even what the checks call an error.")] = False,
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
    from dataclasses import replace

    from fricomp.cli.output import answer
    from fricomp.recording import raise_errors, write_recording
    from fricomp.results import claim_single_files

    if inspect:
        _inspect(source, out, _columns_of(channel or [], mapping), overwrite=overwrite)
        return
    if out is None:
        raise RecordingError("say where with --out FILE.csv, or look at the log with --inspect")
    if rate is not None and not 0.0 < rate < float("inf"):
        raise RecordingError(f"--rate is {rate:g}: give samples a second above 0 [Hz], or leave it out")
    if row_rate is not None and not 0.0 < row_rate < float("inf"):
        raise RecordingError(f"--row-rate is {row_rate:g}: give rows a second above 0 [Hz], or leave it out")
    asked = _columns_of(channel or [], mapping)
    read = _read(source, mapping, rate, row_rate, asked, skip_bad_rows=skip_bad_rows)
    cut = Cut(start, stop)
    found = [replace(one, recording=cut.apply(one.recording)) for one in _select(read, only or [])]
    found = [part for named in found for part in _split(named)] if split else [_with_note(named) for named in found]
    targets = {named.name: _target(out, named.name, alone=len(found) == 1) for named in found}
    places = [targets[named.name] for named in found]
    _require_different(places)
    with claim_single_files(places, overwrite=overwrite, inputs=(source, Path(mapping))):
        findings = {named.name: _add(named.findings, _check(named.recording)) for named in found}
        refused = [] if force else [one for one in found if any(f.severity == "error" for f in findings[one.name])]
        if len(refused) == len(found):
            raise_errors(findings[refused[0].name], f"{source}, {refused[0].name}")
        found = [one for one in found if not any(one is other for other in refused)]
        for named in found:
            write_recording(named.recording, targets[named.name])
    written = [_describe(named, findings[named.name], targets[named.name]) for named in found]
    answer(written + [_describe(named, findings[named.name], None) for named in refused])
    _show(found, findings, targets)
    _show_refused(refused, findings)
    if refused:
        raise typer.Exit(EXIT_SOME_REFUSED)


def _split(named: NamedRecording) -> list[NamedRecording]:
    """The usable parts, numbered where there are several; what was left out is told with the first."""
    from dataclasses import replace

    from fricomp.recording import Finding
    from fricomp.recording.parts.parts import find_usable_parts

    usable = find_usable_parts(named.recording)
    several = len(usable.parts) > 1
    parts = [
        replace(named, name=f"{named.name}/part_{number}" if several else named.name, recording=part, findings=())
        for number, part in enumerate(usable.parts, 1)
    ]
    told = tuple(Finding("parts", "note", sentence.rstrip("."), "nothing to do") for sentence in usable.sentences)
    return [replace(parts[0], findings=named.findings + told), *parts[1:]]


def _check(recording: Recording) -> tuple[Finding, ...]:
    """What the checks find; errors that identify and diagnose mend by themselves are warnings."""
    from dataclasses import replace

    from fricomp.recording import check_recording
    from fricomp.recording.parts.parts import find_usable_parts

    findings = check_recording(recording)
    if not any(one.severity == "error" for one in findings):
        return findings
    left = {one.code for one in check_recording(find_usable_parts(recording).kept) if one.severity == "error"}
    return tuple(
        replace(one, severity="warning", advice=f"{one.advice}; identify and diagnose do so by themselves")
        if one.severity == "error" and one.code not in left
        else one
        for one in findings
    )


def _with_note(named: NamedRecording) -> NamedRecording:
    """The recording with a note on what identify and diagnose will leave out of it; it is written as it is."""
    from dataclasses import replace

    from fricomp.recording import Finding
    from fricomp.recording.parts.parts import find_usable_parts

    advice = "identify and diagnose do so by themselves; --split writes what they use"
    said = find_usable_parts(named.recording).sentences
    return replace(
        named, findings=named.findings + tuple(Finding("parts", "note", one.rstrip("."), advice) for one in said[:1])
    )


def _read(
    source: Path,
    mapping: str,
    rate: float | None,
    row_rate: float | None,
    channels: dict[str, str],
    *,
    skip_bad_rows: bool,
) -> list[NamedRecording]:
    from fricomp.recording import Finding, NamedRecording, convert
    from fricomp.recording.file import is_own, read_content
    from fricomp.recording.named.log import read_named_log

    if mapping:
        return list(convert(source, _adjust(mapping, rate, row_rate, skip_bad_rows=skip_bad_rows)))
    if is_own(source) and not channels:
        recording, findings = read_content(source, skip_bad_rows=skip_bad_rows, row_rate=row_rate)
        found = [NamedRecording(source.stem, recording, findings)]
    else:
        log = read_named_log(source, channels, row_rate=row_rate)
        told = tuple(Finding("named_columns", "note", note.rstrip("."), "--inspect tells why") for note in log.notes)
        found = [NamedRecording(one.metadata.joint, one, told) for one in log.recordings]
    return found if rate is None else [_resample(named, rate) for named in found]


def _resample(named: NamedRecording, rate: float) -> NamedRecording:
    from dataclasses import replace

    from fricomp.recording.resampling import resample_checked

    recording, before = resample_checked(named.recording, rate)
    return replace(named, recording=recording, findings=named.findings + before)


def _columns_of(channel: list[str], mapping: str) -> dict[str, str]:
    """Column by channel, as the command line says."""
    from fricomp.cli.diagnosis.arm import ArmOptions

    if channel and mapping:
        raise RecordingError("--channel is for logs without --mapping: say it in the mapping")
    return ArmOptions(channel=channel).channels


def _inspect(source: Path, out: Path | None, channels: dict[str, str], *, overwrite: bool) -> None:
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
    _show_mapping(source, render_mapping(source, seen.log), out, "As a mapping")


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


def _adjust(name: str, rate: float | None, row_rate: float | None, *, skip_bad_rows: bool) -> Mapping:
    """The mapping, with what the command line asks for on top."""
    import msgspec

    from fricomp.recording import load_mapping

    mapping = load_mapping(name)
    if row_rate is not None:
        mapping = _with_row_rate(mapping, row_rate)
    return msgspec.structs.replace(
        mapping,
        resample_rate=mapping.resample_rate if rate is None else rate,
        skip_bad_rows=skip_bad_rows or mapping.skip_bad_rows,
    )


def _with_row_rate(mapping: Mapping, row_rate: float) -> Mapping:
    """The mapping with a time of so many rows a second [Hz] everywhere."""
    import msgspec

    from fricomp.recording.mapping import ChannelRule

    clock = {"time": ChannelRule(rate=row_rate)}
    replace = msgspec.structs.replace

    def counted(rules: tuple[FileRule, ...] | tuple[JointRule, ...]) -> tuple[Any, ...]:
        return tuple(replace(one, channels={**one.channels, **clock}) for one in rules)

    channels = {**mapping.channels, **clock}
    return replace(mapping, channels=channels, files=counted(mapping.files), joints=counted(mapping.joints))


def _select(found: list[NamedRecording], only: list[str]) -> list[NamedRecording]:
    if not only:
        return found
    names = [{named.name, *named.name.split("/"), named.recording.metadata.joint} for named in found]
    for wanted in only:
        if not any(wanted in known for known in names):
            valid = ", ".join(named.name for named in found)
            raise RecordingError(f"the source has no recording or joint {wanted!r}: valid are {valid}")
    return [named for named, known in zip(found, names, strict=True) if known & set(only)]


def _require_different(targets: list[Path]) -> None:
    """Refuse to write one recording over another."""
    places = [target.resolve() for target in targets]
    for target, place in zip(targets, places, strict=True):
        if places.count(place) > 1:
            raise RecordingError(
                f"{places.count(place)} recordings would be {target}: choose one by --only, or give the joints names "
                "of their own in the mapping"
            )


def _add(before: tuple[Finding, ...], now: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Findings of the source and of what was made of it, each once."""
    told = {(finding.code, finding.column) for finding in before}
    return before + tuple(finding for finding in now if (finding.code, finding.column) not in told)


def _target(out: Path, name: str, *, alone: bool) -> Path:
    from fricomp.results import plain_name

    return out if alone else out.with_stem(f"{out.stem}_{plain_name(name)}")


def _show_refused(refused: list[NamedRecording], findings: dict[str, tuple[Finding, ...]]) -> None:
    """Say of the recordings that were not written why."""
    from fricomp.cli.terminal import console

    for named in refused:
        fault = next(one for one in findings[named.name] if one.severity == "error")
        console().print(f"{named.name}: not written: {fault}", style="yellow", soft_wrap=True, markup=False)


def _describe(named: NamedRecording, findings: tuple[Finding, ...], target: Path | None) -> dict[str, Any]:
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
        "findings": [{"severity": one.severity, "code": one.code, "text": str(one)} for one in findings],
    }


def _show(found: list[NamedRecording], findings: dict[str, tuple[Finding, ...]], targets: dict[str, Path]) -> None:
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
        for finding in findings[named.name]:
            screen.print(f"  {finding.severity}: {finding}", soft_wrap=True)
