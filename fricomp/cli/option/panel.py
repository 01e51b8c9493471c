"""Options under a heading of `--help`: each of these makes one, with the arguments of `typer.Option`."""

from functools import partial
from typing import Any

import typer


def option_under(heading: str) -> partial[Any]:
    """What makes the options under a heading."""
    return partial(typer.Option, rich_help_panel=heading)


output_option = option_under("Output")
log_option = option_under("Of a log")
arm_option = option_under("Of an arm")
fleet_option = option_under("Of a fleet")
