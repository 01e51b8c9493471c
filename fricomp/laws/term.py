"""What a friction law is made of: the operating point, and terms that add up."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import ParameterError

__all__ = ["DynamicTerm", "FloatArray", "OperatingPoint", "Scalar", "Term", "term_class", "term_names"]

FloatArray = NDArray[np.float64]
Scalar = float | FloatArray

_Owner = TypeVar("_Owner")
_REGISTRY: dict[str, type[Term]] = {}


@dataclass(frozen=True, slots=True)
class OperatingPoint:
    """Where a joint works: the inputs every term may draw on. Floats, or arrays of one common shape.

    Attributes:
        velocity: Joint velocity [rad/s] or [m/s].
        position: Joint position [rad] or [m].
        acceleration: Joint acceleration [rad/s²] or [m/s²].
        load_torque: Torque that the joint transmits to its load [N·m] or [N].
        normal_load: Normal load on the friction contact, in the unit of the law's reference load; None where unknown.
        temperature: Temperature of the joint [°C]; None where unknown.
    """

    velocity: Scalar
    position: Scalar = 0.0
    acceleration: Scalar = 0.0
    load_torque: Scalar = 0.0
    normal_load: Scalar | None = None
    temperature: Scalar | None = None


@dataclass(frozen=True)
class Term(ABC):
    """One additive part of a friction law. Subclasses are frozen dataclasses that register under their `name`.

    A field is a parameter (a float) or a group of parameters (a dataclass of floats). `units` maps each
    parameter's last name to its unit, in which `{torque}` and `{position}` stand for the joint's own units.
    """

    name: ClassVar[str]
    units: ClassVar[Mapping[str, str]]

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "name" in cls.__dict__:
            _REGISTRY[cls.name] = cls

    @abstractmethod
    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque [N·m] or [N] that overcomes this term at `point`, in steady state if the term has a state."""

    def parameters(self) -> dict[str, float]:
        """Parameters by dotted name, in the order of the fields."""
        return flatten(self)

    def with_parameters(self, values: Mapping[str, float]) -> Self:
        """This term with some parameters changed.

        Raises:
            ParameterError: A name is unknown or a value is outside its domain.
        """
        return unflatten(self, values)


@dataclass(frozen=True)
class DynamicTerm(Term):
    """A term with an internal state, advanced exactly over one step of constant velocity."""

    @abstractmethod
    def rest_state(self) -> Scalar:
        """The state of a joint that has been at rest without load."""

    @abstractmethod
    def advance(self, state: Scalar, point: OperatingPoint, dt: float) -> tuple[Scalar, Scalar]:
        """The torque at the end of a step of `dt` [s], and the state there."""


def term_class(name: str) -> type[Term]:
    """The term registered under `name`.

    Raises:
        ParameterError: No term has this name.
    """
    try:
        return _REGISTRY[name]
    except KeyError:
        raise ParameterError(f"unknown friction term {name!r}; known terms: {', '.join(term_names())}") from None


def term_names() -> tuple[str, ...]:
    """Names of all registered terms, sorted."""
    return tuple(sorted(_REGISTRY))


def require(condition: bool, message: str) -> None:
    """Raise `ParameterError` unless `condition` holds."""
    if not condition:
        raise ParameterError(message)


def require_finite(owner: object, *names: str) -> None:
    """Raise `ParameterError` unless the named fields of `owner` are finite."""
    for name in names:
        require(bool(np.isfinite(getattr(owner, name))), f"{name} must be finite, got {getattr(owner, name)!r}")


def require_nonnegative(owner: object, *names: str) -> None:
    """Raise `ParameterError` unless the named fields of `owner` are finite and not negative."""
    for name in names:
        value = getattr(owner, name)
        require(
            bool(np.isfinite(value)) and value >= 0.0,
            f"{name} must be finite and not negative, got {value!r}: give it as a magnitude",
        )


def require_positive(owner: object, *names: str) -> None:
    """Raise `ParameterError` unless the named fields of `owner` are finite and positive."""
    for name in names:
        value = getattr(owner, name)
        require(bool(np.isfinite(value)) and value > 0.0, f"{name} must be finite and positive, got {value!r}")


def flatten(owner: Any) -> dict[str, float]:
    """Float fields of a dataclass, with those of nested dataclasses under dotted names."""
    flat: dict[str, float] = {}
    for field in fields(owner):
        value = getattr(owner, field.name)
        if is_dataclass(value):
            flat |= {f"{field.name}.{name}": inner for name, inner in flatten(value).items()}
        elif isinstance(value, int | float) and not isinstance(value, bool):
            flat[field.name] = float(value)
    return flat


def unflatten(owner: _Owner, values: Mapping[str, float]) -> _Owner:
    """A copy of the dataclass `owner` with the dotted names in `values` replaced."""
    known = flatten(owner)
    unknown = sorted(set(values) - set(known))
    require(not unknown, f"unknown parameter {', '.join(unknown)}; known: {', '.join(known)}")
    changes: dict[str, Any] = {}
    for field in fields(owner):  # type: ignore[arg-type]
        old = getattr(owner, field.name)
        if is_dataclass(old):
            prefix = f"{field.name}."
            inner = {name.removeprefix(prefix): value for name, value in values.items() if name.startswith(prefix)}
            if inner:
                changes[field.name] = unflatten(old, inner)
        elif field.name in values:
            changes[field.name] = float(values[field.name])
    return replace(owner, **changes)  # type: ignore[type-var]
