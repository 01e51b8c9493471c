"""Why figures were not reached: what is known of each, from a file beside the page, and where its cases fail."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from fricomp.errors import DiagnosisError

from ..kit.figure import Figure, group_by
from .power import name_band
from .score import Score

CAUSES = "causes.toml"
"""File beside a page: the cause by the name of the figure."""

_UNKNOWN = "Not looked into yet."
_AXES: dict[str, Callable[[Score], str]] = {"strength": name_band, "friction core": lambda s: s.core}


class Miss(NamedTuple):
    """A figure that is not reached.

    Attributes:
        name: What is measured.
        target: What is wanted.
        value: As measured.
        text: Why it is missed.
        parts: By strength and by friction core, the value on each part of the cases.
    """

    name: str
    target: str
    value: str
    text: str
    parts: tuple[tuple[str, str], ...]


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


def explain_misses(figures: Sequence[Figure[Score]], causes: Mapping[str, str]) -> list[Miss]:
    """The figures that are not reached, each with its cause and the parts of its cases."""
    missed = [figure for figure in figures if figure.reached is False]
    return [
        Miss(each.name, each.target, each.value, " ".join(causes.get(each.name, _UNKNOWN).split()), _split(each))
        for each in missed
    ]


def _split(figure: Figure[Score]) -> tuple[tuple[str, str], ...]:
    if figure.brief is None or len(figure.cases) < 2:
        return ()
    found = []
    for axis, key in _AXES.items():
        parts = (f"{value}: {figure.brief(some)}" for value, some in group_by(figure.cases, key))
        found.append((axis, "; ".join(parts)))
    return tuple(found)
