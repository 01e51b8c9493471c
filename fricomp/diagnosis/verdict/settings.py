"""Every number that decides what the verdict says, with its reason and what moves with it."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class VerdictSettings:
    """How the search's answer and that of the samples are weighed and told.

    Attributes:
        other_order: Ratio of orders from which a ripple of the samples is another one than that of the rows. Chosen on
            development cases; a smaller value replaces a ripple by itself.
        larger: Ratio of amplitudes from which the finer ripple is the one to name. Chosen likewise.
        rivals: Explanations that are listed. More of them would hide the few that count.
        worse: Part by which the held-out error of the written model may rise with what is named: folds move that of an
            effect which matters little by some per cent.
        exponent: Stribeck exponent of the base: its friction falls as a Gaussian of the speed [armstrong1994survey].
    """

    other_order: float = 1.5
    larger: float = 2.0
    rivals: int = 12
    worse: float = 0.1
    exponent: float = 2.0


@dataclass(frozen=True)
class LateSettings:
    """When an answer with the torque moved to where it may act takes the place of one without.

    Attributes:
        fall: Part by which the held-out error must fall for a delay beside what is named.
        alike: Part by which it may rise where a delay takes fewer names, or is told as what a lag cannot be told from:
            what an effect of a fifth of the noise explains.
        explains: The same as `fall` where something stays unknown beside it, or more is named. A gap or a spring bends
            a joint like a delay, and a lag that was found names all that is missing.
    """

    fall: float = 0.1
    alike: float = 0.02
    explains: float = 0.5


@dataclass(frozen=True)
class ProbabilitySettings:
    """How the share of repetitions becomes a probability: at_none + (at_all - at_none) share^power.

    Of answers above a share of 0.9, 23 of 25 were right on 21 development cases (seeds from 7000) and 8 of 8 on six
    joints of the second generator; of those below 0.1, 1 of 42 and 0 of 8. Both ends are (right + 1) / (all + 2): an
    answer that has never failed in so few cases may still fail. Between them there were nine in all, 0.1 to 0.9, too
    few for anything but a line.

    Attributes:
        at_none: Probability of an answer that never comes again.
        at_all: Probability of an answer that always comes again.
        power: Exponent between the two.
    """

    at_none: float = 0.04
    at_all: float = 0.91
    power: float = 1.0


@dataclass(frozen=True)
class SharingSettings:
    """When a simulation has an effect in another size than the joint.

    Attributes:
        for_sure: Distance of two numbers, in both of their 95 % intervals together, from which they differ for sure.
        much: Distance over the larger of the two that it must be besides: no simulation is better than that.
    """

    for_sure: float = 2.0
    much: float = 0.1


@dataclass(frozen=True)
class ExperimentSettings:
    """The motions that are looked at, and when one is worth recording.

    Attributes:
        most_rivals: Explanations that a motion is to tell from the chosen one. Each costs a simulation of every motion
            with each of its parameters moved.
        duration: Of a motion [s]. A longer one tells more, and takes longer to record.
        fade: Time from rest and back to it [s]: a drive follows no step.
        enough: Gain that a rival must lack on a motion: it is printed while it lacks less than 12, and chance moves 30
            by 11.
        plenty: Factor on that, beyond which more is no better.
        fastest: Quantile of the recorded speed that a motion may reach: the very fastest samples may be noise.
        half_range: Part of the recorded range that a motion spans to either side of its middle; 0.5 would be all of it.
        held: Scale below which a parameter counts as not fitted.
        difference: Step of a parameter from its fit, over its scale, by which derivatives are taken.
        largest: Row, or its derivative, in noise deviations, beyond which nothing was simulated: its square still is a
            double.
        rest_speed: Speed [rad/s] or [m/s] over which friction changes its sign on a motion that is not recorded yet.
        slow_speed: Part of the recorded speed at which the slow sine goes: presliding and Stribeck friction show there.
        slow_rate: Fastest rate of the slow sine [rad/s].
        fast_speed: Part of the recorded speed at which the fast sine goes.
        chirp: First and last frequency of the chirp [Hz]: from where friction counts most to where inertia does.
        chirp_range: Part of half the range that the chirp takes where the speed allows it.
        reversal_range: Part of half the range of the first small reversals.
        reversal_growth: How many times larger than that they get, beside the first.
        reversal_rate: Frequency of the small reversals [Hz].
        speeds: Number of speeds of the staircase, spaced evenly in their logarithm.
        slowest: Slowest of them, over the recorded speed.
        longest_step: Longest time at one speed [s].
        shortest_step: Time at one speed [s] below which the staircase turns round.
        turned_step: Time at one speed [s] after it has turned.
        step_share: Part of the way to the end of the range that one speed may take.
        smooth_samples: Samples over which the steps between the speeds are smoothed.
    """

    most_rivals: int = 3
    duration: float = 40.0
    fade: float = 1.0
    enough: float = 30.0
    plenty: float = 10.0
    fastest: float = 0.99
    half_range: float = 0.48
    held: float = 1e-8
    difference: float = 0.1
    largest: float = 1e50
    rest_speed: float = 1e-3
    slow_speed: float = 0.2
    slow_rate: float = 2.0 * pi * 0.2
    fast_speed: float = 0.9
    chirp: tuple[float, float] = (0.1, 4.0)
    chirp_range: float = 0.5
    reversal_range: float = 0.06
    reversal_growth: float = 3.0
    reversal_rate: float = 0.4
    speeds: int = 8
    slowest: float = 0.01
    longest_step: float = 3.0
    shortest_step: float = 0.2
    turned_step: float = 0.3
    step_share: float = 0.95
    smooth_samples: int = 101


EXPERIMENT = ExperimentSettings()
PROBABILITY = ProbabilitySettings()
SHARING = SharingSettings()
VERDICT = VerdictSettings()
LATE = LateSettings()
