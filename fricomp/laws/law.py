"""A friction law: terms that add up."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws.term import DynamicTerm, OperatingPoint, Scalar, Term, require

LawState = tuple[Scalar, ...]


@dataclass(frozen=True)
class FrictionLaw:
    """The sum of its terms. Each name of a term may occur once.

    Attributes:
        terms: One or more terms; see `fricomp.laws.term_names` for those that exist.

    Raises:
        ParameterError: No term, or the same term twice.
    """

    terms: tuple[Term, ...]

    def __post_init__(self) -> None:
        names = [term.name for term in self.terms]
        require(bool(names), "a friction law needs at least one term")
        require(len(set(names)) == len(names), f"each term may occur once, got {', '.join(names)}")

    @property
    def is_dynamic(self) -> bool:
        """Whether any term has an internal state."""
        return any(isinstance(term, DynamicTerm) for term in self.terms)

    def term(self, name: str) -> Term:
        """The term called `name`.

        Raises:
            ParameterError: The law has no such term.
        """
        for term in self.terms:
            if term.name == name:
                return term
        raise ParameterError(f"the law has no term {name!r}; it has {', '.join(t.name for t in self.terms)}")

    def with_term(self, term: Term) -> Self:
        """This law with `term` added, or put in the place of the one with its name."""
        kept = tuple(old for old in self.terms if old.name != term.name)
        return type(self)((*kept, term))

    def torque(self, velocity: Scalar, **inputs: Scalar | None) -> Scalar:
        """Friction torque [N·m] or [N], to be added to overcome friction.

        Args:
            velocity: [rad/s] or [m/s], a float or an array.
            inputs: Further fields of `OperatingPoint`, such as `position` or `normal_load`.

        Returns:
            A float for a float, an array of the common shape for arrays. Terms with a state contribute their
            steady-state torque; use `advance` to follow the state.
        """
        point = OperatingPoint(velocity, **inputs)  # type: ignore[arg-type]
        total = np.asarray(sum((np.asarray(term.torque(point)) for term in self.terms), np.float64(0.0)))
        return float(total) if total.ndim == 0 else total

    def rest_state(self) -> LawState:
        """States of the dynamic terms of a joint at rest, in the order of the terms."""
        return tuple(term.rest_state() for term in self.terms if isinstance(term, DynamicTerm))

    def advance(self, state: LawState, point: OperatingPoint, dt: float) -> tuple[Scalar, LawState]:
        """Torque [N·m] or [N] and states after a step of `dt` [s] at `point`.

        Raises:
            ParameterError: `dt` is not positive.
        """
        require(dt > 0.0, f"dt must be positive [s], got {dt!r}")
        remaining, states, total = iter(state), [], np.asarray(0.0)
        for term in self.terms:
            if isinstance(term, DynamicTerm):
                torque, after = term.advance(next(remaining), point, dt)
                states.append(after)
            else:
                torque = term.torque(point)
            total = total + np.asarray(torque)
        return (float(total) if total.ndim == 0 else total), tuple(states)

    def parameters(self) -> dict[str, float]:
        """All parameters by dotted name, such as `stribeck.forward.coulomb_torque`."""
        return {f"{t.name}.{name}": value for t in self.terms for name, value in t.parameters().items()}

    def units(self, torque_unit: str = "N·m", position_unit: str = "rad") -> dict[str, str]:
        """The unit of each parameter, by dotted name."""
        return {
            f"{t.name}.{name}": t.units[name.rsplit(".", 1)[-1]].format(torque=torque_unit, position=position_unit)
            for t in self.terms
            for name in t.parameters()
        }

    def replace(self, values: Mapping[str, float]) -> Self:
        """This law with the parameters named in `values` changed.

        Raises:
            ParameterError: A name is unknown or a value is outside its domain.
        """
        unknown = sorted(set(values) - set(self.parameters()))
        require(not unknown, f"unknown parameter {', '.join(unknown)}; known: {', '.join(self.parameters())}")
        terms = tuple(
            t.with_parameters(
                {n.removeprefix(f"{t.name}."): v for n, v in values.items() if n.startswith(f"{t.name}.")}
            )
            for t in self.terms
        )
        return type(self)(terms)
