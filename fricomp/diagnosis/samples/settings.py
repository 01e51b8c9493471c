"""Every number by which something is found in the samples, with its reason and what moves with it.

Where nothing else is said a number was chosen on development cases, of which few show such effects: public recordings
of a geared arm, a bare motor, a series-elastic drive and a band brake, and made ones with nothing to find.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LookSettings:
    """When the samples are looked at, and how a finding is told.

    Attributes:
        covered: Part of the held-out energy from which what the search named stands.
        no_motion_law: Held-out error of the base, over the standard deviation of the torque, from which a joint obeys
            no law of its own motion: half of it is then unknown.
        softer: Travel of a bristle, in that of the one found where only the base acts, from which it is another one.
        bases: Recordings of the base alone that a ripple must exceed. Each is drawn with a noise of its own.
        alike: Ratio of held-out errors up to which a lag and a delay are not told apart.
        bootstraps: Draws for the interval of the reduction.
        blocks: Blocks that are drawn from.
        repetitions: Draws of blocks on which a finding must come again.
        further_orders: Further orders of a ripple that are told.
    """

    covered: float = 0.7
    no_motion_law: float = 0.5
    softer: float = 3.0
    bases: int = 3
    alike: float = 1.15
    bootstraps: int = 400
    blocks: int = 40
    repetitions: int = 60
    further_orders: int = 5


@dataclass(frozen=True)
class DriveSettings:
    """How a late drive is looked for.

    Attributes:
        longest: Longest delay or time constant that is tried [s]: a drive that is later can hardly be controlled.
        least_periods: The same in sample periods at least, for slow recordings.
        steps: Values that are tried, evenly spaced.
        folds: Blocks that are left out in turn, and for the deviation.
        fewest: Samples of a block at least.
        taps: Samples of the command's history that stand for the best any linear drive could do.
        least_fall: Part of the held-out error that must go.
        explained: Part of the torque's variance that the law must explain at all: else the command is another signal.
    """

    longest: float = 0.03
    least_periods: float = 4.0
    steps: int = 25
    folds: int = 10
    fewest: int = 40
    taps: int = 16
    least_fall: float = 0.1
    explained: float = 0.3


@dataclass(frozen=True)
class RippleSettings:
    """How a ripple over position is looked for that is finer than the rows.

    Attributes:
        least_fall: Part of the held-out energy that its waves must take, and what they leave of it beside a recording
            of the base alone. A smaller value finds ripples in what the plain base of the samples cannot draw.
        windows: Samples of the derivative filters of which the best one is taken.
        cubic: Samples of a filter from which on it fits cubics; below them it fits parabolas.
        shortest: Samples of a recording, over those of a filter, below which it is not tried.
        fewest: Samples that slide without which nothing is looked for.
        fewest_orders: Orders without which nothing is looked for.
        most_samples: Samples that are fitted; of more some are drawn, for the time that it takes.
        most_orders: Orders that are looked at, for the same reason.
        most_harmonics: Waves that are taken out at most.
        folds: Blocks that are left out in turn.
        at_once: Orders of a row of the spectrum, which is computed as a product of two small tables.
        slowest: Part of the top speed below which samples are left out: friction is not level there.
        top: Quantile of the speed that counts as the top speed.
        stribeck: Stribeck velocities of the plain base, over the top speed: two of them draw any usual curve.
        worth: Part of the held-out energy that one more wave must take.
        waves: Waves over the travel at least: fewer are a shape, not a ripple.
        finest: Highest order that is looked at, over that which neighbouring samples can show at all.
        sure: Standard deviations that the amplitude of the strongest wave must be.
        exact: Standard deviations that its order must be.
        preferred: Energy by which a ripple of the friction level must beat one of the torque, which is simpler.
        zoom: Orders about a peak among which the best one is taken.
        gap: Least and largest number of samples about a left-out block that nobody uses.
        samples_of_gap: Samples of the recording for each one of such a gap, between those.
        rank: Singular value, over the largest, below which a combination of columns is not fitted.
    """

    least_fall: float = 0.3
    windows: tuple[int, ...] = (5, 9, 15, 31)
    cubic: int = 7
    shortest: int = 20
    fewest: int = 400
    fewest_orders: int = 20
    most_samples: int = 12_000
    most_orders: int = 1600
    most_harmonics: int = 12
    folds: int = 10
    at_once: int = 40
    slowest: float = 0.1
    top: float = 0.95
    stribeck: tuple[float, ...] = (0.05, 0.2)
    worth: float = 0.01
    waves: float = 8.0
    finest: float = 0.8
    sure: float = 4.0
    exact: float = 10.0
    preferred: float = 1.5
    zoom: int = 81
    gap: tuple[int, int] = (5, 32)
    samples_of_gap: int = 100
    rank: float = 1e-6


@dataclass(frozen=True)
class PreslidingSettings:
    """How presliding is looked for that fills much of the motion.

    Attributes:
        distances: Breakaway distances that are tried first, evenly spaced in their logarithm.
        finer: Distances that are tried between the neighbours of the best one.
        stiff: Distance [rad] up to which the base model has its own bristle.
        stiff_share: The same over the travel, for linear joints.
        stiff_steps: The same in steps of the encoder, where that is coarse.
        softest: Longest distance that is tried, over the travel: a longer one is a spring.
        range: Least ratio of the longest distance to the stiff one: with less there is nothing between them.
        firm: Shortest distance of a bristle of the base, over the stiff one.
        firm_distances: Distances of the base's bristle that are tried.
        most_samples: Samples that are fitted, for the time that it takes.
        least_fall: Part of the held-out error of the best explanation without memory that must go. A smaller value
            finds presliding where friction over speed has another form.
        covered: Part of the energy that the bristle must explain of what it explains with everything without memory.
        won: Part of the left-out blocks on which the error must fall so: one that no law reaches says nothing about the
            others.
        knots: Knots of the curves over speed and position that stand for everything without memory.
        folds: Blocks that are left out in turn.
        top: Quantile of the speed that counts as the top speed.
        stribeck: Stribeck velocities of the bristle's friction, over the top speed.
        rank: Singular value, over the largest, below which a combination of columns is not fitted.
    """

    distances: int = 14
    finer: int = 7
    stiff: float = 4e-4
    stiff_share: float = 1e-3
    stiff_steps: float = 2.0
    softest: float = 0.5
    range: float = 4.0
    firm: float = 0.1
    firm_distances: int = 4
    most_samples: int = 4000
    least_fall: float = 0.3
    covered: float = 0.85
    won: float = 0.8
    knots: int = 12
    folds: int = 10
    top: float = 0.95
    stribeck: tuple[float, ...] = (0.05, 0.2)
    rank: float = 1e-9


DRIVE = DriveSettings()
LOOK = LookSettings()
PRESLIDING = PreslidingSettings()
RIPPLE = RippleSettings()
