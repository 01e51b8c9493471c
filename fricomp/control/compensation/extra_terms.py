"""Formulas of the terms that fit no curve, summed by what they resist, for the compensator, adaptation and C."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from fricomp.control.settings import CompensationSettings
from fricomp.laws import DynamicTerm, Parts, Term, TracedPoint, TracedStep, trace_parts, trace_step
from fricomp.laws.expression import Expression, Number, Symbol, add_up, find_symbols
from fricomp.laws.source import compile_python, print_python

__all__ = ["ExtraFormulas", "ExtraTorque", "build_steady", "find_bounds", "trace_extra"]

TURNS_FORWARD = "turns_forward"
"""Symbol of the direction that dry friction acts against, which a position error may turn before the velocity."""


class ExtraTorque(NamedTuple):
    """What the terms that fit no curve add up to [N·m] or [N].

    Attributes:
        dry: Level against the direction of motion.
        drag: Along the velocity.
        held: Whatever the direction of motion.
    """

    dry: float
    drag: float
    held: float


@dataclass(frozen=True)
class ExtraFormulas:
    """The same as formulas over `velocity`, `speed`, `position`, `load_torque`, `temperature`, `acceleration`, states.

    Attributes:
        dry: Level against the direction of motion; it may be negative.
        drag: Along the velocity.
        held: Whatever the direction of motion.
        steps: How the states of the terms go on; their `parts` are in the sums.
    """

    dry: Expression
    drag: Expression
    held: Expression
    steps: tuple[TracedStep, ...]

    @property
    def symbols(self) -> frozenset[str]:
        """Names of all symbols."""
        after = [state for step in self.steps for state in step.after]
        return find_symbols(self.dry, self.drag, self.held, *after)


def trace_extra(terms: Sequence[Term], period: float | None) -> ExtraFormulas:
    """Formulas of `terms`, whose states are followed over periods of `period` [s]; None for steady sliding.

    A bristle beside another dry curve is always that of steady sliding. No normal load is known to these terms.
    """
    along = TracedPoint(normal_load=None)
    against = TracedPoint(normal_load=None, forward=Symbol(TURNS_FORWARD))
    found: list[Parts] = []
    steps: list[TracedStep] = []
    for term in terms:
        parts, dry = trace_parts(term, along), trace_parts(term, against).dry
        if isinstance(term, DynamicTerm) and period is not None:
            step = trace_step(term, along, period)
            if step.parts.bristle is None:
                steps.append(step)
                parts, dry = step.parts, trace_step(term, against, period).parts.dry
        found.append(parts._replace(dry=dry))
    dry, drag, held = (add_up(getattr(parts, kind) for parts in found) for kind in ("dry", "drag", "held"))
    return ExtraFormulas(dry, drag, held, tuple(steps))


def find_bounds(settings: CompensationSettings) -> dict[str, tuple[float, float]]:
    """Ranges beyond which an input counts as their ends, by the name of its symbol."""
    ranges = {
        "velocity": settings.velocity_range,
        "load_torque": settings.load_torque_range,
        "temperature": settings.temperature_range,
        "acceleration": settings.acceleration_range,
    }
    return {name: edges for name, edges in ranges.items() if edges is not None and edges != (-inf, inf)}


def build_steady(
    terms: Sequence[Term], settings: CompensationSettings
) -> Callable[[float, float, float, float | None, float], ExtraTorque]:
    """The sum of `terms` in steady sliding, as a function of velocity, position, load torque, temperature and
    acceleration, all finite.
    """
    formulas = trace_extra(terms, None)
    names = {
        "is_forward": "velocity >= 0.0",
        TURNS_FORWARD: "velocity >= 0.0",
        "speed": "abs(velocity)",
        "has_temperature": "temperature is not None",
    }
    lines, texts = print_python([formulas.dry, formulas.drag, formulas.held], names)
    body = [*clip_lines(find_bounds(settings), formulas.symbols), *lines, f"return {', '.join(texts)}"]
    head = "def steady(velocity, position, load_torque, temperature, acceleration):"
    steady = compile_python([head, *(f"    {line}" for line in body)], "steady")
    return lambda *inputs: ExtraTorque(*steady(*inputs))


def clip_lines(bounds: dict[str, tuple[float, float]], symbols: frozenset[str]) -> list[str]:
    """Lines of Python that hold the inputs among `symbols` to their ranges."""
    lines = []
    needed = symbols | ({"velocity"} if symbols & {"speed", "is_forward"} else set())
    for name, edges in bounds.items():
        if name in needed:
            (low, high) = (print_python([Number(edge)])[1][0] for edge in edges)
            known = "temperature is not None and " if name == "temperature" else ""
            lines += [f"if {known}not {low} <= {name} <= {high}:", f"    {name} = {low} if {name} < {low} else {high}"]
    return lines
