"""Numbers that decide in this stage, each with its reason and what moves with it."""

from __future__ import annotations

from dataclasses import dataclass

from ..inputs.settings import INPUT


@dataclass(frozen=True)
class LowRateSettings:
    """How recordings are diagnosed that are too slow for the rows of the residual."""

    longest_period: float = INPUT.longest_simulated
    """Sample period above which this stage takes over [s]. The rows of the residual see 42 ms: with fewer than three
    samples in them the simulated joint is interpolation."""
    slow_period: float = 0.025
    """Period [s] to which rows of faster recordings are averaged where only their slow motion is looked at."""
    matters: float = 0.05
    """Part of the held-out energy by which an effect has to lower the error. A smaller gain is no reason to change a
    simulation, and slight forms of friction that a Coulomb and viscous curve lacks give as much."""
    of_friction: float = 0.03
    """Torque of an effect, in that of the sliding friction, below which it is none: numbers of plain joints stray by as
    much, since the delay is known to a part of a sample alone."""
    drag_shown: float = 0.2
    """Part of a drag's torque that is left where viscous and Coulomb friction are refitted, on a typical motion."""
    agreeing: float = 0.75
    """Part of the blocks of time in which the error has to fall; by chance it is a half."""
    search_matters: float = 0.08
    """Part of the held-out energy that a ripple or a stop has to take: it is the best of many orders or edges."""
    alike: float = 0.1
    """Part by which an effect of fewer numbers may leave more than another and is named in its place, both being said:
    what folds differ by."""
    orders_of_range: float = 1.5
    """Waves in the range of the position, more than gravity has there, from which on a wave is a ripple and neither
    gravity nor a spring."""
    levels_of_range: float = 1.0
    """The same for a level of friction that waves: nothing of the plain joint does."""
    rises: float = 1.3
    """Friction from rest over the Coulomb torque where the fit of a falling curve starts; it leads away from there."""
    falls_by: float = 0.05
    """Part of the top speed over which it falls there; the fit tries others."""
    stop_edges: tuple[float, ...] = (0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.94, 0.97, 0.99)
    """Quantiles of the position at which a stop is tried, from either end."""
    repeated: float = 0.15
    """Part of the rows in motion that repeat the position of the one before, above which its readings come more slowly
    than the rows: what they are late by looks like physics, and nothing is named."""
    neighbours: int = 4
    """Rows to both sides over which a joint has to move, for a row between to be in motion."""
    order_steps: float = 0.25
    """Step of the orders that are tried, in waves over the range."""
    most_orders: int = 4000
    """Orders that are tried at most."""
    of_band: float = 0.8
    """Part of the band in which the waves of a ripple have to pass at the usual speed."""
    load_matters: float = 0.1
    """Deviation of the size of gravity over the sliding friction, from which on friction that grows with it is tried: a
    coefficient of 0.3, the largest that is usual, then makes as much as an effect has to."""
    usual_delays: tuple[float, ...] = (-0.5, -0.25, 0.0, 0.25, 0.5)
    """Delays of the torque that no log tells from none, in sample periods: a command is held for a sample, a reading is
    of some instant in it. The best is the plain joint's."""
    delays: tuple[float, ...] = (-2.0, -1.5, -1.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0)
    """Delays that are tried beside it, in sample periods."""
    delay_steps: tuple[float, ...] = (0.125, 0.0625)
    """Steps by which the best of them is looked for in the end, in sample periods."""
    noise_ratio: float = 1.5
    """What is left over the noise floor, from which on something is missing."""
    unexplained: float = 0.1
    """Part of the torque's deviation that has to be left besides, for something to be missing: at these rates the noise
    of a torque is told from few samples."""
    draws: int = 20
    """Draws of noise that its size in the band is the mean of."""
    certain: float = 2.3
    """Half a 95 % interval in standard deviations from the folds, of which there are few."""
    form: float = 0.02
    """Relative deviation of a number beside that from the folds: what a delay that is known to a part of a sample, and
    the straight lines between samples, leave in it. On simulated joints numbers strayed by up to 3 %."""
    order_known: float = 0.02
    """The same of an order, in waves over the range of the position."""
    blocks: int = 20
    """Blocks of time whose errors are drawn for the interval of the gain."""
    resamples: int = 400
    """Draws of these blocks."""
    matters_given: float = 0.1
    """Part by which inertia or gravity have to differ from the simulation's, to be told."""


LOW_RATE = LowRateSettings()
