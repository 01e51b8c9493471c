"""Options under a heading of `--help`, made with the arguments of `typer.Option`; and one that most commands have."""

from functools import partial
from typing import Annotated, Any

import typer


def option_under(heading: str) -> partial[Any]:
    """What makes the options under a heading."""
    return partial(typer.Option, rich_help_panel=heading)


output_option = option_under("Output")
log_option = option_under("Of a log")
arm_option = option_under("Of an arm")
fleet_option = option_under("Of a fleet")

Overwrite = Annotated[bool, output_option("--overwrite", help="Replace earlier results of this kind.")]
"""The option of commands that write files; its default is False."""
