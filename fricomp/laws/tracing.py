"""The formulas of a term as expressions, for everything that prints them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fricomp.laws.expression import Expression, Symbol, as_expression, find_symbols
from fricomp.laws.term import DynamicTerm, OperatingPoint, Parts, Term

INPUTS = ("position", "load_torque", "temperature", "acceleration")
"""What a term may draw on besides velocity and normal load."""

_VELOCITY, _POSITION, _ACCELERATION = Symbol("velocity"), Symbol("position"), Symbol("acceleration")
_LOAD_TORQUE, _NORMAL_LOAD, _TEMPERATURE = Symbol("load_torque"), Symbol("normal_load"), Symbol("temperature")
_SPEED, _IS_FORWARD = Symbol("speed"), Symbol("is_forward")


@dataclass(frozen=True, slots=True)
class TracedPoint(OperatingPoint):
    """An operating point of symbols that have the names of its fields.

    Attributes:
        traced_speed: What stands for the speed.
        forward: What stands for the direction of motion: a symbol, or True or False where it is known.
        unknown: Inputs that may be missing; the symbols `has_temperature` and `has_normal_load` say whether they are.
    """

    velocity: Any = _VELOCITY
    position: Any = _POSITION
    acceleration: Any = _ACCELERATION
    load_torque: Any = _LOAD_TORQUE
    normal_load: Any = _NORMAL_LOAD
    temperature: Any = _TEMPERATURE
    traced_speed: Any = _SPEED
    forward: Any = _IS_FORWARD
    unknown: tuple[str, ...] = ("temperature", "normal_load")

    @property
    def speed(self) -> Any:
        """What stands for the speed."""
        return self.traced_speed

    @property
    def is_forward(self) -> Any:
        """What stands for the direction of motion."""
        return self.forward

    def temperature_or(self, reference: float) -> Any:
        """The temperature, or a choice between it and `reference`."""
        return self._choose("temperature", self.temperature, reference)

    def normal_load_or(self, reference: float) -> Any:
        """The normal load, or a choice between it and `reference`."""
        return self._choose("normal_load", self.normal_load, reference)

    def _choose(self, name: str, value: Any, reference: float) -> Any:
        if value is None:
            return reference
        return np.where(Symbol(f"has_{name}"), value, reference) if name in self.unknown else value  # type: ignore[call-overload]


class TracedStep(NamedTuple):
    """One step of the states of a term.

    The symbols of the states are `TERM_STATE` before the step and `TERM_STATE_after` at its end.

    Attributes:
        states: Names of the symbols before the step.
        after: What each state is at the end of the step.
        parts: Torque at the end of the step.
    """

    states: tuple[str, ...]
    after: tuple[Expression, ...]
    parts: Parts


def trace_parts(term: Term, point: TracedPoint | None = None) -> Parts:
    """Formula of `term` in steady state, at a point of symbols."""
    return _as_expressions(term.parts(point or TracedPoint()))


def trace_step(term: DynamicTerm, point: TracedPoint, dt: float | Symbol) -> TracedStep:
    """Formula of one step of `dt` [s]."""
    names = tuple(f"{term.name}_{state}" for state in term.states)
    before, after = ([Symbol(f"{name}{end}") for name in names] for end in ("", "_after"))
    reached = tuple(as_expression(state) for state in term.follow(point, before, dt))
    return TracedStep(names, reached, _as_expressions(term.parts_after(point, before, after, dt)))


def _as_expressions(parts: Parts) -> Parts:
    return Parts(*(None if part is None else as_expression(part) for part in parts))


def find_inputs(terms: Sequence[Term]) -> frozenset[str]:
    """Which of `INPUTS` the formulas of `terms` draw on."""
    found: frozenset[str] = frozenset()
    for term in terms:
        found |= find_symbols(*trace_parts(term))
        if isinstance(term, DynamicTerm):
            step = trace_step(term, TracedPoint(), Symbol("dt"))
            found |= find_symbols(*step.after, *step.parts)
    return found & set(INPUTS)
