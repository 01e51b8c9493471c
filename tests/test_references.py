"""Every citation key in the code stands in docs/references.md, once."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
KEY = re.compile(r"\[([a-z]+(?:19|20)\d\d[a-z]*)\]")


def listed() -> Counter[str]:
    return Counter(re.findall(r"^- \*\*([a-z0-9]+)\*\*", (ROOT / "docs/references.md").read_text(), re.MULTILINE))


def cited() -> set[str]:
    files = [path for top in ("fricomp", "adapters", "calibration", "sim_bench") for path in (ROOT / top).rglob("*.py")]
    return {key for path in files for key in KEY.findall(path.read_text())}


def test_every_cited_source_is_listed() -> None:
    assert cited() - set(listed()) == set()


def test_every_source_is_listed_once() -> None:
    assert [key for key, count in listed().items() if count > 1] == []
