"""Numbers that decide in this stage, each with its reason and what moves with it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchSettings:
    """What counts as evidence for an effect, and how far explanations are looked for.

    A gain is a fall of the cost in units of the noise variance, less the BIC penalty; a threshold is the gain that an
    effect must exceed. The numbers were chosen on joints simulated with and without effects.
    """

    enough: float = 0.98
    """Coverage from which a generic basis sees nothing more. A lower one ends the search earlier."""
    another_effect: float = 0.08
    """Part of the gain that one more effect must add. Less is what the form of the first one does not quite meet."""
    completing_gain: float = 3.0
    """Thresholds of gain that an effect must add to complete an explanation."""
    completing_share: float = 0.01
    """Part of the first ones' evidence that it must add besides, in which no row counts for more than a few: beside an
    effect that is far louder than the noise, a part of its whole gain would shut out every other."""
    law_lacks: float = 0.03
    """Part of its gain that a law of friction under load may lack, since no gear follows one to the last per cent:
    another such law draws it. As much as the right law may lack beside a rival."""
    completing_left: float = 0.3
    """Part of what was left that it may leave."""
    loud_part: float = 0.2
    """Energy beyond the noise, in that of the noise, from which an explanation leaves something to be silenced."""
    silenced_part: float = 0.4
    """Part of that energy which an effect may leave, to have silenced it."""
    wider_coverage: float = 0.015
    """Coverage that one more effect must add while a generic basis sees something."""
    wider_share: float = 0.1
    """Part of what was not covered that is enough in its place."""
    further_left: float = 0.5
    """Part of what an explanation leaves that may be left beside further effects, unless it is below the threshold. In
    joints whose effects are known they leave 0.3 at most; in real ones, what no form of theirs fits draws names."""
    untouched: float = 0.3
    """Noise of a row that the first effects add at most to rows which they hardly reach."""
    apart: float = 2.0
    """Thresholds of evidence in such rows from which a further effect is none of the first ones' form."""
    overwhelming: float = 10.0
    """Thresholds of gain from which further effects count wherever they show. The form of a bristle has been seen
    to bring 7."""
    overwhelming_share: float = 0.3
    """Part of the gain that they must bring besides where nothing says that they complete the explanation."""
    rival_share: float = 0.1
    """Part of the chosen gain that a rival may lack to be finished beside it."""
    finalists: int = 2
    """Number of such rivals; each costs a fit."""
    same_column: float = 1e-9
    """Part of a column of the plain joint below which it is one of the others."""
    fewest_sliding: int = 50
    """Fewest rows in which the joint slides that tell the noise."""
    tighter: float = 3.0
    """Least factor by which two joints are held tighter than by the observer of the residual."""
    stiffer: float = 4.0
    """Least factor by which that observer is stiffer than the bristle."""
    fastest_observer: float = 10.0
    """Bandwidth of that observer in a sample [rad], which its substeps still follow."""
    most_of_a_row: float = 9.0
    """Most gain that one row adds to what counts against the threshold: three standard deviations squared. One bad
    moment is no physics."""
    fair_share: float = 0.5
    """Part of an effect's gain, were it spread evenly, that must lie in rows that slide. Else it only bends the
    bristle."""
    loud_about_rest: float = 0.6
    """Gain of a row about rest that no error of the bristle's form brings. It has been seen to leave 0.3 where
    nothing was missing."""
    form_of_bristle: float = 0.1
    """Gain of a row about rest that effects like a bristle take up of its form alone."""
    forgiven_about_rest: float = 0.3
    """Energy of a row about rest that is not held against an explanation."""
    plain_gain: float = 0.3
    """Gain of a row, over all rows, from which an explanation counts wherever it shows. Joints with nothing missing
    reach 0.25 by the form of their bristle."""
    plain_coverage: float = 0.85
    """Coverage that it must have besides."""
    same_order: float = 0.05
    """Relative difference of two orders below which a ripple of torque and one of friction have one cause, such as
    a detent."""
    like_size: float = 0.25
    """Quotient of their sizes from which they are of like size."""
    viscous_left: float = 0.2
    """Part of the torque that grows with speed, which is linear, below which a power law has taken the place of
    viscous friction."""
    curve_fits: float = 0.97
    """Coverage below which such a law does not fit: it bends as no power law would."""
    exponent_edge: float = 0.01
    """Distance of its exponent from the edge of its domain at which it stands there."""
    alike_times: float = 0.3
    """Relative difference of a delay and a lag below which the two only cancel."""
    clearly_left: float = 60.0
    """Energy that must be left for a law not to fit. A weak effect is covered less by chance."""
    clearly_left_per_row: float = 0.02
    """The same for each row: in a long recording the form of a law shows that no other effect has."""
    kept_starts: int = 2
    """Number of starts of an effect that are refined and offered."""
    start_rounds: int = 2
    """Number of rounds of steps along each parameter."""
    start_amplitude: tuple[float, float] = (0.5, 1.6)
    """Factors by which a start may be off in size."""
    latest_torque: float = 0.03
    """Longest time after its stamp at which a torque may act [s]; later ones show beside the inertia."""
    late_starts: tuple[float, ...] = (0.002, 0.006, 0.015)
    """Delays from which the base is fitted where its own is at the bound [s]."""
    late_cost: float = 0.9
    """Cost of the base with such a delay, in that without, below which it is worth a search."""
    late_creep_loud: float = 1.5
    """Residual over noise of the best explanation from which creep is tried beside it."""
    late_creep_cost: float = 0.75
    """Cost with creep, in that with a bristle, below which it is worth a search with creep."""
    clear_creep_cost: float = 0.5
    """The same, below which the joint creeps whatever that search leaves by its own noise."""
    body_held: float = 0.002
    """Relative deviation of inertia and gravity that are held at those of the simulation: narrow beside any error that
    matters, and wide enough for a fit to move."""
    body_least_gravity: float = 0.4
    """Least gravity whose deviation is held, in the scale by which the base measures gravity: a fiftieth of friction
    or of gravity itself. About a vertical axis there is none, and one held to exactly nothing would drown all else
    that is fitted."""
    from_simulation: int = 3
    """Number of effects that are fitted from the simulation as given as well, where none covers most from the free
    base. Each costs a fit."""
    most_orders: int = 900
    """Most orders over position that are looked at. More cost time and lie closer than a recording can tell."""
    ripple_cells: int = 1_000_000
    """Rows times orders of ripples that are looked at together: memory, and no answer, depends on it."""
    ripple_block: tuple[int, int] = (4, 64)
    """Fewest and most such orders."""
    usual_load_share: float = 0.6
    """Part of the inertia that usually sits behind the gear."""
    sliding_speed: float = 2.0
    """Rest speeds from which a joint slides."""
    settled_time: float = 0.16
    """Time about a row in which observer and whitener still answer to a start or a stop [s]."""
    seldom: float = 0.1
    """Part of the rows below which a joint hardly ever slides, so that all rows count."""
    astray_cost: float = 0.5
    """Cost of a fit from another start, in that of the first, below which the first has gone astray."""
    first_nulls: int = 12
    """Number of nulls for the weights of the first refit."""
    quiet_creep: float = 1.2
    """Residual of friction that creeps over that of its nulls below which it creeps: 1.07 to 1.17 where it does, 6
    to 48 where it sticks."""
    creep_explains: float = 0.95
    """Part of the energy above the noise that creep must explain where a trace of something else is missing besides."""
    creep_leaves: float = 0.7
    """Energy left with creep, in that with a bristle, where much else is missing. Joints that creep beside cogging
    or load friction had 0.02 to 0.64 of it, those that stick beside any effect 0.76 (a clear frictional lag) and
    more."""
    colour_steps: int = 6
    """Most half steps towards the colour of the nulls."""
    same_colour: float = 0.08
    """Difference of correlations that chance may bring."""
    dying_root: float = 0.9
    """Largest root of a filter that dies away within some rows."""
    fainter_tries: int = 8
    """Number of ever fainter filters that are tried to get there."""
    even_excess: float = 0.8
    """Quotient of the excess of the bulk and of all rows, below which few rows make it. No noise does."""
    usual_excess: float = 1.4
    """Factor on the noise that needs no such evidence."""
    noise_correction: tuple[float, float] = (0.6, 1.8)
    """Least and largest factor by which the noise found in single samples is corrected."""
    last_steps: int = 12
    """Most steps of an explanation that was chosen and of rivals close to it."""
    first_bins: int = 20
    """Bins over position and speed, of as many rows each, in which a first look says where most of a mismatch is."""
    first_width: float = 0.2
    """Part of the rows that such a place may take. A larger one says nothing about where."""
    first_share: float = 0.4
    """Share of the excess from which the place is told: twice what would lie there by chance."""
    quieter: float = 0.5
    """Typical row that the best explanation leaves, in that of the noise, below which the noise is measured anew."""
    something_left: float = 1.15
    """What it leaves then, over the noise, from which something else is searched for."""
    far_inertia: float = 2.0
    """Factor between the first estimate of the inertia and that of the joint that was found from which the first one
    was bent: observer, noise and domain are those of another joint."""
    estimates: int = 2
    """Most times that a search begins again from the joint that it found."""
    coarse_tolerance: float = 1e-5
    """Tolerance from which squares of the columns tell a basis as well as the columns, three times as fast."""
    overtone_takes: float = 0.25
    """Part of what an explanation leaves above the noise from which an overtone of its ripple belongs to it."""
    singles: int = 8
    """Number of effects that are refitted on their own."""
    faint_effect: float = 0.03
    """Part of the strongest effect's energy below which another one is not refitted."""
    careful: int = 3
    """Number of explanations refined with a fresh Jacobian in each step."""
    more_careful: int = 6
    """The same where none of those explains enough."""
    hypotheses: int = 2
    """Number of starts of an effect that are refitted."""
    partners: int = 4
    """Number of partners that are tried for each explanation that is grown."""
    alike_start: float = 0.9
    """Part of the energy of a partner's best start from which its next one is tried as well."""
    noisy_torque: float = 0.5
    """Part of the variation of rows without effects that is noise of the torque, from which rows are told as the torque
    is recorded: there its noise does not depend on a lag."""
    bent: float = 1.2
    """Residual over noise from which effects that screened badly are refitted as well, where little is covered."""
    bent_far: float = 3.0
    """Residual over noise from which the joint is estimated beside the shapes of effects, too. A lower one costs a fit
    where the base is hardly bent."""
    most_covered: float = 0.85
    """Coverage from which an explanation covers most."""
    clearly_better: float = 5.0
    """Thresholds of gain by which an explanation that was not chosen leaves far less."""
    nameable: float = 0.7
    """Coverage below which nothing is named anyway."""
    stands_out: float = 2.0
    """Thresholds of energy from which an effect stands out beside an explanation that covers about all."""
    idle: float = 0.01
    """Noise of a row below which an effect adds nothing."""
    much_left: float = 100.0
    """Energy that a generic basis explains beside an explanation, from which starts are looked for anew."""
    null_quantile: float = 0.98
    """Quantile over the nulls that fixes the rate of false alarms."""
    least_gain: float = 30.0
    """Least threshold of gain: what chance brings at most over all effects, starts and pairs that are tried."""
    material_gain: float = 0.01
    """Least gain of a row, over all rows. Below it small errors of the base itself could be named."""
    tone_limit: float = 3.0
    """Deviations that a row counts for at most, since one bad moment fills the whole spectrum."""
    motion_energy: float = 0.95
    """Part of the velocity's energy that lies below the frequencies at which vibrations are looked for."""


SEARCH = SearchSettings()
