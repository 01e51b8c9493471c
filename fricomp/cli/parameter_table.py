"""The verdict and the parameters that an identification gives, as `calibrate` and `identify` print them."""

from math import isfinite

import typer
from rich.console import Console

from fricomp.calibration.identification import IdentificationResult, Status
from fricomp.cli.terminal import Table
from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.overview import format_with_reach

_APART = 0.25
"""By how much of its half an interval may differ from that by profile likelihood, and still be called symmetric."""

EXIT_NOT_USABLE = 1
"""Exit status where everything was written, and the model is one that compensator and exports refuse."""


def is_usable(result: IdentificationResult) -> bool:
    """Whether compensator and exports take the model."""
    return find_doubt_in_status(result.status, "") is None


def end_as_usable(*, usable: bool) -> None:
    """Exit with a status of its own where the model is not usable.

    Raises:
        Exit: It is not.
    """
    if not usable:
        raise typer.Exit(EXIT_NOT_USABLE)


def print_verdict(screen: Console, result: IdentificationResult) -> None:
    """Whether the model can be used, and why not, in the first line of an answer."""
    said = f"{result.status}: {result.message}"
    if not is_usable(result):
        screen.print(f"NOT USABLE, {said}", style="bold red", markup=False)
    elif result.status is Status.CONVERGED:
        screen.print(f"Usable, {said}", markup=False)
    else:
        screen.print(f"Careful, {said}", style="yellow", markup=False)


def parameter_table(result: IdentificationResult) -> Table:
    """One row a parameter, one column a direction, with half of the 95 % interval, or its ends where they lie apart."""
    sides: dict[str, dict[str, str]] = {}
    for name in result.parameter_names:
        *group, last = name.split(".")
        rows = sides.setdefault(group[-1] if len(group) > 1 else "value", {})
        rows[f"{last.replace('_', ' ')} [{result.model.units()[name]}]"] = _value(result, name)
    table = Table(title=f"Friction of joint {result.model.joint}, ± 95 %", title_justify="left")
    table.add_column("parameter")
    for side in sides:
        table.add_column(side, justify="right")
    for label in dict.fromkeys(label for rows in sides.values() for label in rows):
        table.add_row(label, *(rows.get(label, "") for rows in sides.values()))
    return table


def _value(result: IdentificationResult, name: str) -> str:
    value, plain = result.parameters[name], result.interval(name)
    reach = plain.upper - value
    if name in result.at_bound:
        return format_with_reach(value, reach, at_bound=True)
    ends = result.profiles.get(name, plain)
    if not isfinite(reach) or max(abs(ends.lower - plain.lower), abs(ends.upper - plain.upper)) < _APART * reach:
        return format_with_reach(value, reach)
    return f"{value:.4g} ({ends.lower:.3g} to {ends.upper:.3g})"
