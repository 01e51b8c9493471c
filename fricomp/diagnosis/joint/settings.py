"""Numbers that decide in this stage, each with its reason and what moves with it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class JointSettings:
    """How the joint is modelled, simulated and fitted, before any effect.

    They were chosen on joints simulated with MuJoCo, with and without effects, unless a source is named.
    """

    softest_bristle: float = 2.5e-4
    """Presliding distance, `bristle_level` over sigma_0, of the softest bristle of the base [rad]. With a larger one
    the base takes up soft presliding, which is then no effect any more."""
    longest_delay: float = 5e-4
    """Longest time by which the torque is behind the motion in a usual chain of sensors [s]. A longer one lets the
    base swallow real delays."""
    stiffest_bristle: float = 1e-7
    """Presliding distance of the stiffest bristle of the base [rad]. MuJoCo's friction turns over at once in a
    reversal; a bristle of 2e-6 rad takes half a millisecond for it, leaves 1.3 times the noise on a chirp, and
    looks like a frictional lag."""
    usual_bristle: float = 3.6e-5
    """Presliding distance from which the fit of the base starts [rad]. Another start may end in another minimum."""
    longest_steps: tuple[float, ...] = (
        4.0,
        40.0,
        40.0,
        40.0,
        *2 * (10.0, 10.0, 2.0, 20.0),
        3.0,
        2.0,
        3.0,
        2.0,
        2.0,
        3.0,
        3.0,
    )
    """Longest step of each parameter of the base in its scale. Those that enter linearly may go anywhere at once."""
    least_level: float = 0.02
    """Least Coulomb torque, in the deviation of the recorded torque, about which the base is looked for. A lower one
    shuts the friction of a joint out where a stop has bent the first estimate to none."""
    uneven_share: float = 0.1
    """Part of the Coulomb torque by which both directions must differ before the fit is repeated from even
    directions. A lower one costs fits and finds nothing."""
    unlike_stribeck: float = 1.6
    """Difference of the logarithms of both directions' Stribeck velocities that no joint has: the fit is repeated
    with both as the lower one."""
    lost_fall: float = 0.1
    """Part of one direction's static friction below which the other's counts as lost, and the fit is repeated with
    both alike."""
    usual_motion: float = 0.9
    """Part of the sliding samples that are slower than the usual top speed."""
    wide_fall: float = 0.2
    """Part of the usual top speed from which a fall of the friction is wide: a fit is repeated with lines beyond
    that. Of two falls that a motion shows equally well, the narrow one is Stribeck's."""
    wide_excess: float = 0.2
    """Static friction less Coulomb torque, in the latter, below which a fall bends no curve."""
    lowest_stribeck: float = 5e-4
    """Lowest Stribeck velocity, in the top speed of the motion: a lower one is dry friction for all that rows show."""
    held_scale: float = 1e-9
    """Scale of a parameter that is not fitted, in its own unit. It is only small enough to leave no trace."""
    missing_step: float = 1.6
    """Step of time, in samples, from which on a row is missing. Stamps that jitter are closer."""
    largest_damping_time: float = 0.012
    """Largest sigma_1 / sigma_0 of a bristle of the base [s]. A larger one lets damping stand for the static
    friction that a stiff bristle shows."""
    at_bound_share: float = 0.9
    """Part of the largest delay at which the base counts as standing at its bound, so that effects which may hide
    behind it are fitted."""
    asymmetry_spread: float = 0.2
    """Standard deviation of the difference of both Coulomb torques, in their mean. Sliding shows it only together
    with the offset; a larger one lets the two trade."""
    stiff_bristles: tuple[float, ...] = (1e-6, 3e-5)
    """Presliding distances from which a loud and damped fit starts again [rad]."""
    loud: float = 1.1
    """Residual over noise, or over that of nulls, from which a fit of the base is loud, so that other bristles and
    creep are tried. A lower one costs time."""
    slowest_creep: float = 1e-5
    """Least creep velocity, in the top speed of the motion. Rests show it: a joint of a simulator, held for a second
    against its friction loss, gives way by some millirad."""
    fastest_creep: float = 0.1
    """Largest creep velocity, in the top speed of the motion. A faster one is viscous friction."""
    longest_lead: float = 0.03
    """Longest time by which friction that creeps is ahead of the velocity [s]; three times that of MuJoCo's usual
    impedance."""
    creep_steps: int = 12
    """Number of steps towards creep after which the better start goes on."""
    hopeless_cost: float = 4.0
    """Cost of a fit that creeps, in that of a bristle, from which it is given up. By the weights of a bristle,
    which hardly lets a joint at rest be noisy, friction that does creep has left twice as much and joints that
    stick 5 to 8000 times as much."""
    impedance: float = 0.9
    """Impedance d of MuJoCo's friction loss F = d (tau + b J v), from which creep starts; its default."""
    creep_rates: tuple[float, ...] = (105.0, 1050.0)
    """Rates b of that friction loss [1/s], from which creep starts: the usual one and that of a simulation ten
    times as stiff."""
    faded_level: float = 0.01
    """Level of friction that creeps, in that of a bristle, below which nothing is left that could creep."""
    damped_share: float = 0.9
    """Part of the largest damping time from which a bristle counts as damped as much as it may be."""
    base_steps: int = 48
    """Most steps of a weighted fit of the base. Coulomb, static and viscous torque of a slow motion lie along a
    narrow valley."""
    base_tolerance: float = 0.3
    """Fall of the cost that ends such a fit, in the mean squared residual. A fit that stops on its way down leaves
    the rest to any effect."""
    whitener_order: int = 4
    """Order of the autoregressive filter that whitens the rows, enough for rows that overlap by half and noise with
    a memory of some rows."""
    stiffness_doubt: float = 1.6
    """Factor on the bristle stiffness for which its unknown law stands. A larger one trusts the rows after
    reversals less."""
    creep_doubt: float = 1.1
    """Factor on the creep velocity that does the same: a line that is cut off and a smooth curve that turns over
    alike differ as much."""
    law_doubt: float = 0.5
    """Part of what another law changes in a row that counts as its uncertainty."""
    quiet: float = 5e-4
    """Noise of the quietest rows, in the Coulomb torque, below which a recording counts as one without noise. Of ten
    logs of a simulator the quietest tenth of the rows had 1.2e-4 at most, of logs with noise 7.7e-4 at least."""
    quiet_rows: float = 0.1
    """Part of the rows that are the quietest: nulls of such logs vary about reversals, as the unknown delay does."""
    finest: float = 0.005
    """Least noise of a row of such a recording, in the Coulomb torque. A smaller one would be that of our own
    arithmetic and of what happens between two samples."""
    torque_window: float = 0.011
    """Window that separates the applied torque from its noise [s]. A longer one takes reversals off the nulls."""
    delay_spread: float = 5e-5
    """Standard deviation of the delay of nulls [s], as the clocks of usual sensors stray."""
    matching_nulls: int = 8
    """Number of nulls from which the noise is matched. Fewer make the threshold stray."""
    usual_memory: float = 0.9
    """Correlation of coloured noise from sample to sample where the samples show none."""
    throughout: float = 0.999
    """Part of a row's window in which the joint must slide, for the row to count as sliding; all of it but rounding."""
    enough_rows: int = 100
    """Number of such rows from which they alone give the noise: a median of fewer strays."""
    noise_correction: tuple[float, float] = (0.7, 1.4)
    """Least and largest factor on the matched noise for what does not add up in squares."""
    row_width: float = 0.042
    """Width of a row's Hann window [s]: long enough to average noise, short enough for a reversal."""
    row_step: float = 0.020
    """Time from row to row [s]; neighbouring rows overlap by half."""
    settled: float = 5.0
    """Time constants of the observer that a row's window spans at least, so that it has followed."""
    innovation_window: float = 0.061
    """Window of the slope by which velocities are improved [s]. A shorter one puts the encoder's noise into them."""
    loud_innovation: float = 1.5
    """Deviations of the encoder's noise up to which what a model misses of the position is taken for noise."""
    fine_substeps: tuple[int, int] = (3, 40)
    """Fewest and most substeps of a sample in which the bristle may be stretched."""
    coarse_substeps: int = 2
    """Fewest substeps of a sample in which it has long yielded."""
    row_substeps: float = 250.0
    """Most substeps within a row's window that a bristle needs for its rows. With 400, and with four times the usual
    number everywhere, rows differ by less than 0.02 of their noise."""
    stable_substep: float = 0.7
    """Longest substep in radians of the bristle's own oscillation."""
    held_substep: float = 0.7
    """Longest substep in times after which the observer's damping alone has led the joint back."""
    certain_sliding: float = 4.0
    """Rest speeds from which a sample's direction is certain."""
    yielded_travel: float = 16.0
    """Travel since a reversal after which any bristle has yielded, in presliding distances of the softest one."""
    turning_margin: float = 0.02
    """Time by which the simulated joint may turn earlier or later than the recorded one [s]."""
    difference: float = 0.02
    """Step of the differences that make a Jacobian, in a parameter's scale. A smaller one is lost in the rounding
    of a simulation, a larger one bends."""
    first_damping: float = 1e-3
    """Damping with which a descent begins, in the curvature: next to none, since it grows where a step fails."""
    dampings: tuple[float, ...] = (1.0, 30.0, 900.0)
    """Factors on the damping that are tried; the larger ones only where the first step breaks its promise."""
    step_parts: tuple[float, ...] = (0.5, 0.2)
    """Parts of the least damped step that are tried besides. A narrow valley that bends lets no whole step pass,
    and one that damping has made short is short along the valley most of all."""
    kept_promise: float = 0.7
    """Part of the fall of the cost promised by the linear model from which the least damped step is taken without the
    others. A lower one follows bent valleys by longer ways, a higher one simulates steps that do not win."""
    lost_share: float = 0.2
    """Part of the fall of the leader's cost that a rival may end behind it and still count. Effects are weighed beside
    each other within half of that."""
    lost_promises: float = 3.0
    """Times the fall promised by a line that a descent may still make. Bent valleys have brought twice as much."""
    catching_up: float = 0.05
    """Part of its way to the leader that a rival's step must fall by, for the rival to go on. Steps grow shorter, and
    there are about a dozen."""
    further_damping: tuple[float, ...] = (0.1, 10.0, 300.0, 1.0, 1.0)
    """Factor on the damping after each of those trials has won."""
    largest_derivative: float = 1e50
    """Largest derivative that counts. A larger one is a point that does not simulate."""
    tolerance: float = 1e-2
    """Fall of the cost that ends a descent, in the mean squared residual."""
    lines_around: int = 101
    """Number of lines whose median is the level about a line."""
    line_ratio: float = 2.5
    """Times the loudest line of a null over its level, from which a line is more than noise. A lower one calls
    chance a vibration."""
    bands: int = 20
    """Most bands in which the colour of a spectrum is told."""
    band_lines: int = 20
    """Fewest lines of a band, for its mean to be known within a quarter."""
    peak_ratio: float = 1.5
    """Times the highest peak of a null, from which a peak is more than noise."""
    least_peak: float = 2.0
    """Least such peak: how many times the loudest band is louder than quieter ones on both sides."""
    row_limit: float = 4.0
    """Typical deviations that a row counts for at most, since one bad moment fills the whole spectrum."""
    heard_share: float = 0.5
    """Part of the torque's noise below which the answer of a loop to the encoder's steps is not worth a simulation."""
    astray_steps: float = 10.0
    """Steps of the encoder that the joint may be off under its loop; a loop that leaves it further has not moved it."""
    beside_left: float = 0.5
    """Part of what the first estimate leaves that it may leave beside a spring, or beside friction that grows with the
    load, for a joint that has one."""
    load_rounds: int = 6
    """Rounds in which the first estimate finds the load, and beside it the gravity that this hangs on."""
    usual_weight: float = 0.01
    """Weight of an offset, of the difference of both directions and of that from the simulation in the first estimate,
    in that of the torque they would make: next to nothing where the rows show them."""
    most_rows: int = 6000
    """Most rows of the first estimate; more cost time and change nothing."""
    rest_speed: float = 5e-3
    """Speed below which a joint of usual speed says nothing about sliding [rad/s] or [m/s]."""
    rest_share: float = 0.05
    """The same for a slower joint, in its top speed."""
    slow_share: float = 0.1
    """Part of the rows that counts as the slowest, which say how much dry friction there is at least."""
    most_held: int = 30_000_000
    """Samples of simulated signals that are held at once, 8 bytes each; the longer recordings are, the fewer
    simulations are run side by side. It changes no answer."""
    threads: int = 2
    """Number of threads that simulate at once; the answers do not depend on it."""


JOINT = JointSettings()
