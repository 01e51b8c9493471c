"""A motion from a file: any velocity over time, recorded the same way as a sweep."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import AdapterError, ParameterError
from fricomp.laws import FloatArray

from .block import BlockLabel
from .log import CycleLog
from .plan import Travel, move_speed
from .sweep import Sweep

__all__ = ["MotionFile", "fit_into", "read_motion", "record_motion"]

# Samples below which a stopped motion says nothing.
SHORTEST = 2


@dataclass(frozen=True, eq=False)
class MotionFile:
    """A velocity over time.

    Attributes:
        time: From zero [s]. Shape (n,).
        velocity: Straight between the rows [rad/s] or [m/s]. Shape (n,).
    """

    time: FloatArray
    velocity: FloatArray

    @property
    def reach(self) -> tuple[float, float]:
        """Lowest and highest position, from where it starts [rad] or [m]."""
        steps = 0.5 * (self.velocity[1:] + self.velocity[:-1]) * np.diff(self.time)
        position = np.concatenate([[0.0], np.cumsum(steps)])
        return float(position.min()), float(position.max())

    def velocity_at(self, time: float) -> float | None:
        """Velocity [rad/s] or [m/s]; None past the end."""
        return None if time > self.time[-1] else float(np.interp(time, self.time, self.velocity))


def read_motion(path: str | os.PathLike[str]) -> MotionFile:
    """Read a CSV file with the columns `time` [s] and `velocity` [rad/s] or [m/s].

    Raises:
        ParameterError: The file is missing, lacks a column, or time does not rise.
    """
    try:
        table: Any = np.genfromtxt(Path(path), delimiter=",", names=True, dtype=np.float64, encoding="utf-8")
    except (OSError, ValueError) as error:
        raise ParameterError(f"cannot read the motion {os.fspath(path)}: {error}") from error
    missing = [name for name in ("time", "velocity") if name not in (table.dtype.names or ())]
    if missing or table.size < 2:
        raise ParameterError(
            f"the motion {os.fspath(path)} needs a header `time,velocity` and at least two rows; "
            f"{missing[0] if missing else 'rows'} missing"
        )
    time, velocity = table["time"], table["velocity"]
    if not (np.all(np.isfinite(time)) and np.all(np.isfinite(velocity)) and np.all(np.diff(time) > 0.0)):
        raise ParameterError(f"the motion {os.fspath(path)} needs finite numbers and rising time")
    return MotionFile(time - time[0], velocity)


def fit_into(motion: MotionFile, travel: Travel) -> float:
    """Where the motion has to start so that it stays in the middle of the travel [rad] or [m].

    Raises:
        ParameterError: It does not fit, or is too fast.
    """
    low, high = motion.reach
    if high - low > travel.length:
        raise ParameterError(f"the motion spans {high - low:.3g}, the travel is {travel.length:.3g}: make it shorter")
    fastest = float(np.max(np.abs(motion.velocity)))
    if fastest > travel.speed_limit:
        raise ParameterError(f"the motion reaches {fastest:.3g}, the limit is {travel.speed_limit:.3g}: make it slower")
    return travel.middle - 0.5 * (low + high)


def record_motion(sweep: Sweep, motion: MotionFile) -> None:
    """Carry out a motion with a prepared sweep and write it as one block; of one that is stopped, what there is of it.

    Raises:
        ParameterError: It does not fit into the travel.
        SweepAborted: The safety gate has tripped.
    """
    start, runner = fit_into(motion, sweep.travel), sweep.runner
    runner.move_to(start, move_speed(sweep.travel), sweep.context.settings.ramp)
    log = CycleLog(runner.joint)
    try:
        runner.follow(motion.velocity_at, log)
    except BaseException:
        _keep(sweep, log)
        raise
    sweep.write(log, BlockLabel("motion", 0))


def _keep(sweep: Sweep, log: CycleLog) -> None:
    """Write what a stopped motion has left, at zero torque: waiting for a disk is nothing to do in motion."""
    with suppress(AdapterError):  # of a lost drive; the error that has stopped the motion goes on anyway
        sweep.context.adapter.safe_stop("the motion was stopped")
    if len(log) >= SHORTEST:
        sweep.write(log, BlockLabel("motion", 0, is_cut=True))
