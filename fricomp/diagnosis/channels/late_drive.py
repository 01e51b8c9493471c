"""A drive that gives its torque later than it is asked: seen from the command and the measured torque alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..effects import EFFECTS
from ..record.result import NamedEffect, Quantity
from ..samples.drive_path import DrivePath, find_drive_path
from ..samples.settings import LOOK
from .settings import CHANNELS

_OTHER = {"drive_lag": "torque_delay", "torque_delay": "drive_lag"}
_NUMBER = {"drive_lag": "time_constant", "torque_delay": "delay"}


def find_late_drive(recordings: Sequence[Recording]) -> NamedEffect | None:
    """The delay or lag between command and torque; None where one of the recordings shows none beyond the usual."""
    paths = [find_drive_path(one) if one.torque_command is not None else None for one in recordings]
    found = [one for one in paths if one is not None]
    if not found or len(found) < len(paths):
        return None
    if not all(_is_late(path, one) for path, one in zip(found, recordings, strict=True)):
        return None
    name = max({one.name for one in found}, key=[one.name for one in found].count)
    unit = recordings[0].metadata.torque_unit
    before, after = (compute_rms(np.concatenate([getattr(one, side) for one in found])) for side in ("before", "after"))
    return NamedEffect(
        name=name,
        kind="measurement",
        parameters={_NUMBER[name]: _average(found)},
        indistinguishable_from=(_OTHER[name],) if any(_is_alike(one) for one in found) else (),
        equation=EFFECTS[name].equation,
        sentence=(
            "the drive gives its torque later than it is asked, as the command and the measured torque show of each "
            f"other; by it the command misses {after:.3g} {unit} of the torque on data left out, and "
            f"{before:.3g} {unit} without"
        ),
        citation=EFFECTS[name].citation,
    )


def _is_late(path: DrivePath, recording: Recording) -> bool:
    """Whether it is later than drives usually are, and explains most of what any linear drive could."""
    usual = max(CHANNELS.usual_delay, CHANNELS.usual_periods * recording.sample_period)
    least = min(path.errors["history"], path.errors[path.name]) ** 2
    could, does = path.errors["law"] ** 2 - least, path.errors["law"] ** 2 - path.errors[path.name] ** 2
    return path.value - 1.96 * path.deviation > usual and does >= CHANNELS.covered * could


def _is_alike(path: DrivePath) -> bool:
    return path.errors[_OTHER[path.name]] < LOOK.alike * path.errors[path.name]


def _average(paths: Sequence[DrivePath]) -> Quantity:
    """The mean of all recordings; its interval holds how they differ."""
    values, own = np.array([one.value for one in paths]), np.array([one.deviation for one in paths])
    mean = float(values.mean())
    half = 1.96 * float(np.hypot(np.sqrt(np.mean(own**2) / own.size), np.std(values) / np.sqrt(values.size)))
    return Quantity(mean, "s", (max(mean - half, 0.0), mean + half))
