"""A structure: the base model with some effects, as one vector of parameters that is fitted as a whole."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..inputs.track import FloatArray
from ..joint.base import BASE_NAMES, unpack
from ..joint.observer import Contribution, Observation, Plant
from ..joint.problem import Problem
from ..joint.race import Entry
from ..joint.solver import Box, Descent, Fit, descend, run_together
from ..joint.threads import run_in_threads
from . import EFFECTS, Context, Effect, EffectParameter
from .context import add_load
from .overtones import is_amplitude, list_overtone_parameters, list_overtones

__all__ = ["Candidate", "Structure", "fit_all"]

N_BASE = len(BASE_NAMES)
_OF_LOAD = [BASE_NAMES.index(name) for name in ("gravity_cos", "gravity_sin")]


@dataclass(frozen=True)
class Candidate:
    """One effect with starting values.

    Attributes:
        name: The effect's name.
        values: Starting value of each of its parameters.
    """

    name: str
    values: tuple[tuple[str, float], ...]

    @property
    def effect(self) -> Effect:
        """The catalogue's entry."""
        return EFFECTS[self.name]

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        """The effect's numbers, with those of the overtones that its starting values name."""
        own = self.effect.list_parameters(contexts)
        overtones = list_overtones(dict(self.values))
        return (*own, *(one for times in overtones for one in list_overtone_parameters(own, times)))

    def follow_inertia(self, contexts: Sequence[Context], factor: float) -> Candidate:
        """The same parts of an inertia, by the mass that they mean, on a joint whose inertia is `factor` times as
        large."""
        parts = {p.name: p for p in self.list_parameters(contexts) if p.of_inertia}
        moved = (
            (name, float(np.clip(value / factor, parts[name].lower, parts[name].upper)) if name in parts else value)
            for name, value in self.values
        )
        return Candidate(self.name, tuple(moved))

    def at_order(self, order: float) -> Candidate:
        """The pure wave of the same ripple at another order [1/rad] or [1/m], its size to be found."""
        form = {name: value for name, value in self.values if not is_amplitude(name)}
        return Candidate(self.name, tuple((form | {"order": order}).items()))


