"""The documentation as a site: strict, complete, and read without a network."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built; a page that is in no menu or a link that leads nowhere fails it."""
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(out)]
    quiet = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, env=quiet, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


def test_the_pages_beside_docs_are_in_it(site: Path) -> None:
    for page in ("index.html", "ARCHITECTURE.html", "CONTRIBUTING.html", "CHANGELOG.html", "adapters/canopen.html"):
        assert (site / page).exists(), page
    assert (site / "search" / "search_index.js").exists()


def test_no_page_loads_anything_from_a_network(site: Path) -> None:
    loads = re.compile(r"<(?:script|link|img|iframe)[^>]*?(?:src|href)=[\"']?(https?:[^\s\"'>]+)")
    for page in site.rglob("*.html"):
        assert not loads.findall(page.read_text("utf-8")), page


def test_a_browser_opens_it_from_the_disk_without_complaint(site: Path, open_page: Callable[[Path], Any]) -> None:
    opened = open_page(site / "index.html")
    assert opened.fetched == ()
    assert opened.complaints == ()
    assert "fricomp" in opened.dom


@pytest.fixture(scope="module")
def hook() -> ModuleType:
    spec = spec_from_file_location("site_pages", ROOT / ".ci" / "site_pages.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("source", "link", "expected"),
    [
        ("README.md", "[control](docs/control.md#the-loop)", "[control](control.md#the-loop)"),
        ("README.md", "[how](CONTRIBUTING.md)", "[how](CONTRIBUTING.md)"),
        ("docs/proof/details.md", "[fleet](../fleet.md)", "[fleet](../fleet.md)"),
        ("docs/proof/details.md", "[start](../../README.md)", "[start](../index.md)"),
        ("docs/control.md", "[the errors](../fricomp/errors.py)", "the errors (`fricomp/errors.py`)"),
        ("docs/control.md", "[`examples/loop.py`](../examples/loop.py)", "`examples/loop.py`"),
        ("docs/control.md", "[gone](../no/such.py)", "[gone](../no/such.py)"),
        ("docs/control.md", "[out](https://example.org/a)", "[out](https://example.org/a)"),
    ],
)
def test_links_are_those_of_the_site(hook: ModuleType, source: str, link: str, expected: str) -> None:
    assert hook.rewrite_links(link, source) == expected
