"""`fricomp watch`: how the friction of joints goes over weeks, what has changed, and when."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricomp.cli.option.page import OpenPage, open_page
from fricomp.cli.option.panel import Overwrite, output_option

if TYPE_CHECKING:
    from fricomp.calibration.history import JointHistory
    from fricomp.calibration.kept_model import Estimate
    from fricomp.report import ReportPage

app = typer.Typer(add_completion=False)

EXIT_CHANGED = 1
"""Exit status of --fail-if-changed where the last model of a joint differs from the one before."""
_ONE_SITTING = 3600.0
"""Time within which all models were made on the same day by whoever looks at old recordings [s]."""


@app.command(epilog="fricomp watch runs --out runs/watch.html --open\n\nfricomp watch runs --fail-if-changed --json")
def watch(
    folder: Annotated[
        Path, typer.Argument(help="Folder with models (friction.json) of one joint or many, at any depth.")
    ],
    out: Annotated[Path | None, output_option(help="Page to write (HTML).")] = None,
    fail_if_changed: Annotated[
        bool, typer.Option("--fail-if-changed", help="Exit status 1 where the last model of a joint shows a change.")
    ] = False,
    overwrite: Overwrite = False,
    open_report: OpenPage = False,
) -> None:
    """Follow joints over many calibrations, identifications or diagnoses: trends with intervals, changes with dates.

    A trend is the change of a parameter a day, with its 95 % interval, from three models on. A change is one between a
    model and the one before, as fricomp compare tells it; of diagnoses, one of what they named and of their numbers.
    """
    from fricomp.calibration.history import read_histories
    from fricomp.cli.output import answer
    from fricomp.cli.terminal import console
    from fricomp.errors import ParameterError
    from fricomp.results import claim_single_files

    if not folder.is_dir():
        raise ParameterError(f"{folder} is no folder: give the one that the models lie in")
    with claim_single_files([] if out is None else [out], overwrite=overwrite):
        histories, left_out = read_histories(folder)
        if not histories:
            why = f"; left out: {'; '.join(left_out)}" if left_out else ""
            raise ParameterError(f"{folder} holds no model (friction.json) that can be followed{why}")
        answer({"joints": [_as_answer(one) for one in histories], "left_out": left_out})
        for history in histories:
            _print(history)
        for reason in left_out:
            console(stderr=True).print(f"Left out: {reason}", soft_wrap=True)
        if out is not None:
            from fricomp.report import write_report

            write_report(_build_page(histories), out)
            console().print(f"Page {out}", soft_wrap=True)
            open_page(out, wanted=open_report)
    if fail_if_changed and any(one.comparisons and _has_changed(one, -1) for one in histories):
        raise typer.Exit(EXIT_CHANGED)


def _has_changed(history: JointHistory, number: int) -> bool:
    found = history.comparisons[number]
    return found is not None and found.changed


def _tell_changes(history: JointHistory, *, numbers: bool = True) -> list[tuple[str, str]]:
    """Date of each model that differs from the one before, and in what, with both numbers where these are wanted."""
    from fricomp.calibration.history import shorten

    told = []
    for old, kept, found in zip(history.models, history.models[1:], history.comparisons, strict=False):
        if found is not None and found.changed:
            before = old.estimates if numbers else {}
            names = [_say_change(shorten(name), before.get(name), kept.estimates.get(name)) for name in found.names]
            terms = [*(f"new {name}" for name in found.added), *(f"without {name}" for name in found.removed)]
            told.append(
                (f"{kept.when:%Y-%m-%d %H:%M}", ", ".join([*names, *terms]) or "no single parameter stands out")
            )
    return told


def _say_change(name: str, before: Estimate | None, after: Estimate | None) -> str:
    return name if before is None or after is None else f"{name} {before.value:.4g} → {after.value:.4g} {after.unit}"


def _say_span(history: JointHistory) -> list[str]:
    """What limits what a history says: models that were not compared, and dates that are not of the recordings."""
    return [*_say_refusals(history), *_say_dates(history)]


def _say_refusals(history: JointHistory) -> list[str]:
    """Which models could not be compared with the one before, by the reason: of these no change is told."""
    which: dict[str, list[str]] = {}
    for kept, reason in zip(history.models[1:], history.refusals, strict=False):
        if reason:
            which.setdefault(reason, []).append(f"{kept.when:%Y-%m-%d %H:%M}")
    return [f"Not compared with the one before, {', '.join(when)} UTC: {why}." for why, when in which.items()]


def _say_dates(history: JointHistory) -> list[str]:
    """That dates are those of the identification, where some are, or all models were made one after the other."""
    first, last = history.models[0].when, history.models[-1].when
    dated = sum(one.is_dated for one in history.models)
    if 0 < dated < len(history.models):
        return [
            f"Dates of {dated} of {len(history.models)} models are those of their recordings, of the others those of "
            "the identification: their order may be another."
        ]
    if dated or len(history.models) < 2 or (last - first).total_seconds() > _ONE_SITTING:
        return []
    return [
        "All models were made within an hour: dates and changes a day are those of the identification, and not of the "
        "recordings."
    ]


def _list_rows(history: JointHistory) -> list[tuple[str, ...]]:
    from fricomp.calibration.history import shorten

    rows: list[tuple[str, ...]] = []
    for trend in history.trends:
        reach = f" ± {trend.reach:.2g}" if trend.reach < float("inf") else ""
        slope = f"{trend.slope:+.3g}{reach}" if reach else "–"
        mark = "yes" if trend.is_significant else "no"
        rows.append((shorten(trend.name), f"{trend.values[0]:.4g}", f"{trend.values[-1]:.4g}", trend.unit, slope, mark))
    return rows


_HEADS = ("parameter", "first", "last", "unit", "change a day, 95 %", "beyond chance")


def _make_title(history: JointHistory) -> str:
    days = history.trends[0].days[-1] if history.trends else 0.0
    n, span = len(history.models), f"{days:.3g} days" if days >= 1.0 else f"{24.0 * days:.2g} hours"
    return f"Joint {history.title}: {n} models over {span}" if n > 1 else f"Joint {history.title}: one model"


def _print(history: JointHistory) -> None:
    from fricomp.cli.terminal import Table, console

    table, screen = Table(*_HEADS, title=_make_title(history)), console()
    for row in _list_rows(history):
        table.add_row(*row)
    screen.print(table)
    for sentence in _say_span(history):
        screen.print(f"Careful: {sentence[0].lower()}{sentence[1:]}", style="yellow")
    changes = _tell_changes(history)
    for when, what in changes:
        screen.print(f"Changed at {when} UTC: {what}.", style="yellow")
    if not changes and any(one is not None for one in history.comparisons):
        screen.print("No change from one model to the next.")


def _as_answer(history: JointHistory) -> dict[str, Any]:
    temperatures = history.temperatures.tolist()
    return {
        "joint": history.joint,
        "diagnosed": history.diagnosed,
        "models": [
            {"file": kept.path, "when": kept.when.isoformat(), "temperature": at}
            for kept, at in zip(history.models, temperatures, strict=True)
        ],
        "trends": [
            {
                "name": one.name, "unit": one.unit, "values": one.values, "standard_deviations": one.deviations,
                "days": one.days, "slope": one.slope, "reach": one.reach, "significant": one.is_significant,
            }
            for one in history.trends
        ],
        "not_compared": [
            {"when": kept.when.isoformat(), "why": why}
            for kept, why in zip(history.models[1:], history.refusals, strict=False)
            if why
        ],
        "changes": [{"when": when, "what": what} for when, what in _tell_changes(history, numbers=False)],
    }  # fmt: skip


def _build_page(histories: tuple[JointHistory, ...]) -> ReportPage:
    import numpy as np

    from fricomp.calibration.history import draw_history
    from fricomp.report import ReportPage, Section, Table

    sections, moved = [], []
    for history in histories:
        changes = _tell_changes(history)
        blocks: list[Any] = [Table(_HEADS, tuple(_list_rows(history))), *_say_span(history)]
        blocks += [f"Changed at {when} UTC: {what}." for when, what in changes]
        if history.trends:
            blocks.append(draw_history(history))
            if np.isfinite(history.temperatures).sum() > 1:
                blocks.append(draw_history(history, over_temperature=True))
        sections.append(Section(_make_title(history), tuple(blocks)))
        if changes or any(trend.is_significant for trend in history.trends):
            moved.append(history.title)
    said = f"Changed or drifting: {', '.join(moved)}." if moved else "No joint has changed or drifts beyond chance."
    if any(any(history.refusals) for history in histories):
        said += " Not all models could be compared with the one before."
    count = len({history.joint for history in histories})
    return ReportPage(
        f"{count} joint{'s' if count > 1 else ''} over time", (said,), tuple(sections),
        outcome="warning" if moved else "passed", verdict="Changes" if moved else "No change",
    )  # fmt: skip
