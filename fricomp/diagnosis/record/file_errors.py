"""Errors of the files that a diagnosis writes, in the units of the recording."""

from __future__ import annotations

import msgspec

__all__ = ["FileErrors", "ModelErrors", "PositionFigures", "TorqueFigures"]

Interval = tuple[float, float]


class TorqueFigures(msgspec.Struct, frozen=True, kw_only=True):
    """Recorded torque less that of a model along the recorded motion, where the joint moves.

    Attributes:
        rms: Root mean square.
        ci95_rms: Its 95 % interval over blocks of time.
        median: Median of its size.
        recorded: Root mean square of the recorded torque about its mean, over the same samples.
        unit: Unit of these.
        band: Both torques pass the same low-pass up to here [Hz].
        duration: Time in motion [s].
    """

    rms: float
    ci95_rms: Interval
    median: float
    recorded: float
    unit: str
    band: float
    duration: float


class PositionFigures(msgspec.Struct, frozen=True, kw_only=True):
    """Position of open-loop simulations under the recorded torque, from measured states, less the recorded one.

    Attributes:
        after: Time from the start [s].
        median: Median of its size over the starts.
        ci95_median: Its 95 % interval over blocks of starts.
        rms: Root mean square over the starts.
        travel: Median of the way that the joint itself went.
        starts: Number of starts.
        unit: Unit of these.
    """

    after: float
    median: float
    ci95_median: Interval
    rms: float
    travel: float
    starts: int
    unit: str


class ModelErrors(msgspec.Struct, frozen=True, kw_only=True):
    """Errors of one model.

    Attributes:
        torque: Along the recorded motion.
        position: Of open-loop simulations, by their length.
    """

    torque: TorqueFigures
    position: tuple[PositionFigures, ...] = ()


class FileErrors(msgspec.Struct, frozen=True, kw_only=True):
    """Errors on held-out data, each block of time by a model fitted to the others, and of the file itself.

    Attributes:
        before: Of the base model, held out.
        after: Of the model with what was named, held out; None where no law holds it.
        file: Of `friction.json` as it was written, over all recordings; torque alone.
        folds: Parts of the data that were left out in turn; `held_out.json` has the models and times of each.
        missing: Effects that were named and that no term of the file holds.
    """

    before: ModelErrors
    after: ModelErrors | None
    file: ModelErrors
    folds: int
    missing: tuple[str, ...] = ()

    @property
    def written(self) -> ModelErrors:
        """Held-out errors of the model that was written."""
        return self.before if self.after is None else self.after
