"""`fricomp compare`: has this joint changed, in which parameter, with what significance."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fricomp.cli.output import answer

if TYPE_CHECKING:
    from fricomp.calibration.comparison import ModelComparison
    from fricomp.model import FrictionModel

app = typer.Typer(add_completion=False)

EPILOG = """fricomp compare runs/spring/friction.json runs/autumn/friction.json

fricomp compare old.json new.json --fail-if-changed --json"""

_LEAST_CHANCE = 1e-16
EXIT_CHANGED = 1
"""Exit status of --fail-if-changed where the joint has changed."""


@app.command(epilog=EPILOG)
def compare(
    old: Annotated[Path, typer.Argument(help="Model file from before (friction.json).")],
    new: Annotated[Path, typer.Argument(help="Model file from now.")],
    significance: Annotated[float, typer.Option(help="Chance to call an unchanged joint changed.")] = 0.05,
    fail_if_changed: Annotated[
        bool, typer.Option("--fail-if-changed", help="End with exit status 1 where the joint has changed.")
    ] = False,
) -> None:
    """Has this joint changed, in which parameter, and how sure is that?"""
    from dataclasses import asdict

    from fricomp.calibration.comparison import compare_models
    from fricomp.model import load_model

    before, after = load_model(old), load_model(new)
    result, doubts = compare_models(before, after, significance), _find_doubts(before, after)
    answer({"changed": result.changed, **asdict(result), "doubts": doubts})
    _print_comparison(result, after, significance, doubts)
    if fail_if_changed and result.changed:
        raise typer.Exit(EXIT_CHANGED)


def _print_comparison(result: ModelComparison, after: FrictionModel, significance: float, doubts: list[str]) -> None:
    from fricomp.cli.terminal import Table, console

    table = Table()
    for heading in ("parameter", "old", "new", "change", "± sd", "p", "unit"):
        table.add_column(heading, overflow="fold")
    for change in result.changes:
        style = "bold" if change.p_value < significance else ""
        share = _spell_share(change.difference / change.old) if change.old else "–"
        numbers = (f"{change.old:.5g}", f"{change.new:.5g}", share, f"{change.standard_deviation:.2g}")
        short = change.name.removeprefix("stribeck.")
        table.add_row(short, *numbers, _spell_chance(change.p_value), change.unit, style=style)
    out = console()
    for doubt in doubts:
        out.print(f"Careful: {doubt}.", style="yellow")
    out.print(table)
    if result.normal_load is not None:
        unknown = [name for name, known in zip(("old", "new"), result.load_known, strict=True) if not known]
        alike = f"; the {unknown[0]} model does not know its load, taken as the same" if unknown else ""
        out.print(f"Both at a normal load of {result.normal_load:g}{alike}.")
    if result.common_form:
        out.print(f"The laws differ in form: both curves are compared as {result.common_form}, where both hold.")
    for title, terms in (("New terms", result.added), ("Terms gone", result.removed)):
        if terms:
            out.print(f"{title}: {', '.join(terms)}.")
    where = (
        f"{result.largest_torque_change:+.3g} {after.torque_unit} at {result.at_velocity:.3g} {after.position_unit}/s"
    )
    chance = f"p {_spell_chance(result.p_value, '= ')}"
    if not result.changed:
        out.print(f"No change: {chance} for all parameters together; the curves differ by {where}.")
        return
    names = ", ".join(change.name for change in result.significant) or "no single parameter stands out"
    out.print(f"The joint has changed ({chance}): {names}. The curves differ most by {where}.")


def _spell_chance(p_value: float, equals: str = "") -> str:
    """A chance; one that no double tells from zero is less than the least that is told."""
    return f"{equals}{p_value:.2g}" if p_value >= _LEAST_CHANCE else f"< {_LEAST_CHANCE:g}"


def _spell_share(share: float) -> str:
    return "0.0%" if abs(share) < 5e-4 else f"{share:+.1%}"


def _find_doubts(before: FrictionModel, after: FrictionModel) -> list[str]:
    """Why the answer may mislead: a model that is not usable, or two joints."""
    from fricomp.calibration.comparison import says_other_zero
    from fricomp.control.compensation.trust import find_doubt

    found = [(name, find_doubt(model)) for name, model in (("old", before), ("new", after))]
    doubts = [f"the {name} model is not usable ({doubt.rstrip('.')})" for name, doubt in found if doubt is not None]
    if before.joint != after.joint:
        doubts.append(f"the old model is of joint {before.joint!r}, the new one of {after.joint!r}")
    if says_other_zero(before, after):
        doubts.append(
            "the zero of the torque was taken off one of the models alone, so that a difference between the directions "
            "is none that can be told"
        )
    return doubts
