"""Errors on held-out data: each block of time by the model that was fitted to the others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from .equation import Along
from .errors import (
    Simulate,
    compare_positions,
    compare_torque,
    measure_torque,
    summarise_positions,
    summarise_torque,
)
from .evaluated import EvaluatedJoint
from .motion import RecordedMotion, low_pass
from .reading import build_evaluated
from .refit import split_folds
from .result import Evaluation, TorqueError
from .settings import EVALUATION

Index = NDArray[np.intp]


def evaluate_folds(name: str, models: Sequence[FrictionModel], motion: RecordedMotion) -> Evaluation:
    """Measure the errors of models on the times of their folds, pooled.

    Args:
        name: What they are called together.
        models: One a fold, in the order of `split_folds`, fitted to the other folds.
        motion: The recording.

    Raises:
        RecordingError: The joint hardly moves.
    """
    torque = []
    found: dict[float, list[tuple[FloatArray, FloatArray]]] = {}
    for model, spans in zip(models, split_folds(motion), strict=True):
        joint = build_evaluated(model, name)
        along = [joint.follow(part, motion.rest_speed) for part in motion.parts]
        recorded = [joint.align_torque(part) for part in motion.parts]
        torque.append(compare_torque(motion, recorded, [one.torque for one in along], spans))
        simulate = _build_simulation(joint, motion, along)
        pairs = compare_positions(motion, simulate, spans, max(EVALUATION.starts // len(models), 1))
        for horizon, each in pairs.items():
            found.setdefault(horizon, []).extend(each)
    return Evaluation(name, summarise_torque(motion, torque), summarise_positions(motion, found))


def _build_simulation(joint: EvaluatedJoint, motion: RecordedMotion, along: Sequence[Along]) -> Simulate:
    def simulate(number: int, starts: Index, lengths: Sequence[int]) -> FloatArray:
        return joint.simulate(motion.parts[number], along[number], starts, lengths)

    return simulate


def measure_torque_error(model: FrictionModel, motion: RecordedMotion) -> TorqueError:
    """The torque error of a model over a motion that was read already.

    Raises:
        RecordingError: The joint hardly moves.
    """
    joint = build_evaluated(model, "the model")
    along = [joint.follow(part, motion.rest_speed).torque for part in motion.parts]
    return measure_torque(motion, [joint.align_torque(part) for part in motion.parts], along)


def compute_missing_torque(model: FrictionModel, motion: RecordedMotion) -> list[FloatArray]:
    """Recorded torque less that of the model in the band, at all samples of each part; each of shape (n,)."""
    joint = build_evaluated(model, "the model")
    return [
        low_pass(joint.align_torque(part) - joint.follow(part, motion.rest_speed).torque, motion.band, part.dt)
        for part in motion.parts
    ]