@dataclass(frozen=True)
class Structure:
    """The base with effects.

    Attributes:
        contexts: Motion of each recording.
        candidates: The effects, with their starting values.
    """

    contexts: tuple[Context, ...]
    candidates: tuple[Candidate, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, sorted."""
        return tuple(sorted(candidate.name for candidate in self.candidates))

    @cached_property
    def parameters(self) -> list[tuple[str, EffectParameter]]:
        """Effect name and parameter, in the order of the vector; computed once, since every point of a fit asks."""
        return [(c.name, p) for c in self.candidates for p in c.list_parameters(self.contexts)]

    @property
    def freedom(self) -> int:
        """Number of effect parameters that are fitted."""
        return sum(p.scale > 0.0 for _, p in self.parameters)

    def build_start(self) -> FloatArray:
        """Starting values of the effect parameters."""
        return np.array(
            [dict(c.values).get(p.name, 0.0) for c in self.candidates for p in c.list_parameters(self.contexts)]
        )

    def build_known_box(self) -> Box:
        """Build the same domain with what is known of the effect parameters, whatever start a fit had."""
        known = [parameter.known or parameter.prior for _, parameter in self.parameters]
        return replace(self.build_box(), precision=np.diag([1.0 / one**2 if one > 0.0 else 0.0 for one in known]))

    def build_box(self) -> Box:
        """Domain of the effect parameters; one with scale zero is held at its start."""
        start, parameters = self.build_start(), [p for _, p in self.parameters]
        fixed = np.array([p.scale == 0.0 for p in parameters], dtype=bool)
        lower = np.where(fixed, start, [p.lower for p in parameters])
        upper = np.where(fixed, start, [p.upper for p in parameters])
        scale = np.array([p.scale if p.scale > 0.0 else 1e-9 for p in parameters])
        precision = np.diag([1.0 / p.prior**2 if p.prior > 0.0 else 0.0 for p in parameters])
        reach = np.array([1000.0 if p.linear else 2.0 for p in parameters])
        return Box(lower, upper, scale, start.copy(), precision, reach)

    def name_values(self, vector: FloatArray) -> dict[str, dict[str, float]]:
        """Effect parameters by effect and name."""
        result: dict[str, dict[str, float]] = {}
        for (name, parameter), value in zip(self.parameters, vector, strict=True):
            result.setdefault(name, {})[parameter.name] = float(value)
        return result

    def compute_contributions(self, theta: FloatArray) -> list[Contribution]:
        """What the effects add to each recording at `theta`, friction under load by the load of that joint."""
        return [self.compute_contribution(context, theta) for context in self.contexts]

    def compute_contribution(self, context: Context, theta: FloatArray) -> Contribution:
        """What the effects add along one motion at `theta`, friction under load by the load of that joint."""
        values, total = self.name_values(theta[N_BASE:]), Contribution()
        loaded = self.load_at(context, theta) if self.follows_load else context
        for candidate in self.candidates:
            along = loaded if candidate.effect.follows_load else context
            total = total + candidate.effect.compute_contribution(along, values[candidate.name])
        return total

    @cached_property
    def follows_load(self) -> bool:
        """Whether what the effects add changes with the load of the joint, and nobody recorded that."""
        unknown = any("load_torque" not in context.channels for context in self.contexts)
        return unknown and any(candidate.effect.follows_load for candidate in self.candidates)

    def load_at(self, context: Context, theta: FloatArray) -> Context:
        """Put the load that the joint of `theta` carries on a motion."""
        values = self.name_values(theta[N_BASE:])
        carried = [one.effect.compute_load(context, values[one.name]) for one in self.candidates]
        return add_load(context, self.unpack_plant(theta), np.zeros_like(context.position) + sum(carried))

    def key_contributions(self, theta: FloatArray) -> bytes:
        """A key of all that the contributions at `theta` hang on."""
        return (theta[_OF_LOAD].tobytes() if self.follows_load else b"") + theta[N_BASE:].tobytes()

    def observe(self, problem: Problem, theta: FloatArray) -> list[Observation]:
        """Observed simulations at `theta`."""
        return problem.observe_all([self.unpack_plant(theta)], [self.compute_contributions(theta)])[0]

    def observe_with_and_without(
        self, problem: Problem, theta: FloatArray, names: Collection[str]
    ) -> tuple[list[Observation], list[Observation]]:
        """Observed simulations at `theta`, and the same without the effects `names`."""
        kept = [c for c in self.candidates if c.name not in names]
        held = [True] * N_BASE + [owner not in names for owner, _ in self.parameters]
        less = Structure(self.contexts, tuple(kept)).compute_contributions(theta[np.array(held, dtype=bool)])
        plant = self.unpack_plant(theta)
        complete, without = problem.observe_all([plant, plant], [self.compute_contributions(theta), less])
        return complete, without

    def compute_added(self, problem: Problem, theta: FloatArray, names: Collection[str]) -> FloatArray:
        """What the effects `names` add to the weighted rows at `theta`. Shape (m,)."""
        complete, without = self.observe_with_and_without(problem, theta, names)
        return problem.compute_vector(complete) - problem.compute_vector(without)

    def unpack_plant(self, theta: FloatArray) -> Plant:
        """The base part of `theta`."""
        return unpack(theta[:N_BASE])

    def move_contexts(self, theta: FloatArray) -> tuple[Context, ...]:
        """Compute the motion of each recording with the joint of `theta` and the load that it carries there.

        A base that is fitted without friction under load bends its gravity, and with it the load.
        """
        plant = self.unpack_plant(theta)
        return tuple(replace(self.load_at(context, theta), plant=plant) for context in self.contexts)

    def move_to(self, contexts: tuple[Context, ...]) -> Structure:
        """The same effects on the motion of another joint: what hangs on a spring there stays as heavy as it is."""
        factor = contexts[0].plant.inertia / self.contexts[0].plant.inertia
        return Structure(contexts, tuple(one.follow_inertia(contexts, factor) for one in self.candidates))

    def compute_residuals(self, problem: Problem, points: Sequence[FloatArray]) -> list[FloatArray]:
        """Weighted residual vectors at several points."""
        return problem.build_residual(self.compute_contributions)(points)

    def start_descent(
        self,
        theta: FloatArray,
        base_box: Box,
        *,
        jacobian: FloatArray | None = None,
        iterations: int = 8,
        refresh: int = 1,
        entry: Entry | None = None,
    ) -> Descent:
        """A fit of base and effects together from `theta`, for `fit_all`.

        Args:
            theta: Start, base first.
            base_box: Domain of the base.
            jacobian: The first columns of the Jacobian at the start where they are known; the others are added.
            iterations: Most steps.
            refresh: Steps between fresh Jacobians.
            entry: The race that it runs in; None where it runs to its end.
        """
        box = base_box.join(self.build_box())
        return descend(theta, box, jacobian=jacobian, iterations=iterations, refresh=refresh, entry=entry)


def fit_all(problem: Problem, descents: Sequence[tuple[Structure, Descent]]) -> list[Fit]:
    """Run fits of several structures side by side."""
    structures = [structure for structure, _ in descents]

    def evaluate(asked: list[list[FloatArray]]) -> list[list[FloatArray]]:
        pairs = [(s, point) for s, points in zip(structures, asked, strict=True) for point in points]
        plants = [structure.unpack_plant(point) for structure, point in pairs]
        vectors = iter(problem.compute_vectors(plants, _compute_contributions(pairs, problem.count_at_once)))
        return [[next(vectors) for _ in points] for points in asked]

    return run_together([descent for _, descent in descents], evaluate)


def _compute_contributions(
    points: Sequence[tuple[Structure, FloatArray]], at_once: int
) -> Iterator[list[Contribution]]:
    """Compute what the effects add at each point, so many at once. Points of a Jacobian differ by one parameter, so
    most of them share this."""
    for start in range(0, len(points), at_once):
        part = points[start : start + at_once]
        keys = [(id(structure), structure.key_contributions(point)) for structure, point in part]
        different = dict(zip(keys, part, strict=True))
        known = dict(zip(different, run_in_threads(_compute_at, different.values()), strict=True))
        yield from (known[key] for key in keys)


def _compute_at(pair: tuple[Structure, FloatArray]) -> list[Contribution]:
    """Compute what the effects add at one point, in a thread. A point that does not simulate may overflow."""
    structure, point = pair
    with np.errstate(over="ignore", invalid="ignore"):
        return structure.compute_contributions(point)
