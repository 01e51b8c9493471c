"""`fricomp bench mismatch`: what the diagnosis names in joints whose truth is concealed from it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from fricomp.sim_bench.proof import PlannedCase, Score

app = typer.Typer()

_EPILOG = """fricomp bench mismatch --quick --out runs/mismatch

fricomp bench mismatch --scored --cases 2000 --resume --page docs/proof.md --out runs/scored

fricomp bench mismatch --cases 200 --executor dask://scheduler:8786 --out runs/mismatch"""
_QUICK, _FULL = 12, 2000
_LOG = Path("docs/proof/runs.jsonl")


@app.command(epilog=_EPILOG)
def mismatch(
    out: Annotated[Path, typer.Option(help="Folder for seals, answers, diagnoses and scores.")],
    quick: Annotated[bool, typer.Option("--quick", help=f"{_QUICK} cases of 30 s.")] = False,
    clear: Annotated[bool, typer.Option("--clear", help="Every effect once, clear, 30 s, with nulls between.")] = False,
    cases: Annotated[int | None, typer.Option(min=1, help=f"How many; {_FULL} by default.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the run in OUT.")] = False,
    scored: Annotated[bool, typer.Option("--scored", help="Seeds that follow from the committed diagnosis.")] = False,
    first_seed: Annotated[int, typer.Option(help="First development seed.")] = 0,
    executor: Annotated[str, typer.Option(help="processes://N, serial or dask://host:port.")] = "processes",
    baselines: Annotated[int, typer.Option(min=0, help="Try the other methods on this many of the cases.")] = 0,
    page: Annotated[Path | None, typer.Option(help="Write this page, such as docs/proof.md.")] = None,
) -> None:
    """Conceal physics in simulated joints, diagnose them blind, and score the answers."""
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.proof import compute_figures, format_failures, write_page

    count = cases or (_QUICK if quick else _FULL)
    wanted = {"cases": count, "quick": quick, "clear": clear, "scored": scored, "first_seed": first_seed}
    settings = _settings(out, wanted, resume)
    planned = _plan(settings)
    scores = _run(planned, out, executor, settings)
    others = _compare(planned[:baselines], out, executor, scores)
    show = console()
    show.print(_table(compute_figures(scores)))
    (out / "failures.md").write_text(format_failures(scores), encoding="utf-8")
    show.print(f"{len(scores)} cases in {out}; wrong answers in {out / 'failures.md'}", soft_wrap=True)
    if page is not None:
        write_page(
            scores, page, title=_title(settings, len(scores)), reproduce=_reproduce(settings, out), baselines=others
        )
        _keep_data(out, page.with_suffix(""))
        show.print(f"{page} written", soft_wrap=True)


def _settings(out: Path, wanted: dict[str, Any], resume: bool) -> dict[str, Any]:
    """What decides the cases; a run that is resumed keeps its own."""
    import json
    import secrets

    from fricomp.errors import DiagnosisError
    from fricomp.sim_bench.proof import append_entry, diagnosis_tree, next_run

    path = out / "run.json"
    if path.exists():
        if not resume:
            raise DiagnosisError(f"{out} holds a run: give --resume to go on with it, or another --out")
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        return found | {"cases": wanted["cases"]}
    settings = wanted | {"salt": secrets.token_hex(16)}
    if wanted["scored"]:
        settings |= {"tree": diagnosis_tree(Path.cwd()), "run": next_run(_LOG)}
        append_entry(
            _LOG, {"run": settings["run"], "tree": settings["tree"], "event": "started", "cases": wanted["cases"]}
        )
    out.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(settings, indent=1) + "\n", encoding="utf-8")
    return settings


def _plan(settings: dict[str, Any]) -> Sequence[PlannedCase]:
    from fricomp.sim_bench.proof import development_seeds, plan_cases, plan_clear_cases, scored_seeds

    seeds: Iterator[int] = development_seeds(settings["first_seed"])
    if settings["scored"]:
        seeds = scored_seeds(settings["tree"], settings["run"])
    if settings["clear"]:
        return plan_clear_cases(seeds)[: settings["cases"]]
    return plan_cases(settings["cases"], seeds, 30.0 if settings["quick"] else None)


def _run(planned: Sequence[PlannedCase], out: Path, executor: str, settings: dict[str, Any]) -> list[Score]:
    from fricomp.cli.terminal import progress
    from fricomp.sim_bench.proof import append_entry, compute_figures, open_executor, run_proof

    with progress() as bar, open_executor(executor) as pool:
        done = len(list((out / "scores").glob("*.parquet")))
        task = bar.add_task("concealed cases", total=len(planned), completed=min(done, len(planned)))
        scores = run_proof(planned, out, pool, salt=settings["salt"], progress=lambda _: bar.advance(task))
    if settings["scored"]:
        figures = {figure.name: figure.value for figure in compute_figures(scores)}
        entry = {"run": settings["run"], "tree": settings["tree"], "event": "finished", "cases": len(scores)}
        append_entry(_LOG, entry | {"figures": figures})
    return scores


def _compare(planned: Sequence[PlannedCase], out: Path, executor: str, scores: Sequence[Score]) -> str:
    """The table of the other methods; that of an earlier call where none is asked for now."""
    from fricomp.sim_bench.proof import open_executor
    from fricomp.sim_bench.proof.baselines import compare_baselines, format_table

    path = out / "baselines.md"
    if planned:
        with open_executor(executor) as (pool, _):
            path.write_text(format_table(compare_baselines(planned, pool), scores) + "\n", encoding="utf-8")
    return path.read_text(encoding="utf-8") if path.exists() else ""


def _table(figures: Sequence[Any]) -> Any:
    from rich.table import Table

    table = Table("figure", "target", "measured (95 % interval)", "reached")
    for figure in figures:
        style = "" if figure.reached is not False else "bold"
        mark = {True: "yes", False: "no", None: "–"}[figure.reached]
        table.add_row(figure.name, figure.target, figure.value, mark, style=style)
    return table


def _title(settings: dict[str, Any], count: int) -> str:
    if settings["scored"]:
        return f"Scored run {settings['run']} of the diagnosis with tree {settings['tree'][:12]}: {count} cases."
    return f"Development seeds from {settings['first_seed']}: {count} cases. No scored run."


def _reproduce(settings: dict[str, Any], out: Path) -> str:
    seeds = "--scored" if settings["scored"] else f"--first-seed {settings['first_seed']}"
    quick = "".join(f"--{name} " for name in ("quick", "clear") if settings[name])
    return f"fricomp bench mismatch {quick}--cases {settings['cases']} {seeds} --page docs/proof.md --out {out.name}"


def _keep_data(out: Path, folder: Path) -> None:
    """Seals and scored answers as data beside the page."""
    import shutil

    from pyarrow import concat_tables, parquet

    tables = [parquet.read_table(path) for path in sorted((out / "scores").glob("*.parquet"))]
    parquet.write_table(concat_tables(tables), folder / "scores.parquet")
    shutil.copyfile(out / "seals.jsonl", folder / "seals.jsonl")
