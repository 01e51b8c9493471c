"""Every number that decides what is read off two channels, with its reason and what moves with it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ChannelSettings:
    """When two channels show an effect.

    Attributes:
        usual_delay: Time [s] by which a torque may follow its command in any drive: a current loop and a cycle of its
            bus. Less is not told.
        usual_periods: The same in sample periods: which sample a torque belongs to is often not said.
        covered: Part of what any linear drive could explain of the torque that the delay or lag must explain.
        blocks: Stretches of a held output that are fitted each on its own, for the intervals.
        form: Relative standard deviation that the straight spring of such a fit leaves.
        gap: Part of the travel that a gap must be.
        loads: Range of a measured load, in its mean, from which it is not one load.
        load_window: Window over which torque and load are averaged [s]: a force sensor's noise is quicker, strokes of a
            bench are slower.
        load_speed: Part of the usual top speed from which a window slides.
        whole: Length of a window, in that of its rows, above which a gap lies in it.
        load_blocks: Stretches of a recording that are left out in turns.
        load_rows: Windows of each direction that are needed.
        load_sure: Standard deviations from nothing beyond which friction grows with the load.
        load_matters: Part by which the error on data left out has to fall.
        abrupt: Part of what a spring that stiffens evenly leaves, below which a gap must get: else it is such a spring.
    """

    usual_delay: float = 3e-3
    usual_periods: float = 1.5
    covered: float = 0.7
    blocks: int = 4
    form: float = 0.05
    gap: float = 0.05
    loads: float = 0.2
    load_window: float = 0.15
    load_speed: float = 0.1
    whole: float = 1.5
    load_blocks: int = 10
    load_rows: int = 30
    load_sure: float = 4.0
    load_matters: float = 0.1
    abrupt: float = 0.95


CHANNELS = ChannelSettings()
