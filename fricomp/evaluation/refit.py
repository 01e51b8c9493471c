"""All numbers of a model fitted together to the torque of recordings, in the band in which it is evaluated.

What is fitted in other ways, such as term by term or to a few samples, is made one model by it; and a fit to all blocks
of time but one is what an error on held-out data needs. Steps of Gauss and Newton; where a recording does not tell two
numbers apart, both stay as near as they can to where they were.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.optimize import lsq_linear

from fricomp.blas import one_blas_thread
from fricomp.errors import ParameterError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from .equation import JointEquation, TermMemory, align_torque, recall_torque
from .errors import mark_spans
from .motion import RecordedMotion, Rows, low_pass
from .settings import REFIT

_BODY = ("inertia", "gravity_cosine", "gravity_sine", "offset")
_LEVELS = ("coulomb_torque", "static_torque")
_FIXED = ("load_sensitivity", "reference_load", "reference_temperature", "side", "rest_speed")


@dataclass(frozen=True)
class Refit:
    """A model and its fits to parts of the data.

    Attributes:
        model: Fitted to all blocks.
        folds: Fitted to all but the blocks of each fold.
    """

    model: FrictionModel
    folds: tuple[FrictionModel, ...]


def split_folds(motion: RecordedMotion) -> tuple[tuple[tuple[float, float], ...], ...]:
    """Times of each fold [s]: every so manieth of even blocks of each part."""
    folds: list[list[tuple[float, float]]] = [[] for _ in range(REFIT.folds)]
    for part in motion.parts:
        length = float(part.time[-1] - part.time[0])
        blocks = REFIT.folds * int(np.clip(length / (REFIT.folds * REFIT.block), 1, REFIT.blocks))
        edges = part.time[0] + np.linspace(0.0, length + part.dt, blocks + 1)
        for k in range(blocks):
            folds[k % REFIT.folds].append((float(edges[k]), float(edges[k + 1])))
    return tuple(tuple(one) for one in folds)


@one_blas_thread()
def refit_model(
    model: FrictionModel, motions: Sequence[RecordedMotion], *, held: Sequence[str] = (), fold: bool = True
) -> Refit:
    """Fit the numbers of a model to the recorded torque where the joint moves.

    Args:
        model: To start from; with its dynamics.
        motions: Of the same joint.
        held: Names that stay as they are: of the law, dotted, or of the dynamics.
        fold: Whether to fit all folds as well.

    Raises:
        ParameterError: The model has no dynamics.
    """
    if model.dynamics is None:
        raise ParameterError("a model is refitted with its inertia and gravity: give it its dynamics")
    problem = _Problem(model, tuple(motions), _list_free(model, held))
    starts = sorted((_set_levels(problem, theta) for theta in problem.list_starts()), key=lambda one: one.cost)
    best = min((_descend(problem, one, REFIT.steps) for one in starts[: REFIT.starts]), key=lambda one: one.cost)
    best = problem.differentiate(best) if fold else best
    parts = [replace(best, rows=~rows) for rows in problem.mark_folds()] if fold else []
    others = [_descend(problem, one, REFIT.fold_steps).theta for one in parts]
    return Refit(problem.build(best.theta), tuple(map(problem.build, others)))


@dataclass(frozen=True)
class _Line:
    """The residual about some numbers.

    Attributes:
        theta: The numbers. Shape (p,).
        residual: There. Shape (m,).
        rows: That count, shape (m,).
        jacobian: Derivative by the coordinates: numbers, or their logarithms. Shape (m, p); None before it is needed.
    """

    theta: FloatArray
    residual: FloatArray
    rows: Rows
    jacobian: FloatArray | None = None

    @property
    def cost(self) -> float:
        """Mean square over the rows that count."""
        return float(np.mean(self.residual[self.rows] ** 2))


def _set_levels(problem: _Problem, theta: FloatArray) -> _Line:
    """The numbers that act in proportion set, with the others as they are: a wave of next to no size says nothing about
    its order, and a level that is far off bends the speed of its fall."""
    residual, free = problem.compute_residual(theta), problem.proportional
    line = problem.differentiate(_Line(theta, residual, np.ones(residual.size, dtype=bool)), free)
    return replace(_step(problem, line, free), jacobian=None)


def _descend(problem: _Problem, line: _Line, steps: int) -> _Line:
    """The minimum next to where the line starts."""
    for _ in range(steps):
        after = _step(problem, problem.differentiate(line))
        if not after.cost < (1.0 - REFIT.settled) * line.cost:
            return after
        line = after
    return line


def _step(problem: _Problem, line: _Line, free: Rows | None = None) -> _Line:
    """The best part of a step of Gauss and Newton; the line as it was where none is better."""
    step = problem.solve(line, free)
    tried = [problem.move(line.theta, share * step) for share in REFIT.shares]
    left = [problem.compute_residual(one) for one in tried]
    costs = [float(np.mean(one[line.rows] ** 2)) if one.size == line.rows.size else np.inf for one in left]
    best = int(np.argmin(costs))
    return _Line(tried[best], left[best], line.rows) if costs[best] < line.cost else line


@dataclass(frozen=True)
class _Problem:
    """The residual of a model as a function of its free numbers."""

    model: FrictionModel
    motions: tuple[RecordedMotion, ...]
    names: tuple[str, ...]
    memories: dict[int, TermMemory] = field(default_factory=dict, compare=False)

    @property
    def start(self) -> FloatArray:
        """The numbers of the model."""
        values = _read_values(self.model)
        return np.array([values[name] for name in self.names])

    def build(self, theta: FloatArray) -> FrictionModel:
        """The model with these numbers; its covariance does not carry over."""
        values = dict(zip(self.names, theta.tolist(), strict=True))
        law = self.model.law.replace({name: value for name, value in values.items() if name not in _BODY})
        assert self.model.dynamics is not None
        body = {name: value for name, value in values.items() if name in _BODY}
        body["load_inertia"] = min(self.model.dynamics.load_inertia, body.get("inertia", np.inf))
        return replace(self.model.with_law(law), dynamics=replace(self.model.dynamics, **body))

    @cached_property
    def logarithmic(self) -> Rows:
        """Which numbers may be neither zero nor negative: they move by factors. Shape (p,)."""
        return np.array([not _may_be(self.model, name, 0.0) for name in self.names])

    @cached_property
    def proportional(self) -> Rows:
        """Which numbers act in proportion to their size. Shape (p,)."""
        waves = np.array([name.rsplit(".", 1)[-1] == "order" for name in self.names])
        result: Rows = ~self.logarithmic & ~waves
        return result

    @cached_property
    def energy(self) -> float:
        """Sum of the squares of the recorded torque in the band, at the samples that count."""
        kept = []
        for motion in self.motions:
            stride = _choose_stride(motion)
            for part in motion.parts:
                torque = low_pass(align_torque(part, 0.0), motion.band, part.dt)
                kept.append(torque[::stride][part.moves[::stride]])
        joined = np.concatenate(kept)
        return float(joined @ joined)

    @cached_property
    def lowest(self) -> FloatArray:
        """Where the domain of each number ends: next to nothing, since bristles divide by the level. Shape (p,)."""
        free = np.array([_may_be(self.model, name, -1e-9) for name in self.names])
        return np.where(free, -np.inf, REFIT.least * (np.abs(self.start) + 1e-6))

    @cached_property
    def highest(self) -> FloatArray:
        """The other end in a fit to a part: no friction level grows above every torque that was recorded. Shape
        (p,)."""
        largest = max(float(np.abs(part.torque).max()) for one in self.motions for part in one.parts)
        levels = np.array([name.endswith(_LEVELS) for name in self.names])
        return np.where(levels, largest, np.inf)

    def list_starts(self) -> list[FloatArray]:
        """The numbers of the model, and the same with friction that falls over other parts of the top speed: a fall
        that lies outside the motion has no slope that leads back to it."""
        falls = np.array([name.endswith("stribeck_velocity") for name in self.names])
        tops = [np.quantile(np.abs(part.smooth_velocity), REFIT.top) for one in self.motions for part in one.parts]
        shares = REFIT.falls if falls.any() else ()
        return [self.start, *(np.where(falls, share * float(np.max(tops)), self.start) for share in shares)]

    def move(self, theta: FloatArray, step: FloatArray) -> FloatArray:
        """The numbers after a step in the coordinates, within their domains."""
        moved = np.where(self.logarithmic, theta * np.exp(np.where(self.logarithmic, step, 0.0)), theta + step)
        return np.maximum(moved, np.minimum(self.lowest, theta))

    def solve(self, line: _Line, free: Rows | None = None) -> FloatArray:
        """The step within the domains that lowers the residual most; what its rows do not show stays. Shape (p,).

        In a fit to a part, which starts at the minimum of all, each number has a prior: no step of it alone changes the
        torque by more than was recorded. Rows that do not tell two numbers apart would else move both without end.

        Args:
            line: The residual about some numbers.
            free: Numbers that move, shape (p,); None for all.
        """
        rows = line.rows
        assert line.jacobian is not None
        size = np.linalg.norm(line.jacobian, axis=0)
        seen = size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300)
        seen = seen if free is None else seen & free
        step = np.zeros(seen.size)
        if not seen.any():
            return step
        A = line.jacobian[rows][:, seen] / size[seen]
        triangle: FloatArray = np.asarray(np.linalg.qr(np.column_stack([A, -line.residual[rows]]), mode="r"))
        prior = 0.0 if rows.all() else np.sqrt(line.cost / max(self.energy, 1e-300))
        held = max(REFIT.rank, prior) * np.eye(int(seen.sum()))
        low = np.where(self.logarithmic, -REFIT.longest, np.minimum(self.lowest - line.theta, 0.0))[seen] * size[seen]
        most = np.inf if rows.all() else np.maximum(self.highest - line.theta, 0.0)
        high = np.where(self.logarithmic, REFIT.longest, most)[seen] * size[seen]
        found = lsq_linear(
            np.vstack([triangle[:, :-1], held]),
            np.concatenate([triangle[:, -1], np.zeros(held.shape[0])]),
            bounds=(np.minimum(low, -1e-12), np.maximum(high, 1e-12)),
            method="bvls",
        )
        step[seen] = found.x / size[seen]
        return step

    def compute_residual(self, theta: FloatArray) -> FloatArray:
        """Recorded torque less the model's in the band, at the samples that count. Shape (m,)."""
        try:
            model = self.build(theta)
        except ParameterError:
            return np.full(1, np.inf)
        assert model.dynamics is not None
        equation = JointEquation(model.law, model.dynamics)
        found = []
        for motion in self.motions:
            for part in motion.parts:
                memory = self.memories.setdefault(id(part), TermMemory(REFIT.kept_terms * len(model.law.terms) + 1))
                torque = recall_torque(part, model.dynamics.torque_delay, memory)
                try:
                    left = torque - equation.follow(part, motion.rest_speed, memory).torque
                except ArithmeticError:  # a bristle that is too stiff for plain floats
                    return np.full(1, np.inf)
                stride = _choose_stride(motion)
                found.append(low_pass(left, motion.band, part.dt)[::stride][part.moves[::stride]])
        result = np.concatenate(found)
        return result if np.all(np.isfinite(result)) else np.full(1, np.inf)

    def differentiate(self, line: _Line, free: Rows | None = None) -> _Line:
        """The line with its derivative by the numbers that move: all where `free` is None."""
        if line.jacobian is not None:
            return line
        theta, residual = line.theta, line.residual
        size = np.maximum(np.abs(theta), np.abs(self.start))
        steps = REFIT.difference * np.where(self.logarithmic | (size < REFIT.nothing), 1.0, size)
        columns = []
        for k, step in enumerate(steps):
            if free is not None and not free[k]:
                columns.append(np.zeros_like(residual))
                continue
            moved = self.move(theta, np.where(np.arange(theta.size) == k, step, 0.0))
            column = (self.compute_residual(moved) - residual) / step
            columns.append(column if column.size == residual.size else np.zeros_like(residual))
        return replace(line, jacobian=np.stack(columns, axis=1))

    def mark_folds(self) -> list[Rows]:
        """The samples of each fold, with the gap around them that no other fold uses. Shape (m,) each."""
        result: list[list[Rows]] = [[] for _ in range(REFIT.folds)]
        for motion in self.motions:
            stride, gap = _choose_stride(motion), REFIT.gap / motion.band
            for k, spans in enumerate(split_folds(motion)):
                for part in motion.parts:
                    inside = mark_spans(part.time, [(a - gap, b + gap) for a, b in spans])
                    result[k].append(inside[::stride][part.moves[::stride]])
        # rows of a part follow each other as in the residual
        return [np.concatenate(one) for one in result]


def _read_values(model: FrictionModel) -> dict[str, float]:
    assert model.dynamics is not None
    return {**model.law.parameters(), **{name: getattr(model.dynamics, name) for name in _BODY}}


def _list_free(model: FrictionModel, held: Sequence[str]) -> tuple[str, ...]:
    gravity = ("gravity_cosine", "gravity_sine") if model.motion == "linear" else ()
    return tuple(
        name
        for name in _read_values(model)
        if name not in held and name not in gravity and name.rsplit(".", 1)[-1] not in _FIXED
    )


def _may_be(model: FrictionModel, name: str, value: float) -> bool:
    if name in _BODY:
        return name != "inertia"
    try:
        model.law.replace({name: value})
    except ParameterError:
        return False
    return True


def _choose_stride(motion: RecordedMotion) -> int:
    """Every so manieth sample says what all of them say in the band."""
    return max(int(1.0 / (REFIT.rate * motion.band * motion.dt)), 1)
