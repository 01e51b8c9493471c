"""What commands with `--out` share: the option that replaces earlier results, and the folder."""

from __future__ import annotations

from typing import Annotated

from fricomp.cli.option.panel import output_option
from fricomp.results import make_folder, require_folder

__all__ = ["Overwrite", "make_folder", "require_folder"]

Overwrite = Annotated[bool, output_option("--overwrite", help="Replace the results of the kind that --out holds.")]
"""The option; its default is False."""
