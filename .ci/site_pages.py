"""Hook of mkdocs: the pages that lie beside `docs/`, and links that lead out of it.

README, ARCHITECTURE, CONTRIBUTING and CHANGELOG become pages of the site. A link to a file that is no page, such as an
example, becomes the name of that file: the site is read without the checkout as well.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
PAGES = {
    "README.md": "index.md",
    **{name: name for name in ("ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")},
}
"""Files beside `docs/`, by what they are called in the site."""

_LINK = re.compile(r"\[([^\]]*)\]\((?!https?:|#)([^)#\s]+)(#[^)\s]*)?\)")


def on_files(files: Files, config: Any) -> Files:
    """Add the pages that lie beside `docs/`."""
    for name, page in PAGES.items():
        text = rewrite_links((ROOT / name).read_text("utf-8"), name)
        files.append(File.generated(config, page, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Rewrite the links of a page below `docs/`."""
    place = page.file.src_uri
    return markdown if place in PAGES.values() else rewrite_links(markdown, f"docs/{place}")


def rewrite_links(markdown: str, source: str) -> str:
    """The text with links as the site has them.

    Args:
        markdown: Text of a file.
        source: Its path in the checkout.
    """
    folder = posixpath.dirname(PAGES.get(source, source.removeprefix("docs/")))

    def rewrite(found: re.Match[str]) -> str:
        text, target, anchor = found[1], found[2], found[3] or ""
        path = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
        page = PAGES.get(path) or (path.removeprefix("docs/") if path.startswith("docs/") else None)
        if page is not None:
            return f"[{text}]({posixpath.relpath(page, folder or '.')}{anchor})"
        if not (ROOT / path).exists():
            return found[0]  # mkdocs refuses it by name
        return f"`{path}`" if text.strip("`") in (path, posixpath.basename(path)) else f"{text} (`{path}`)"

    return _LINK.sub(rewrite, markdown)
