"""Why figures were not reached: what is known of each, from a file beside the page, and where its cases fail."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from fricomp.errors import DiagnosisError

from .figure import Figure
from .score import Score
from .splits import band_of

__all__ = ["CAUSES", "format_causes", "read_causes"]

CAUSES = "causes.toml"
"""File beside a page: the cause by the name of the figure."""

_UNKNOWN = "Not looked into yet."


def read_causes(folder: Path) -> dict[str, str]:
    """Causes by the name of the figure; none where there is no such file.

    Raises:
        DiagnosisError: The file cannot be read, or holds anything but text by name.
    """
    path = folder / CAUSES
    if not path.exists():
        return {}
    try:
        causes = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise DiagnosisError(f"{path} is no TOML: {error}") from error
    if wrong := [name for name, text in causes.items() if not isinstance(text, str)]:
        raise DiagnosisError(f'{path} must hold lines such as "name of a figure" = "cause"; not so: {", ".join(wrong)}')
    return causes


def format_causes(figures: Sequence[Figure], causes: Mapping[str, str]) -> str:
    """A section of the page; empty where every figure is reached."""
    missed = [figure for figure in figures if figure.reached is False]
    if not missed:
        return ""
    parts = [_format(figure, " ".join(causes.get(figure.name, _UNKNOWN).split())) for figure in missed]
    return "## Figures not reached, and why\n\n" + "\n\n".join(parts)


def _format(figure: Figure, cause: str) -> str:
    lines = [f"**{figure.name}** ({figure.target}; {figure.value}). {cause}"]
    if figure.brief is not None and len(figure.cases) > 1:
        keys: dict[str, Callable[[Score], str]] = {"strength": band_of, "friction core": lambda s: s.core}
        splits = [_split(figure, name, key) for name, key in keys.items()]
        lines.append("\n".join(splits))
    return "\n\n".join(lines)


def _split(figure: Figure, name: str, key: Callable[[Score], str]) -> str:
    assert figure.brief is not None
    parts = []
    for value in sorted(set(map(key, figure.cases))):
        some = [score for score in figure.cases if key(score) == value]
        parts.append(f"{value}: {figure.brief(some)}")
    return f"- by {name}: {'; '.join(parts)}"
