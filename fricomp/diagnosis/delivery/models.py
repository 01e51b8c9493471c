"""The models that a diagnosis hands over, and what they are worth: the files are judged, not the search that led there.

All numbers of a model are fitted together once more, in the band in which its error is measured: what was found in
parts, such as a ripple in single samples, becomes one model by it. Numbers that were as good already stay.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fricomp.errors import ParameterError, RecordingError
from fricomp.evaluation import (
    Evaluation,
    RecordedMotion,
    compute_missing_torque,
    evaluate_folds,
    join_motions,
    measure_torque_error,
    read_motion,
    refit_model,
    split_folds,
)
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from ..record.file_errors import FileErrors, ModelErrors
from ..record.result import FileSeries
from .settings import DELIVERY
from .whole import look_over_whole

_GRAVITY = ("gravity_cosine", "gravity_sine")
_BASE, _NAMED = "the base model", "the model with what was named"


class GivenModel(NamedTuple):
    """The base with those parameters of a simulation that were found to be off.

    Attributes:
        model: Its start; all but what is held is refitted.
        held: Names of the numbers that are as given.
    """

    model: FrictionModel
    held: tuple[str, ...]


@dataclass(frozen=True)
class Delivery:
    """What is handed over.

    Attributes:
        base: Friction and rigid body of the refitted base.
        extended: The same with what was named; None where no law holds it.
        errors: Of both; None where the recording is too short for them.
        series: Torque that they leave, over time.
        folds: The models that the held-out errors are of: base, and extended where there is one, one a fold.
        times: Of each fold [s].
        motion: The recordings as the errors were measured on them.
        remarks: What the written model leaves of recordings that were searched in part, in sentences.
    """

    base: FrictionModel
    extended: FrictionModel | None
    errors: FileErrors | None = None
    series: tuple[FileSeries, ...] = ()
    folds: tuple[tuple[FrictionModel, ...], ...] = ()
    times: tuple[tuple[tuple[float, float], ...], ...] = ()
    motion: RecordedMotion | None = None
    remarks: tuple[str, ...] = ()


def deliver_models(
    recordings: Sequence[Recording],
    base: FrictionModel,
    extended: FrictionModel | None,
    missing: Sequence[str] = (),
    *,
    names: Sequence[str] = (),
    given: GivenModel | None = None,
    whole: Sequence[Recording] = (),
) -> Delivery:
    """Fit the models once more, and measure what they are worth.

    Args:
        recordings: Of the joint, on its own side.
        base: Refitted base, with its dynamics.
        extended: With what was named; None where no law holds it.
        missing: What was named and is in no law.
        names: Of the recordings.
        whole: All that is usable, where the recordings are stretches of longer ones.
        given: The base with what was found to be off as the simulation has it: the error before is then that of it;
            None where nothing was.
    """
    try:
        band = min(read_motion(one).band for one in recordings)
        each = [read_motion(one, band=band) for one in recordings]
        motion = join_motions(each)
        models = [_settle(one, motion) for one in (base, extended) if one is not None]
        if given is not None and extended is None:
            models.insert(0, _settle(given.model, motion, given.held))
        held = [evaluate_folds(name, one.folds, motion) for name, one in zip((_BASE, _NAMED), models, strict=False)]
        every = join_motions([read_motion(one, band=band) for one in whole]) if whole else motion
        error = measure_torque_error(models[-1].model, every)
        remarks = look_over_whole(models[-1].model, whole, recordings, band, complete=not missing)
    except (RecordingError, ParameterError, np.linalg.LinAlgError):
        return Delivery(base, extended)
    errors = FileErrors(
        before=_take_errors(held[0]),
        after=_take_errors(held[1]) if len(held) > 1 else None,
        file=ModelErrors(torque=error),
        folds=len(models[0].folds),
        missing=tuple(missing),
    )
    written = [one.model for one in models]
    called = names or [f"recording {k + 1}" for k in range(len(each))]
    series = tuple(one for name, part in zip(called, each, strict=False) for one in _list_series(name, written, part))
    return Delivery(
        written[0] if extended is not None else written[-1],
        written[-1] if extended is not None else None,
        errors,
        series,
        tuple(one.folds for one in models),
        split_folds(motion),
        motion,
        tuple(remarks),
    )


@dataclass(frozen=True)
class _Settled:
    model: FrictionModel
    folds: tuple[FrictionModel, ...]


def _settle(model: FrictionModel, motion: RecordedMotion, held: Sequence[str] = ()) -> _Settled:
    """The model refitted, or as it was where that is as good; with the fits to all but each fold."""
    held = (*_list_held(model), *held)
    refit = refit_model(model, [motion], held=(*held, *_GRAVITY))
    if model.motion == "rotary" and not set(_GRAVITY) <= set(held):
        free = refit_model(model, [motion], held=held, fold=False).model
        if not _is_as_good(refit.model, free, motion, DELIVERY.same_gravity):
            refit = refit_model(free, [motion], held=held)
    kept = _is_as_good(model, refit.model, motion, DELIVERY.as_good)
    return _Settled(model if kept else refit.model, refit.folds)


def _is_as_good(model: FrictionModel, refit: FrictionModel, motion: RecordedMotion, share: float) -> bool:
    """Whether the error of a model exceeds that of its refit by no more than this share."""
    before, after = (measure_torque_error(one, motion).rms for one in (model, refit))
    return before <= (1.0 + share) * after


def _list_held(model: FrictionModel) -> tuple[str, ...]:
    """Numbers that stay: a constant torque is in the curves of both directions, and plain curves fall as they do."""
    values = model.law.parameters()
    plain = [name for name, value in values.items() if name.endswith("stribeck_exponent") and value == 2.0]
    directions = any(name.startswith("forward.") for name in (one.partition(".")[2] for one in values))
    return (*plain, *(("offset",) if directions else ()))


def _take_errors(found: Evaluation) -> ModelErrors:
    return ModelErrors(torque=found.torque, position=found.position)


def _list_series(name: str, models: Sequence[FrictionModel], motion: RecordedMotion) -> list[FileSeries]:
    """What the base and the model that is written leave of the torque, at a few samples a period of the band."""
    left = [compute_missing_torque(model, motion) for model in models]
    stride = max(int(1.0 / (DELIVERY.drawn * motion.band * motion.dt)), 1)
    result = []
    for k, part in enumerate(motion.parts):
        rows = slice(None, None, stride)
        shown = [np.where(part.moves, one[k], np.nan)[rows] for one in left]
        result.append(FileSeries(name, part.time[rows], shown[0], shown[-1], motion.band))
    return result
