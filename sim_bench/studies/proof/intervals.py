"""What a diagnosis gave for parameters whose truth is known, with their intervals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

__all__ = ["SIMULATION", "KnownInterval", "compare_intervals"]

SIMULATION = "simulation"
"""What stands for an effect where inertia and gravity of a shifted simulation are compared."""


@dataclass(frozen=True)
class KnownInterval:
    """A parameter of a named effect, or of a shifted simulation, in SI.

    Attributes:
        effect: That it belongs to; `SIMULATION` for inertia and gravity.
        parameter: Its name.
        truth: True value.
        value: As given.
        low: Lower end of the 95 % interval.
        high: Upper end.
    """

    effect: str
    parameter: str
    truth: float
    value: float
    low: float
    high: float

    @property
    def covers(self) -> bool:
        """Whether the interval holds the truth."""
        return self.low <= self.truth <= self.high

    @property
    def error(self) -> float:
        """How far the value lies from the truth, in half widths of the interval on that side; 1 is at its end."""
        end = self.high if self.truth > self.value else self.low
        return abs(self.truth - self.value) / max(abs(end - self.value), 1e-300)

    @property
    def relative_error(self) -> float:
        """|value / truth - 1|; NaN for a truth of 0."""
        return abs(self.value / self.truth - 1.0) if self.truth else float("nan")


def compare_intervals(truth: Mapping[str, Any], said: Mapping[str, Any]) -> tuple[KnownInterval, ...]:
    """All parameters that can be compared: of concealed effects that were named, and inertia and gravity where those of
    the simulation were shifted and found to be. Counts, such as the order of a filter, have no interval and are left
    out.

    Args:
        truth: The opened answer.
        said: The diagnosis.
    """
    given = {each["name"]: each["parameters"] for each in said["effects"]}
    pairs = {each["name"]: (given.get(each["name"], {}), _values(each["comparable"])) for each in truth["effects"]}
    if "gravity" in truth["joint"] and given.keys() & set(truth["shifted_parameters"]):
        pairs[SIMULATION] = (_refitted(said), _body_of(truth["joint"]))
    return tuple(
        KnownInterval(effect, name, wanted[name], one["value"], *one["ci95"])
        for effect, (found, wanted) in pairs.items()
        if _numbered(found) == _numbered(wanted)  # where a push is missed, nobody knows which is the second
        for name, one in found.items()
        if name in wanted and one["ci95"][0] < one["ci95"][1]
    )


def _values(parameters: Mapping[str, Any]) -> dict[str, float]:
    return {name: each["value"] for name, each in parameters.items()}


def _refitted(said: Mapping[str, Any]) -> dict[str, Any]:
    """What a diagnosis says has changed in the simulation, with its interval."""
    return {each["name"]: each["refitted"] for each in said.get("changes") or () if each.get("refitted")}


def _body_of(joint: Mapping[str, Any]) -> dict[str, float]:
    """Inertia and gravity of the concealed joint by the names of a diagnosis."""
    gravity, angle = joint["gravity"], joint["gravity_angle"]
    return {
        "inertia": joint["inertia"],
        "gravity_cos": gravity * float(np.sin(angle)),
        "gravity_sin": gravity * float(np.cos(angle)),
    }


def _numbered(parameters: Mapping[str, Any]) -> int:
    """How many of the same thing an effect has, such as pushes."""
    return sum(name.startswith("start_") for name in parameters)
