"""What a friction law is made of: the operating point, and terms that add up."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from importlib import import_module
from itertools import product
from pkgutil import iter_modules
from typing import Any, ClassVar, NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import ParameterError

__all__ = [
    "DynamicTerm",
    "FloatArray",
    "OperatingPoint",
    "Parts",
    "Ranges",
    "Scalar",
    "Term",
    "term_class",
    "term_names",
]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Scalar = float | FloatArray

_CREEP = 1e-6  # share of the fastest speed that counts as next to rest, where falling branches are highest [1]

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

    @property
    def speed(self) -> FloatArray:
        """Size of the velocity, on which the level of dry friction depends [rad/s] or [m/s]."""
        return np.abs(np.asarray(self.velocity, dtype=np.float64))

    @property
    def is_forward(self) -> BoolArray:
        """Whether the joint moves forward, or rests."""
        return np.asarray(self.velocity) >= 0.0

    def temperature_or(self, reference: float) -> Any:
        """The temperature [°C]; `reference` where it is unknown."""
        return reference if self.temperature is None else self.temperature

    def normal_load_or(self, reference: float) -> Any:
        """The normal load; `reference` where it is unknown."""
        return reference if self.normal_load is None else self.normal_load


class Parts(NamedTuple):
    """Torque of a term [N·m] or [N] by what it resists; None for a part that the term has not.

    The whole is held + dry sgn(v) + drag + bristle.

    Attributes:
        held: Acts whatever the direction of motion, such as a spring.
        dry: Level against the direction of motion, over the speed. A resting joint is held by any torque below it.
        drag: Rises from rest with the velocity, and has its sign.
        bristle: Follows a state, which has the direction of motion in it.
    """

    held: Any = None
    dry: Any = None
    drag: Any = None
    bristle: Any = None

    def total(self, velocity: Scalar) -> Scalar:
        """The whole torque at `velocity` [rad/s] or [m/s]."""
        dry = None if self.dry is None else self.dry * np.sign(velocity)
        found = [part for part in (self.held, dry, self.drag, self.bristle) if part is not None]
        total: Scalar = sum(found[1:], found[0]) if found else 0.0 * np.asarray(velocity, dtype=np.float64)
        return total


class Ranges(NamedTuple):
    """Lowest and highest value of each input of a term; None where nothing is known. Units as in `OperatingPoint`."""

    velocity: tuple[float, float]
    position: tuple[float, float] | None = None
    acceleration: tuple[float, float] | None = None
    load_torque: tuple[float, float] | None = None
    temperature: tuple[float, float] | None = None


@dataclass(frozen=True)
class Term(ABC):
    """One additive part of a friction law. Subclasses are frozen dataclasses that register under their `name`.

    A field is a parameter (a float) or a group of parameters (a dataclass of floats). `units` maps each
    parameter's last name to its unit, in which `{torque}` and `{position}` stand for the joint's own units.
    `parts` is the formula of the term, in numpy: arrays, compensator, C, ONNX and the simulated joint are made from it.
    """

    name: ClassVar[str]
    units: ClassVar[Mapping[str, str]]

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "name" in cls.__dict__:
            require(cls.name.isidentifier(), f"the name of a term must be that of a variable, got {cls.name!r}")
            _REGISTRY[cls.name] = cls

    @abstractmethod
    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`, in steady state if the term has a state.

        It is also called with symbols in place of numbers (`fricomp.laws.expression`). Therefore it computes with the
        inputs of `point` as they are and with numpy's functions, and decides by `np.where`, never by `if`, on them.
        """

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque [N·m] or [N] that overcomes this term at `point`, in steady state if the term has a state."""
        return self.parts(point).total(point.velocity)

    def largest_torque(self, ranges: Ranges) -> float:
        """Largest size of the torque over `ranges` [N·m] or [N]: that at their ends, and next to rest.

        A term whose torque is larger in between, such as a wave, states a bound of its own.
        """
        speeds = [edge * share for edge in ranges.velocity for share in (1.0, _CREEP)]
        places = product(ranges.position or (0.0,), ranges.acceleration or (0.0,), ranges.load_torque or (0.0,))
        ends = product(speeds, places, ranges.temperature or (None,))
        points = (OperatingPoint(v, *place, temperature=hot) for v, place, hot in ends)
        return max(abs(float(self.torque(point))) for point in points)

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
    """A term with internal states, advanced exactly over one step of constant velocity; all are 0 at rest.

    `states` names them. `follow` and `parts_after` are formulas like `parts`.
    """

    states: ClassVar[tuple[str, ...]]

    @abstractmethod
    def follow(self, point: OperatingPoint, before: Sequence[Any], dt: Any) -> tuple[Any, ...]:
        """The states after a step of `dt` [s] at `point`."""

    @abstractmethod
    def parts_after(self, point: OperatingPoint, before: Sequence[Any], after: Sequence[Any], dt: Any) -> Parts:
        """Torque at the end of a step of `dt` [s] from the states `before` to the states `after`."""

    @property
    def sliding_speed(self) -> float:
        """Speed from which a joint counts as sliding for the states [rad/s] or [m/s]; 0 where they know no rest."""
        return 0.0

    def rest_state(self) -> Scalar:
        """The states of a joint that has been at rest without load: a float, or shape (n_states,)."""
        return 0.0 if len(self.states) == 1 else np.zeros(len(self.states))

    def advance(self, state: Scalar, point: OperatingPoint, dt: float) -> tuple[Scalar, Scalar]:
        """The torque at the end of a step of `dt` [s], and the state there."""
        before = (np.asarray(state),) if len(self.states) == 1 else tuple(np.asarray(state))
        after = self.follow(point, before, dt)
        torque = self.parts_after(point, before, after, dt).total(point.velocity)
        return torque, after[0] if len(after) == 1 else np.stack(np.broadcast_arrays(*after))


def term_class(name: str) -> type[Term]:
    """The term registered under `name`.

    Raises:
        ParameterError: No term has this name.
    """
    if name not in _REGISTRY and name not in term_names():
        raise ParameterError(f"unknown friction term {name!r}; known terms: {', '.join(term_names())}")
    return _REGISTRY[name]


def term_names() -> tuple[str, ...]:
    """Names of all registered terms, sorted: those of this folder's modules, and those defined anywhere else."""
    package = __name__.rpartition(".")[0]
    for module in iter_modules(import_module(package).__path__):
        import_module(f"{package}.{module.name}")
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
