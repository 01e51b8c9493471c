"""All numbers of a model fitted together to the torque of recordings, in the band in which it is evaluated.

What is fitted in other ways, such as term by term or to a few samples, is made one model by it; and a fit to all blocks
of time but one is what an error on held-out data needs. Steps of Gauss and Newton; where a recording does not tell two
numbers apart, both stay as near as they can to where they were.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from .equation import JointEquation, align_torque
from .motion import RecordedMotion, low_pass
from .settings import REFIT

__all__ = ["Refit", "refit_model", "split_folds"]

Rows = NDArray[np.bool_]

_BODY = ("inertia", "gravity_cosine", "gravity_sine", "offset")
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
    theta, (residual, jacobian) = problem.start, problem.linearise(problem.start)
    for _ in range(REFIT.steps):
        step = _solve(jacobian, residual, np.ones(residual.size, dtype=bool))
        tried = [problem.clip(theta + share * step) for share in REFIT.shares]
        costs = [float(np.mean(problem.compute_residual(one) ** 2)) for one in tried]
        best, before = int(np.argmin(costs)), float(np.mean(residual**2))
        if not costs[best] < (1.0 - REFIT.settled) * before:
            break
        theta = tried[best]
        residual, jacobian = problem.linearise(theta)
    marked = problem.mark_folds() if fold else []
    others = [problem.clip(theta + _solve(jacobian, residual, ~rows)) for rows in marked]
    return Refit(problem.build(theta), tuple(map(problem.build, others)))


@dataclass(frozen=True)
class _Problem:
    """The residual of a model as a function of its free numbers."""

    model: FrictionModel
    motions: tuple[RecordedMotion, ...]
    names: tuple[str, ...]

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

    def clip(self, theta: FloatArray) -> FloatArray:
        """The numbers within the domains of the law: what may not be negative is held at next to nothing."""
        result = theta.copy()
        for k, name in enumerate(self.names):
            if result[k] <= 0.0 and not _may_be_negative(self.model, name):
                result[k] = REFIT.least * abs(self.start[k]) + 1e-12
        return result

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
                torque = align_torque(part, model.dynamics.torque_delay)
                left = torque - equation.follow(part, motion.rest_speed).torque
                stride = _choose_stride(motion)
                found.append(low_pass(left, motion.band, part.dt)[::stride][part.moves[::stride]])
        return np.concatenate(found)

    def linearise(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Residual and its derivative by the numbers. Shapes (m,) and (m, p)."""
        residual = self.compute_residual(theta)
        steps = REFIT.difference * np.maximum(np.abs(theta), np.abs(self.start) + 1e-9)
        columns = []
        for k, step in enumerate(steps):
            moved = theta.copy()
            moved[k] += step
            column = (self.compute_residual(moved) - residual) / step
            columns.append(column if column.size == residual.size else np.zeros_like(residual))
        return residual, np.stack(columns, axis=1)

    def mark_folds(self) -> list[Rows]:
        """The samples of each fold, with the gap around them that no other fold uses. Shape (m,) each."""
        result: list[list[Rows]] = [[] for _ in range(REFIT.folds)]
        for motion in self.motions:
            stride, gap = _choose_stride(motion), REFIT.gap / motion.band
            for k, spans in enumerate(split_folds(motion)):
                for part in motion.parts:
                    inside = np.zeros(part.time.size, dtype=bool)
                    for a, b in spans:
                        inside |= (part.time >= a - gap) & (part.time < b + gap)
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


def _may_be_negative(model: FrictionModel, name: str) -> bool:
    if name in _BODY:
        return name != "inertia"
    try:
        model.law.replace({name: -1e-9})
    except ParameterError:
        return False
    return True


def _choose_stride(motion: RecordedMotion) -> int:
    """Every so manieth sample says what all of them say in the band."""
    return max(int(1.0 / (REFIT.rate * motion.band * motion.dt)), 1)


def _solve(jacobian: FloatArray, residual: FloatArray, rows: Rows) -> FloatArray:
    """The step that lowers the residual most; directions that these rows do not show stay. Shape (p,)."""
    size = np.linalg.norm(jacobian[rows], axis=0)
    seen = size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300)
    step = np.zeros(jacobian.shape[1])
    if seen.any():
        A = jacobian[rows][:, seen] / size[seen]
        step[seen] = np.linalg.lstsq(A, -residual[rows], rcond=REFIT.rank)[0] / size[seen]
    return step
