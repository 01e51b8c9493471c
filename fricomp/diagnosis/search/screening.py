"""Screening: every effect as columns of the residual, and all single effects and pairs scored at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..effects import EFFECTS, Context
from ..effects.structure import Candidate, Structure
from ..inputs.track import FloatArray
from ..joint.observer import Contribution
from ..joint.problem import Problem
from .settings import SEARCH


@dataclass(frozen=True)
class Column:
    """The columns of one candidate.

    Attributes:
        candidate: Effect and starting values.
        span: Orthonormal columns, with the base model projected out. Shape (m, d).
        energy: What they explain of the residual, in units of the noise variance.
    """

    candidate: Candidate
    span: FloatArray
    energy: float


@dataclass(frozen=True)
class Screen:
    """All candidates of a recording, strongest first."""

    columns: tuple[Column, ...]

    def select_best(self) -> dict[str, Column]:
        """The strongest candidate of each effect, strongest effect first."""
        best: dict[str, Column] = {}
        for column in self.columns:
            best.setdefault(column.candidate.name, column)
        return best

    def select_pairs(self, residual: FloatArray, keep: int) -> list[tuple[Candidate, Candidate]]:
        """The pairs of different effects that explain most of `residual` together."""
        scored = []
        for a, b in combinations(self.columns, 2):
            if a.candidate.name == b.candidate.name:
                continue
            rest = b.span - a.span @ (a.span.T @ b.span)
            Q = orthonormalise(rest, 1e-2)
            scored.append((a.energy + float(np.sum((Q.T @ residual) ** 2)), a.candidate, b.candidate))
        scored.sort(key=lambda item: -item[0])
        seen: dict[tuple[str, ...], tuple[Candidate, Candidate]] = {}
        for _, a_, b_ in scored:
            seen.setdefault(tuple(sorted((a_.name, b_.name))), (a_, b_))
            if len(seen) >= keep:
                break
        return list(seen.values())


def list_candidates(contexts: Sequence[Context], without: Sequence[str] = ()) -> list[Candidate]:
    """Every available effect with each of its starting hypotheses."""
    return [
        Candidate(name, tuple(start.items()))
        for name, effect in sorted(EFFECTS.items())
        if name not in without and effect.find_obstacle(contexts) is None
        for start in effect.propose_starts(contexts)
    ]


def screen(
    problem: Problem,
    structure: Structure,
    theta: FloatArray,
    residual: FloatArray,
    jacobian: FloatArray,
    candidates: Sequence[Candidate] | None = None,
) -> Screen:
    """Score `candidates`, or every effect that `structure` does not have yet, linearised about `theta`."""
    basis = orthonormalise(jacobian)
    candidates = list_candidates(structure.contexts, structure.names) if candidates is None else candidates
    points: list[tuple[Candidate, FloatArray, float]] = []
    for candidate in candidates:
        points += _list_points(structure, candidate)
    own, loaded = structure.compute_contributions(theta), [structure.load_at(c, theta) for c in structure.contexts]

    def add(candidate: Candidate, vector: FloatArray) -> list[Contribution]:
        values = Structure(structure.contexts, (candidate,)).name_values(vector)[candidate.name]
        contexts = loaded if candidate.effect.follows_load else structure.contexts
        return [a + candidate.effect.compute_contribution(c, values) for a, c in zip(own, contexts, strict=True)]

    contributions = (add(candidate, vector) for candidate, vector, _ in points)
    vectors = problem.compute_vectors([structure.unpack_plant(theta)] * len(points), contributions)
    columns: dict[Candidate, list[FloatArray]] = {}
    for (candidate, _, step), vector in zip(points, vectors, strict=True):
        columns.setdefault(candidate, []).append((vector - residual) / step)
    result = []
    for candidate, parts in columns.items():
        if not all(np.all(np.isfinite(part)) for part in parts):
            continue  # its hypothesis does not simulate on this recording
        span = orthonormalise(project_out(np.stack(parts, axis=1), basis), 1e-3)
        result.append(Column(candidate, span, float(np.sum((span.T @ residual) ** 2))))
    return Screen(tuple(sorted(result, key=lambda column: -column.energy)))


def _list_points(structure: Structure, candidate: Candidate) -> list[tuple[Candidate, FloatArray, float]]:
    """Effect parameters to simulate for the columns of `candidate`, with the step each column is divided by."""
    alone = Structure(structure.contexts, (candidate,))
    start = alone.build_start()
    linear = [i for i, (_, p) in enumerate(alone.parameters) if p.linear]
    if not linear:
        return [(candidate, start, 1.0)]
    points = []
    for i in linear:
        vector = start.copy()
        vector[i] = alone.parameters[i][1].scale
        points.append((candidate, vector, 1.0))
    return points


def orthonormalise(columns: FloatArray, tolerance: float = 1e-10) -> FloatArray:
    """Orthonormal basis of the columns, those below `tolerance` of the largest singular value left out."""
    if columns.shape[1] == 0:
        return columns
    norm = np.linalg.norm(columns, axis=0)
    if tolerance >= SEARCH.coarse_tolerance:  # three times as fast, and exact as far as that
        scaled = columns / np.where(norm > 0.0, norm, 1.0)
        squares, V = np.linalg.eigh(scaled.T @ scaled)
        kept = squares > max((tolerance**2) * squares[-1], SEARCH.coarse_tolerance**2)
        by_size: FloatArray = (scaled @ V[:, kept]) / np.sqrt(squares[kept])
        return by_size
    U, s, _ = np.linalg.svd(columns / np.where(norm > 0.0, norm, 1.0), full_matrices=False)
    result: FloatArray = U[:, s > max(tolerance * s[0], 1e-12)] if s[0] > 0.0 else U[:, :0]
    return result


def project_out(columns: FloatArray, basis: FloatArray) -> FloatArray:
    """`columns` without what `basis` spans."""
    result: FloatArray = columns - basis @ (basis.T @ columns)
    return result
