"""A motion from a file: any velocity over time, recorded the same way as a sweep."""

import os
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import AdapterError, ParameterError
from fricomp.laws import FloatArray

from .analysis.block import BlockLabel
from .motion.context import HOST_RATE, SweepContext, loop_period
from .motion.log import CycleLog
from .motion.motion import MotionRunner
from .planning.plan import Travel, move_speed
from .sweep import Sweep

__all__ = ["MotionFile", "at_rows_rate", "fit_into", "read_motion", "record_motion", "travel_now"]

# Samples below which a motion, or what is left of one, says nothing.
SHORTEST = 2
# How far velocity and position of a file may part: of the way that it spans [1], and by their digits [rad] or [m].
AGREEMENT = 0.05
ROUNDING = 1e-6
# Ways to the start: the second makes up for what a velocity loop leaves of the first, 1.6 mrad on the simulated joint.
APPROACHES = 2


@dataclass(frozen=True, eq=False)
class MotionFile:
    """A velocity over time, and where it starts.

    Attributes:
        time: From zero [s]. Shape (n,).
        velocity: Straight between the rows [rad/s] or [m/s]. Shape (n,).
        start: Position at its beginning [rad] or [m]; None where the file does not say.
    """

    time: FloatArray
    velocity: FloatArray
    start: float | None = None

    @property
    def reach(self) -> tuple[float, float]:
        """Lowest and highest position, from where it starts [rad] or [m]."""
        way = self.way()
        return float(way.min()), float(way.max())

    def way(self) -> FloatArray:
        """Distance from where it starts [rad] or [m]. Shape (n,)."""
        steps = 0.5 * (self.velocity[1:] + self.velocity[:-1]) * np.diff(self.time)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def velocity_at(self, time: float) -> float | None:
        """Velocity [rad/s] or [m/s]; None past the end."""
        return None if time > self.time[-1] else float(np.interp(time, self.time, self.velocity))


