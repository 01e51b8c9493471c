"""Tables of pages in Markdown."""

from collections.abc import Sequence


def format_markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Headings, a rule and rows, one line each.

    Args:
        head: One heading a column.
        rows: Cells as they are to be printed, one a column.
    """
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
