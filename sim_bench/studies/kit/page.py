"""Pages of studies in Markdown, each filled in from a template in `studies/templates`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricomp.errors import DiagnosisError, OutputError
from fricomp.extras import needing
from fricomp.report import format_markdown_table
from fricomp.whole_file import write_whole

if TYPE_CHECKING:
    from jinja2 import Environment

_TEMPLATES = Path(__file__).parents[1] / "templates"


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
    """Fill a template and write it to a file; see `replace_page`."""
    replace_page(page, fill_template(template, **values), template.partition("/")[0])


def replace_page(page: Path, text: str, study: str) -> None:
    """Write a page, whole or not at all, in the place of an earlier one; the folder of its name beside it is its own.

    Args:
        page: Where.
        text: All of it.
        study: Folder below `studies/templates`.

    Raises:
        OutputError: Something else is there; it stays.
    """
    require_own_page(page, study)
    write_whole(page, text, DiagnosisError)


def require_own_page(page: Path | None, study: str) -> None:
    """Refuse a page that would replace what is no page of the study, before hours of work are spent on it.

    Args:
        page: Where it is to be written; None where none is.
        study: Folder below `studies/templates`, whose headings tell its pages.

    Raises:
        OutputError: Something else is there.
    """
    if page is None:
        return
    if page.is_symlink() or page.is_dir():
        kind = "a folder" if page.is_dir() else "a link, which is not followed"
        raise OutputError(f"{page} is {kind}: choose another --page")
    if page.exists() and _read_head(page.read_text("utf-8", "replace")) not in _list_heads(study):
        raise OutputError(
            f"{page} is there already, and is no page of this study: choose another --page, or move it away"
        )


@cache
def _list_heads(study: str) -> frozenset[str]:
    heads = {_read_head(path.read_text("utf-8")) for path in (_TEMPLATES / study).glob("*.md")}
    return frozenset(head for head in heads if head.startswith("#"))


def _read_head(text: str) -> str:
    return text.partition("\n")[0].strip()


@cache
def _open_templates() -> Environment:
    with needing("jinja2", "report"):
        from jinja2 import Environment, PackageLoader, StrictUndefined
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
