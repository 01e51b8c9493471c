"""Errors on held-out data: each block of time by the model that was fitted to the others."""

from collections.abc import Sequence

from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from .errors import (
    Pairs,
    compare_positions,
    summarise_positions,
    summarise_torque,
)
from .evaluated import JointAlong
from .motion import RecordedMotion, low_pass
from .reading import build_evaluated
from .refit import split_folds
from .result import Evaluation, TorqueError
from .settings import EVALUATION


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
    found: Pairs = {}
    for model, spans in zip(models, split_folds(motion), strict=True):
        along = JointAlong(build_evaluated(model, name), motion)
        torque.append(along.compare_torque(spans))
        pairs = compare_positions(motion, along.simulate, spans, max(EVALUATION.starts // len(models), 1))
        for horizon, each in pairs.items():
            found.setdefault(horizon, []).extend(each)
    return Evaluation(name, summarise_torque(motion, torque), summarise_positions(motion, found))


def measure_torque_error(model: FrictionModel, motion: RecordedMotion) -> TorqueError:
    """The torque error of a model over a motion that was read already.

    Raises:
        RecordingError: The joint hardly moves.
    """
    along = JointAlong(build_evaluated(model, "the model"), motion)
    return summarise_torque(motion, [along.compare_torque()])


def compute_missing_torque(model: FrictionModel, motion: RecordedMotion) -> list[FloatArray]:
    """Recorded torque less that of the model in the band, at all samples of each part; each of shape (n,)."""
    along = JointAlong(build_evaluated(model, "the model"), motion)
    return [
        low_pass(recorded - torque, motion.band, part.dt)
        for part, recorded, torque in zip(motion.parts, along.recorded, along.torque, strict=True)
    ]
