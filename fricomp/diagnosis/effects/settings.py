"""Numbers that decide in this stage, each with its reason and what moves with it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class EffectSettings:
    """What all effects share: the motion that they are computed from, and how their numbers are judged."""

    smooth_window: float = 0.061
    """Window over which motion and bristle torque are smoothed [s]. A shorter one puts noise into the columns of
    effects, which then explain that noise."""
    quick_window: float = 0.015
    """Window over which the position is smoothed where the encoder contradicts the model by more than a step [s]."""
    unexplained_load: float = 0.01
    """Part of a recorded load that gravity and acceleration may leave, for them to take its place. A larger one
    loses loads from outside."""
    small_step: float = 0.02
    """Change of a coefficient that matters to the fit, as part of a torque. It sets the solver's steps and damping."""
    step: float = 0.05
    """The same for an effect that is felt as a torque of its own, as part of the Coulomb level."""
    order_step: float = 0.05
    """Change of an order over position that matters [1/rad]: over some turns it shifts a wave by a part of a period."""
    share_step: float = 0.1
    """Change of a load's part of the inertia that matters [1]."""
    unbounded: float = 1e7
    """Bound on numbers of either sign that need none, in their units. It lies beyond every joint and only keeps a step
    of the solver finite."""
    load_shares: tuple[float, float] = (0.05, 0.98)
    """Bounds on the part of the inertia that is the load's [1]. A smaller load is not felt through a gap or a spring,
    and a joint that is all load has no motor to be measured at."""
    load_share_prior: float = 0.3
    """Standard deviation of a weak prior around the start of that part [1]: it keeps a fit near it where the
    recordings do not show the load."""
    steepest_unevenness: float = 0.5
    """Largest part by which a gear's ratio changes along a wave of its error. Teeth reach some hundredths; at one the
    load would stand still while the motor runs."""
    usual_load_share: float = 0.6
    """That part where nobody knows it [1]: gears are chosen so that motor and load weigh about the same."""
    nearly_all: float = 0.99
    """Part of the samples that counts as all of them."""
    most_lost: float = 0.6
    """Part of a recorded torque up to which a warm motor or a low supply may take it in nearly all samples. Drives
    switch off before that. Where more is taken away, so is most of what is to be explained: the torque of a real joint
    with another drag was shrunk to a tenth, and little was left of any misfit."""
    least_waves: float = 1.5
    """Waves of a ripple that the recorded range must hold. Less of one looks like anything that varies slowly."""
    least_passed: float = 3.0
    """Waves of a ripple that the motion must pass: the range that holds the fewest, there and back. In one stroke,
    angle, time and speed are one, and a wave with overtones draws whatever depends on any of them."""
    smooth_rows: int = 7
    """Least number of samples of a smoothing window: a local cubic goes through four, and seven leave it something to
    average."""
    still_scale: float = 0.02
    """Least Coulomb level in the standard deviation of the torque, as a measure for steps on joints without dry
    friction."""
    usual_form: float = 0.03
    """Relative deviation that a law of slightly another form leaves in a size. An order, an edge, a time are known
    as well as the fit says."""
    at_bound: float = 1e-3
    """Relative distance from a bound at which a fit stands at it."""
    shortest_heating: float = 1.0
    """Shortest time constant of heating [s], that of a winding."""
    longest_heating: float = 1000.0
    """Longest time constant of heating [s], that of a gearbox."""
    heating_unit: float = 60.0
    """Time in which the mean losses bring one unit of an estimated heat [s], within what recordings last. With one far
    beyond them size and time constant hang together."""
    heating_starts: tuple[float, ...] = (10.0, 30.0, 100.0)
    """Time constants of heating from which fits start [s]."""
    window_rounds: int = 6
    """Most times that windows are left out of a refit and found again."""
    window_mean: int = 9
    """Number of rows of the running mean that a push lifts. More rows miss short pushes."""
    most_inside: float = 0.6
    """Part of the rows from which those that stand out are no windows any more."""
    least_outside: float = 0.3
    """Part of the rows that must lie outside of all windows and their margins, or the base cannot be refitted there."""
    window_energy: float = 5.0
    """Least mean energy above the noise inside the windows, in that noise. A push that matters is far above it."""
    window_core: float = 6.0
    """Standard deviations by which that mean stands out somewhere inside a window."""
    window_edge: float = 2.5
    """Standard deviations by which it stands out up to the edge of a window."""
    window_gap: int = 7
    """Number of rows; windows that are nearer to each other are one."""
    most_windows: int = 5
    """Most windows. More of them are no pushes, and each has four parameters."""
    window_break: float = 0.4
    """Longest break between windows of one direction that are joined [s]."""
    window_steps: tuple[float, ...] = (0.16, 0.08, 0.04, 0.02)
    """Steps by which the ends of a window are moved [s]."""
    faint_window: float = 0.03
    """Part of the strongest window's energy below which another one is what the strong one bends the base by."""
    longest_windows: float = 0.35
    """Part of the recordings that all windows together may fill. What acts longer is no push."""
    window_contrast: float = 100.0
    """Energy of a row above its noise inside the windows, over that outside."""
    quiet_outside: float = 1.0
    """Such energy outside that a base leaves now and then, and that is allowed in any case."""
    near_state: float = 0.06
    """Distance below which two states count as the same, in the ranges of position, speed and acceleration."""
    visited_share: float = 0.4
    """Part of the windows' rows whose state must occur outside as well."""
    visited_pairs: float = 0.8
    """Part of the rows of the windows that must, where less than that share does, by any two of the three."""
    visited_energy: float = 0.1
    """Part of their energy that must lie at positions, speeds and accelerations that occur outside as well. Stops
    that are met once have 0.00 to 0.01, and pushes 0.31 and more."""
    twist_window: float = 0.015
    """Window of the local cubic that takes the curvature of the twist [s]; a third of a row."""
    ringing: float = 4.0
    """How long a load is followed that swings from its state at the first sample, in decay times; 2 % are left."""
    most_substeps: int = 20
    """Most substeps a sample. A load that swings faster is stiff for the rows, and more of them show nothing new."""
    twist_substep: float = 0.25
    """Longest substep of a load on its spring, in its own oscillation [rad]."""


EFFECT = EffectSettings()
