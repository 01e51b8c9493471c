"""Errors of the files that a diagnosis writes, in the units of the recording."""

from __future__ import annotations

import msgspec

from fricomp.evaluation.result import PositionError, TorqueError


class ModelErrors(msgspec.Struct, frozen=True, kw_only=True):
    """Errors of one model.

    Attributes:
        torque: Along the recorded motion.
        position: Of open-loop simulations, by their length.
    """

    torque: TorqueError
    position: tuple[PositionError, ...] = ()


class FileErrors(msgspec.Struct, frozen=True, kw_only=True):
    """Errors on held-out data, each block of time by a model fitted to the others, and of the file itself.

    Attributes:
        before: Of the base model, held out.
        after: Of the model with what was named, held out; None where no law holds it.
        file: Of `friction.json` as it was written, over all recordings; torque alone.
        folds: Parts of the data that were left out in turn, of which `held_out.json` has the models and times; 1 where
            one part was left out and the rest was not, as of the joints of an arm.
        missing: Effects that were named and that no term of the file holds.
    """

    before: ModelErrors
    after: ModelErrors | None
    file: ModelErrors
    folds: int
    missing: tuple[str, ...] = ()

    @property
    def gets_worse(self) -> bool:
        """Whether the torque error does not fall with what was named."""
        return self.after is not None and self.after.torque.rms >= self.before.torque.rms

    def compare(self) -> float:
        """Held-out torque error with what was named, over that without; 1 where no law holds it."""
        return 1.0 if self.after is None else self.after.torque.rms / max(self.before.torque.rms, 1e-30)

    @property
    def written(self) -> ModelErrors:
        """Held-out errors of the model that was written."""
        return self.before if self.after is None else self.after
