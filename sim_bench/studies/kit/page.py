"""Pages of studies in Markdown, each filled in from a template in `studies/templates`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricomp.errors import DiagnosisError, MissingExtraError
from fricomp.report import format_markdown_table
from fricomp.whole_file import whole_file

if TYPE_CHECKING:
    from jinja2 import Environment

__all__ = ["fill_template", "write_page"]


def fill_template(template: str, **values: Any) -> str:
    """The text of a template with these values in it. Sections that come out empty leave no gap.

    In a template, `rows | table(heads)` makes a table; a value that is missing is an error.

    Args:
        template: File below `studies/templates`, such as `proof/page.md`.
        values: By the names that the template uses.

    Raises:
        MissingExtraError: jinja2 is not installed.
    """
    text = _open_templates().get_template(template).render(values)
    return re.sub(r"\n{3,}", "\n\n", text).strip() + "\n"


def write_page(template: str, page: Path, **values: Any) -> None:
    """Fill a template and write it to a file, whole or not at all. Folders that are missing are made."""
    page.parent.mkdir(parents=True, exist_ok=True)
    text = fill_template(template, **values)
    with whole_file(page, DiagnosisError) as part:
        part.write_text(text, encoding="utf-8")


@cache
def _open_templates() -> Environment:
    try:
        from jinja2 import Environment, PackageLoader, StrictUndefined
    except ImportError as error:
        raise MissingExtraError("jinja2", "report") from error
    environment = Environment(
        loader=PackageLoader("fricomp.sim_bench.studies", "templates"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    environment.filters["table"] = _format_table
    return environment


def _format_table(rows: Iterable[Sequence[object]], heads: Sequence[str]) -> str:
    return format_markdown_table(heads, [[str(cell) for cell in row] for row in rows])
