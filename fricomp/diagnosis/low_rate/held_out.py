"""Errors of models on blocks of time that their fit did not use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricomp.evaluation import RecordedMotion, compute_missing_torque, refit_model, split_folds
from fricomp.model import FrictionModel
from fricomp.root_mean_square import compute_rms

from ..inputs.track import FloatArray
from .settings import LOW_RATE


@dataclass(frozen=True)
class Fitted:
    """A model fitted to a motion, and what it leaves where it was not.

    Attributes:
        model: Fitted to all of it.
        folds: Fitted to all but each fold.
        left: Torque that the folds' models leave on their own blocks, one part after the other; NaN where the joint
            does not move [N·m]. Shape (n,).
        held: Names of the law, dotted, or of the dynamics, that stayed as they were.
    """

    model: FrictionModel
    folds: tuple[FrictionModel, ...]
    left: FloatArray
    held: tuple[str, ...] = ()

    @property
    def rms(self) -> float:
        """Held-out error [N·m]."""
        return float(np.sqrt(np.nanmean(self.left**2)))

    def deviation(self, name: str) -> float:
        """Standard deviation of a number of the law or the dynamics, from the folds."""
        values = [read_number(one, name) for one in self.folds]
        return float(np.sqrt((len(values) - 1.0) * np.var(values)))


def read_number(model: FrictionModel, name: str) -> float:
    """A number of the law, dotted, or of the dynamics."""
    parameters = model.law.parameters()
    return parameters[name] if name in parameters else float(getattr(model.dynamics, name))


def fit_held_out(model: FrictionModel, motion: RecordedMotion, held: tuple[str, ...] = ()) -> Fitted:
    """Fit the numbers of a model to a motion, and to all of it but each fold.

    Args:
        model: To start from; with its dynamics.
        motion: What it is fitted to.
        held: Numbers that stay as they are.
    """
    found = refit_model(model, [motion], held=held)
    parts = [np.full(part.time.size, np.nan) for part in motion.parts]
    for one, spans in zip(found.folds, split_folds(motion), strict=True):
        for left, part, into in zip(compute_missing_torque(one, motion), motion.parts, parts, strict=True):
            for a, b in spans:
                rows = (part.time >= a) & (part.time < b) & part.moves
                into[rows] = left[rows]
    return Fitted(found.model, found.folds, np.concatenate(parts), held)


def compute_fall(before: Fitted, after: Fitted) -> tuple[float, float, tuple[float, float]]:
    """Part of the held-out energy that goes, part of the blocks where it falls, and 95 % of the fall of the error."""
    known = np.isfinite(before.left) & np.isfinite(after.left)
    energies = [
        np.array([float(one @ one) for one in np.array_split(each.left[known], LOW_RATE.blocks)])
        for each in (before, after)
    ]
    rng = np.random.default_rng(0)
    drawn = rng.integers(0, LOW_RATE.blocks, (LOW_RATE.resamples, LOW_RATE.blocks))
    sums = [np.maximum(energy[drawn].sum(axis=1), 1e-300) for energy in energies]
    low, high = np.quantile(1.0 - np.sqrt(sums[1] / sums[0]), [0.025, 0.975])
    fall = 1.0 - float(energies[1].sum()) / max(float(energies[0].sum()), 1e-300)
    return fall, float(np.mean(energies[1] < energies[0])), (float(low), float(high))


def is_better(before: Fitted, after: Fitted, matters: float) -> bool:
    """Whether the error on data left out falls surely, nearly everywhere, and by a part of its energy that matters."""
    fall, agreed, ends = compute_fall(before, after)
    return fall >= matters and agreed >= LOW_RATE.agreeing and ends[0] > 0.0


def measure_level(fit: Fitted, motion: RecordedMotion) -> float:
    """Size of the sliding friction of a fit over the motion [N·m]."""
    speed = np.concatenate([part.smooth_velocity[part.moves] for part in motion.parts])
    return compute_rms(np.asarray(fit.model.torque(speed)))


def measure_acceleration(motion: RecordedMotion) -> float:
    """RMS where the joint moves [rad/s²] or [m/s²]."""
    return compute_rms(np.concatenate([part.acceleration[part.moves] for part in motion.parts]))
