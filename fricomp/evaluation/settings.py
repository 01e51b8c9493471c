"""Every number that decides how a model is evaluated, with its reason."""

from dataclasses import dataclass

HORIZONS = (0.1, 0.5, 2.0)
"""Times after which the position error of an open-loop simulation is measured [s]."""


@dataclass(frozen=True)
class EvaluationSettings:
    """How errors are measured.

    Attributes:
        bands: Upper ends of the band of the torque error that are tried [Hz], widest first. Friction, gravity and
            inertia of a joint act below 50 Hz; below 2 Hz hardly any motion is left.
        of_rate: Part of the sample rate that the band may reach at most, so that a filter has room.
        noise_share: Part of the acceleration's power that may be noise of the encoder in the band. Inertia that is
            fitted in the band comes out too small by it, less than by chance.
        wider: Cutoff of the position over the band: the same low-pass for the torque then shapes both alike.
        order: Order of the Butterworth low-pass, which is run forward and backward.
        margin: Periods of the band that are left out at both ends of a part, where filters start.
        slowest: Part of the top speed (98th percentile) below which a joint counts as resting; an encoder at rest makes
            up speeds of that size.
        top: Quantile of the speed that counts as the top one.
        counts: Encoder steps in one period of the band, below which a joint counts as resting.
        starts: Open-loop simulations, spread evenly over the time in motion. Their median is known to a tenth.
        arm_starts: The same of a whole arm, whose simulation takes longer.
        blocks: Blocks of time that the intervals are drawn from.
        draws: Bootstrap samples of an interval.
        velocity_lag: Deviation of a recorded velocity from the slope of the position over the RMS speed, above which it
            is not taken as a state: it is filtered, late, or of something else.
        longest_step: Longest step of an open-loop simulation [s].
        angle: Largest angle of any oscillation of the model in one step [rad]: a bristle's or a ripple's.
        most_substeps: Steps of one sample at most.
        shortest_part: Length of a part between gaps [s] below which nothing is evaluated in it.
        runaway: Times the recorded range beyond which a simulation has left the motion; its error counts as that.
    """

    bands: tuple[float, ...] = (50.0, 35.0, 25.0, 17.0, 12.0, 8.0, 6.0, 4.0, 3.0, 2.0)
    of_rate: float = 0.2
    noise_share: float = 1e-3
    wider: float = 1.2
    order: int = 4
    margin: float = 2.0
    slowest: float = 0.02
    top: float = 0.98
    counts: float = 2.0
    starts: int = 100
    arm_starts: int = 40
    blocks: int = 20
    draws: int = 400
    velocity_lag: float = 0.05
    longest_step: float = 2e-3
    angle: float = 0.5
    most_substeps: int = 24
    shortest_part: float = 1.0
    runaway: float = 2.0


EVALUATION = EvaluationSettings()


@dataclass(frozen=True)
class RefitSettings:
    """How all numbers of a model are fitted together.

    Attributes:
        starts: Starts that are followed, best first once the numbers are set that act in proportion.
        steps: Steps of Gauss and Newton at most from each.
        fold_steps: The same for a fit without one fold, which starts at the minimum of all of them.
        shares: Parts of a step that are tried.
        longest: Longest step of the logarithm of a number: further away no derivative says anything.
        falls: Stribeck velocities that a fit starts from as well, over the top speed. Two of them draw any usual curve.
        top: Quantile of the speed that counts as the top one.
        settled: Fall of the mean square below which another step is not worth taking.
        kept_terms: Results of terms along a motion that are kept, for each term of the law: before and after a step of
            one number. More of them take memory alone.
        difference: Step of a number over its size, for derivatives.
        nothing: Size of a number below which it says nothing about how far it moves: steps are then of the unit.
        least: Size of a number at the end of its domain, over where it started.
        rank: Weight by which a number stays where it was, in that of its column: what the data do not show stays.
        rate: Samples that are kept, in bands: more say the same again.
        folds: Parts of the data that are left out in turn.
        blocks: Blocks of each fold in a part at most: long ones leave room for simulations.
        block: Shortest block [s].
        gap: Time around a block that no other fold is fitted to, in periods of the band.
    """

    starts: int = 2
    steps: int = 8
    fold_steps: int = 2
    shares: tuple[float, ...] = (1.0, 0.3, 0.1)
    longest: float = 1.0
    falls: tuple[float, ...] = (0.05, 0.2)
    top: float = 0.95
    settled: float = 1e-3
    kept_terms: int = 3
    difference: float = 1e-4
    nothing: float = 1e-9
    least: float = 1e-6
    rank: float = 1e-4
    rate: float = 4.0
    folds: int = 4
    blocks: int = 2
    block: float = 3.0
    gap: float = 1.0


REFIT = RefitSettings()


@dataclass(frozen=True)
class MjcfSettings:
    """How an exported MJCF is judged.

    Attributes:
        starts: Simulations of each way: fewer than in an evaluation, since they only choose between ways.
        duration: Time of the recording in which they start [s].
    """

    starts: int = 40
    duration: float = 20.0


MJCF = MjcfSettings()
