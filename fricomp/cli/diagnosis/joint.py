"""One joint's diagnosis on the command line: read, diagnosed, written and told."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fricomp.cli.diagnosis.folder import RECORD
from fricomp.cli.fleet import rich_table
from fricomp.cli.output import hearing, say_interrupted

if TYPE_CHECKING:
    from fricomp.diagnosis import Diagnosis
    from fricomp.recording import Recording


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
    from fricomp.result_kinds import DIAGNOSIS
    from fricomp.results import claim_folder

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


def print_diagnosis(run: DiagnosisRun, out: Path) -> None:
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


def print_record(out: Path) -> None:
    """The record as it was written, which --schema describes."""
    hearing().answered = True
    print((out / RECORD).read_text(encoding="utf-8"), end="")


@contextmanager
def interruptible(out: Path) -> Iterator[None]:
    """One joint's diagnosis: on Ctrl-C it says what is left in its folder."""
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
