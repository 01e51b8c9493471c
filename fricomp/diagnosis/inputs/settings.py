"""Numbers that decide in this stage, each with its reason and what moves with it."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np


@dataclass(frozen=True)
class InputSettings:
    """What is read out of recordings and simulations before anything is fitted."""

    loop_explains: float = 0.9
    """Part of the torque's variance that a loop must explain, on blocks left out. A lower one takes other loops for
    a PID."""
    gain_worth: float = 0.1
    """Part of the unexplained variance that one more gain must take."""
    velocity_cutoffs: tuple[float | None, ...] = (None, 15.0, 30.0, 60.0, 120.0)
    """Cut-off frequencies of the velocity filter that are tried [Hz]; None for no filter."""
    loop_folds: int = 5
    """Number of blocks that are left out in turn."""
    loop_samples: int = 40_000
    """Most samples for the estimate of a loop; more take time and change no gain."""
    told_window: float = 0.02
    """Window over which told and recorded torque are averaged [s]. Neither a delay nor the encoder's steps are a
    wrong gain."""
    least_noise: float = 1e-3
    """Noise of a torque without visible noise, in its own deviation."""
    rounding: float = 1.0 / sqrt(12.0)
    """Standard deviation of a rounded value, in steps: that of a uniform distribution."""
    exact_position: float = 1e-12
    """Least noise of a position: what its numbers are rounded to [rad] or [m]."""
    own_noise: float = 2.0
    """Rounding errors of the encoder from which a position has noise of its own."""
    velocity_window: float = 0.021
    """Longest Savitzky-Golay window that keeps the reversals of a joint [s]."""
    spike: float = 5.0
    """Noise deviations from the median of those about it beyond which a sample may be no measurement."""
    quickest_swing: float = 0.01
    """Shortest swing of a loop about a reversal [s]. Where three samples last longer, a peak of them may be one; a
    shorter one is a kick that a joint with a gap does not answer."""
    shortest_window: int = 7
    """Fewest samples of that window, for slow recordings."""
    unrest_window: float = 0.05
    """Window over which the jumps of a torque are looked at [s]; about a row."""
    unrest_quantile: float = 0.75
    """Quantile of these jumps: what a kick does not reach, and a torque in coarse steps does not hide."""
    usual_unrest: float = 2.0
    """Times the usual jumps up to which they are taken as usual: motion and chance make so much."""
    moving_share: float = 0.02
    """Part of the top speed above which a sample, or a window on the mean, moves."""
    mostly: float = 0.8
    """Part of the motion in which a torque is no more restless than usual. What lasts longer is its noise, and what
    nulls are matched to."""
    fewest_windows: int = 20
    """Fewest windows that show what is usual."""
    white_differences: float = 0.7
    """Variance by fifth over that by fourth differences below which these hold motion."""
    trimmed_normal: float = 0.935
    """Deviation of normal noise by its squares without their largest two per cent, over its own."""
    few_moving: float = 0.1
    """Part of moving samples below which resting ones are used as well."""
    late_left: float = 0.5
    """Part that a delay leaves of what a rigid joint misses of the torque, below which the search starts from that
    delay as well: no fit of small steps finds it, where the torque turns faster than it comes."""
    longest_simulated: float = 1.0 / 60.0
    """Sample period up to which recordings are searched by simulations [s]; slower ones by the torque in their band."""
    most_samples: int = 240_000
    """Samples of all recordings that are searched, on the grid of the simulations. Twice as many cost twice the time
    and memory, and narrow intervals by a third."""
    searched_whole: float = 1.25
    """Times as many up to which all of them are: a cut that leaves out little is not worth its words."""
    stretches: int = 12
    """Stretches of one long recording; the kernel runs sixteen joints a call."""
    shortest_stretch: float = 10.0
    """Length of a stretch [s] below which there are fewer of them: each loses half a second at both ends."""
    cell: float = 0.05
    """Time over which the choice of stretches averages the motion [s], about a row."""
    standing_out_share: float = 1.0 / 3.0
    """Part of the stretches that may be chosen since the torque stands out there. With more of them what is usual
    would be known less well."""
    stands_out: float = 2.0
    """Times the usual loudest second of a stretch from which it stands out. Chance and motion make up to half of it."""
    falling_shares: tuple[float, ...] = (0.02, 0.1, 0.4)
    """Parts of the top speed over which friction may fall, for the look at all stretches."""
    places: int = 10
    """Parts of the range of position that the stretches should reach."""
    speeds: tuple[float, ...] = (0.01, 0.05, 0.2, 0.5)
    """Parts of the top speed between which the stretches should have been."""
    past_cell: float = 1.0
    """Time over which the past of a stretch is averaged [s], the shortest time in which a joint warms."""
    student_tails: tuple[tuple[float, float, float], ...] = (
        (2.5, 0.613, 6.9),
        (3.0, 0.748, 5.8),
        (4.0, 0.855, 5.0),
        (5.0, 0.898, 4.6),
        (7.0, 0.937, 4.3),
        (np.inf, 1.0, 0.0),
    )
    """Student's noise: degrees of freedom, robust over true deviation of its second differences, and their 0.99
    quantile over their median (from four million draws each). The last one stands for normal noise."""
    back: float = 0.02
    """Part of the way that leads back, below which a motion goes one way, as in the checks of a recording."""


INPUT = InputSettings()
