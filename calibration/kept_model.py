"""A model file among others of its joint: when it was made, and what it says of the joint, with deviations."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from fricomp.errors import ParameterError
from fricomp.model import FrictionModel, load_model
from fricomp.untrusted import parse_json

_REACH = 1.96
"""Standard deviations from a value to the ends of its 95 % interval."""


class Estimate(NamedTuple):
    """A number that was identified.

    Attributes:
        value: Its value, in `unit`.
        deviation: Its standard deviation, above 0.
        unit: Unit of both.
    """

    value: float
    deviation: float
    unit: str


@dataclass(frozen=True)
class KeptModel:
    """A model file, and the record of the diagnosis beside it where one wrote it.

    Attributes:
        path: Where it is.
        model: What it holds.
        when: When its recording was taken, where the model says it, else when it was identified; UTC.
        estimates: By dotted name: parameters of the law, or what the diagnosis says of base and effects.
        effects: What the diagnosis named; None for a model that none wrote.
    """

    path: Path
    model: FrictionModel
    when: datetime
    estimates: Mapping[str, Estimate]
    effects: tuple[str, ...] | None

    @property
    def is_dated(self) -> bool:
        """Whether its date is that of its recording."""
        return "recorded" in self.model.provenance.notes


def read_kept(path: Path) -> KeptModel:
    """Read a model, with the numbers that have a deviation.

    Raises:
        FricompError: It cannot be read, or does not say when it was made.
    """
    model = load_model(path)
    when, record = _read_date(model), path.with_name("diagnosis.json")
    if model.covariance is not None or not record.is_file():
        return KeptModel(path, model, when, list_parameters(model), None)
    try:
        told = parse_json(record.read_bytes(), _Record)
    except (msgspec.MsgspecError, OSError) as error:
        raise ParameterError(f"{record} beside it is no record of a diagnosis: {error}") from error
    found = {f"base.{name}": one for name, one in (told.base or {}).items()}
    found |= {f"{one.name}.{name}": each for one in told.effects for name, each in one.parameters.items()}
    estimates = {name: estimate for name, one in found.items() if (estimate := one.to_estimate()) is not None}
    return KeptModel(path, model, when, estimates, tuple(sorted(one.name for one in told.effects)))


class _Told(msgspec.Struct):
    value: float
    unit: str
    ci95: tuple[float, float]
    at_bound: bool = False

    def to_estimate(self) -> Estimate | None:
        """With the deviation that its interval stands for; None where it has none."""
        deviation = (self.ci95[1] - self.ci95[0]) / (2.0 * _REACH)
        known = not self.at_bound and 0.0 < deviation < np.inf
        return Estimate(self.value, deviation, self.unit) if known else None


class _Effect(msgspec.Struct):
    name: str
    parameters: dict[str, _Told]


class _Record(msgspec.Struct):
    base: dict[str, _Told] | None
    effects: list[_Effect]


def list_parameters(model: FrictionModel) -> dict[str, Estimate]:
    """The parameters of the law that have a deviation."""
    if model.covariance is None:
        return {}
    values, units = model.law.parameters(), model.units()
    pairs = zip(model.covariance.names, np.sqrt(np.diag(model.covariance.matrix)).tolist(), strict=True)
    return {name: Estimate(values[name], sd, units[name]) for name, sd in pairs if name in values and 0.0 < sd < np.inf}


def _read_date(model: FrictionModel) -> datetime:
    """When the recording of a model was taken, or where it does not say that when it was made, UTC.

    Raises:
        ParameterError: It does not say, or not as a date.
    """
    said = model.provenance.notes.get("recorded") or model.provenance.created
    try:
        when = datetime.fromisoformat(said)
        return (when if when.tzinfo is not None else when.replace(tzinfo=UTC)).astimezone(UTC)
    except (ValueError, OverflowError) as error:
        told = f"{said!r}, which is not a date" if said else "nothing"
        raise ParameterError(
            f"when it was made is not known: its provenance.created says {told}; write one such as 2026-03-01T12:00"
        ) from error