def read_motion(path: str | os.PathLike[str]) -> MotionFile:
    """Read a CSV file with the columns `time` [s], `velocity` [rad/s] or [m/s] and, where its place counts, `position`.

    A column may also be called as a reference (`velocity_reference`, `position_reference`).

    Raises:
        ParameterError: The file is missing, lacks a column, time does not rise, or position and velocity disagree.
    """
    name = os.fspath(path)
    try:
        table: Any = np.genfromtxt(Path(path), delimiter=",", names=True, dtype=np.float64, encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise ParameterError(f"cannot read the motion {name}: {error}") from error
    columns = {column: _read_column(table, column) for column in ("time", "velocity", "position")}
    time, velocity, position = columns.values()
    if time is None or velocity is None or table.size < SHORTEST:
        missing = [column for column in ("time", "velocity") if columns[column] is None]
        raise ParameterError(
            f"the motion {name} needs a header `time,velocity` or `time,velocity,position`, commas between columns, "
            f"decimal points, and at least two rows; {missing[0] if missing else 'rows'} missing"
        )
    finite = all(np.all(np.isfinite(values)) for values in columns.values() if values is not None)
    if not (finite and np.all(np.diff(time) > 0.0)):
        raise ParameterError(f"the motion {name} needs finite numbers and rising time")
    motion = MotionFile(time - time[0], velocity, None if position is None else float(position[0]))
    if position is not None:
        _refuse_disagreement(motion, position, name)
    return motion


def _read_column(table: Any, name: str) -> FloatArray | None:
    """A column of a table, perhaps under its name as a reference; None where there is none."""
    found = next((n for n in (name, f"{name}_reference") if n in (table.dtype.names or ())), None)
    return None if found is None else table[found]


def _refuse_disagreement(motion: MotionFile, position: FloatArray, name: str) -> None:
    """The velocity is what is followed: it must lead along the positions, or the joint would be somewhere else."""
    apart = np.abs(position - position[0] - motion.way())
    worst = int(np.argmax(apart))
    if apart[worst] > AGREEMENT * float(np.ptp(position)) + ROUNDING:
        raise ParameterError(
            f"the velocity of the motion {name} does not lead along its positions: {apart[worst]:.3g} apart after "
            f"{motion.time[worst]:.4g} s; put right one of them, or leave out the column position"
        )


def travel_now(context: SweepContext) -> Travel:
    """Where the joint may move; of one that turns freely, about where it is now, read without energising it.

    Raises:
        AdapterError: The drive reports no position.
    """
    if not context.metadata().continuous:
        return context.travel()
    mode = context.choose_mode()
    runner = MotionRunner(context.adapter, context.joint, loop_period(context.adapter, context.settings, mode))
    context.adapter.configure(mode, runner.period)
    runner.await_feedback()
    return context.travel(runner.position)


def at_rows_rate(context: SweepContext, motion: MotionFile) -> SweepContext:
    """With the loop as fast as the rows of the file, where bus and host can: recordings of one rate go together.

    A multiple of the usual rate, which the drive is known to take; a file of a few rows leaves it as it is.
    """
    usual = 1.0 / loop_period(context.adapter, context.settings, context.choose_mode())
    rows = 1.0 / float(np.median(np.diff(motion.time)))
    times = max(1, round(min(rows, HOST_RATE) / usual))
    return replace(context, settings=replace(context.settings, rate=times * usual))


def fit_into(motion: MotionFile, travel: Travel) -> float:
    """Where the motion has to start: as its file says, or such that it stays in the middle of the travel [rad] or [m].

    Raises:
        ParameterError: It does not fit, or is too fast.
    """
    low, high = motion.reach
    if high - low > travel.length:
        raise ParameterError(f"the motion spans {high - low:.3g}, the travel is {travel.length:.3g}: make it shorter")
    fastest = float(np.max(np.abs(motion.velocity)))
    if fastest > travel.speed_limit:
        raise ParameterError(f"the motion reaches {fastest:.3g}, the limit is {travel.speed_limit:.3g}: make it slower")
    if motion.start is None:
        return travel.middle - 0.5 * (low + high)
    _refuse_outside(motion.start + low, motion.start + high, travel)
    return motion.start


def _refuse_outside(low: float, high: float, travel: Travel) -> None:
    """A motion is not moved to where it fits without being told: what depends on the position would not be there."""
    below, above = travel.low - low, high - travel.high
    if max(below, above) > 0.0:
        beyond, end = (below, "below") if below > above else (above, "above")
        raise ParameterError(
            f"the motion goes from {low:.4g} to {high:.4g}, by its column position; the travel is {travel.low:.4g} to "
            f"{travel.high:.4g}, so that it ends {beyond:.3g} {end} it: change the limits or the motion, or leave out "
            "that column to record it in the middle of the travel"
        )


def record_motion(sweep: Sweep, motion: MotionFile) -> float:
    """Carry out a motion with a prepared sweep and write it as one block; of one that is stopped, what there is of it.

    Nothing but the loop keeps it in its place, and a drive's velocity loop may drift: hence the distance.

    Returns:
        Largest distance of the joint from where the motion should have been [rad] or [m].

    Raises:
        ParameterError: It does not fit into the travel.
        SweepAborted: The safety gate has tripped.
    """
    start, runner = fit_into(motion, sweep.travel), sweep.runner
    for _ in range(APPROACHES):
        runner.move_to(start, move_speed(sweep.travel), sweep.context.settings.ramp)
    log = CycleLog(runner.joint)
    try:
        runner.follow(motion.velocity_at, log)
    except BaseException:
        _keep(sweep, log)
        raise
    samples = sweep.write(log, BlockLabel("motion", 0))
    planned = start + np.interp(samples.time - samples.time[0], motion.time, motion.way())
    return float(np.max(np.abs(samples.position - planned)))


def _keep(sweep: Sweep, log: CycleLog) -> None:
    """Write what a stopped motion has left, at zero torque: waiting for a disk is nothing to do in motion."""
    with suppress(AdapterError):  # of a lost drive; the error that has stopped the motion goes on anyway
        sweep.context.adapter.safe_stop("the motion was stopped")
    if len(log) >= SHORTEST:
        sweep.write(log, BlockLabel("motion", 0, is_cut=True))
