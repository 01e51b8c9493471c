"""Every number that decides what counts as evidence, with its reason and what moves with it.

Where nothing else is said a number was chosen on development cases: concealed joints of the project's own generator and
public recordings. On joints that are far from those it may not be the best one.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ConfirmationSettings:
    """How errors on held-out data are computed.

    Attributes:
        folds: Parts that are left out in turn. More of them leave each fit more rows, and cost a simulation each.
        blocks: Most blocks of a part, spread over the recording, so that the rows that stay hold what is alike: a sweep
            meets each speed only once.
        shortest_block: Rows of a block at least (1.2 s). A shorter one is mostly gap.
        fewest_recordings: Recordings from which whole ones are left out, and not blocks of time: with fewer, too little
            would be left to fit.
        gap: Rows on both sides of a block that nobody uses (0.3 s): five correlation times of the rows.
        bootstraps: Draws for the interval of the reduction. Its ends come out within some 3 % of its width by them.
        bootstrap_block: Rows of a block that is drawn (1 s): longer than rows remember.
        fewest_blocks: Blocks that are drawn from at least, in short recordings too.
        step_parts: Parts of a step from the joint minimum that are simulated; the best one on the fitted rows is taken.
            A bristle or a gap is no line, so that the whole step may be far too long.
        least_diagonal: Least precision of a parameter in that step, in units of its scale: parameters that the rows do
            not fix stay where they are.
        straightest: Least eigenvalue of the part of a block that a fit has not bent: below it the division would blow
            up rounding.
    """

    folds: int = 6
    blocks: int = 6
    shortest_block: int = 60
    fewest_recordings: int = 3
    gap: int = 15
    bootstraps: int = 400
    bootstrap_block: int = 50
    fewest_blocks: int = 10
    step_parts: tuple[float, ...] = (1.0, 0.5, 0.25, 0.06)
    least_diagonal: float = 0.1
    straightest: float = 1e-3


@dataclass(frozen=True)
class ForetellingSettings:
    """When a ripple is asked to foretell angles that are left out.

    Attributes:
        waves: Of it in a band of angles that is left out: a whole one, and so much more that its neighbours do not tell
            it.
        fewest: Bands from which it is asked: of fewer, what is left of the range does not fix a wave.
        most: Bands at most. Each is a fit.
        lost: By how much the error may rise in some bands, in its fall in the others: beside a faint ripple noise makes
            it rise in some, and what is no ripple loses as much as it wins.
    """

    waves: float = 1.5
    fewest: int = 4
    most: int = 12
    lost: float = 1.0 / 3.0


@dataclass(frozen=True)
class GateSettings:
    """What an explanation must reach to be named, and what must be left for something to be called unknown.

    Attributes:
        covered: Coverage from which an explanation may be named. A smaller value names the largest of several effects
            where the others are not found.
        mostly_covered: Coverage that is enough where the gain is clear and little is left.
        faintly_covered: Coverage that is enough where no more is left than nulls leave.
        clear: Thresholds of certain gain that an explanation must reach which covers less than `covered`.
        faint: Energy per row that may be left where most is covered, in noise variances.
        faint_nulls: The same in units of the energy that a generic basis explains of the loudest nulls.
        smooth: Energy per row, in noise variances, that a generic basis must explain for something unknown to be
            reported. Joints with nothing missing reach 0.06 on few rows.
        least_smooth: The same over all rows. Of 40 joints with nothing missing none reached more than 70.
        smooth_nulls: The same in units of what the basis explains of nulls.
        unknown: Gain per row of an explanation that cannot be named from which something unknown is reported.
        unknown_thresholds: The same in thresholds of gain.
        audible: Residual over noise below which nothing unknown is reported: 98 of 100 joints with nothing missing stay
            below 1.07, and those whose noise has a long memory now and then reach 1.09.
        loud: Residual over noise from which the gain of an explanation that cannot be named counts.
        loudest: Residual over noise beyond which something is missing whatever it looks like.
        swinging: Residual over noise from which lines or peaks over time that no null has count as something unknown.
        material: What is left of recordings without noise, in the Coulomb torque, below which nothing unknown is
            reported: it is told as a remark. Simulators leave up to 0.005; what a user would look for is more.
        trifle: What goes from the plain held-out error of such recordings, in the Coulomb torque, from which an effect
            is named.
        phase: What is left beyond the noise, in that which an encoder's steps make, from which something unknown is
            reported. Loops that chatter at the steps of an encoder make torque that hangs on their phase against the
            sampling, which nobody knows: three joints with nothing missing left 0.53 to 0.59.
        heard: Part of `trifle` and `material` that counts in recordings with noise, but of what the form of a friction
            may look like. Joints whose friction is a hyperbolic tangent of the speed had a soft gear of 0.1 to 0.3 %
            of it; concealed effects as large as the noise were 0.24 to 0.30 %.
        least: What an inertia or gravity that is off must change in recordings with noise, in the Coulomb torque.
        tone: Strength of a line in the spectrum, over the strongest line of a null, from which it is a vibration.
        alone: Part of the energy beyond the noise that such a line must hold: what follows the motion has many lines.
        explained: Part of the held-out energy above the noise that must go where few blocks show an effect, or where
            much is left. A smaller value names effects of a form that is not theirs.
        still_loud: Held-out energy over that of the noise from which much is left.
        rare: Thresholds of certain gain that an effect must reach which few blocks show.
        overwhelming: Thresholds of certain gain from which `half` is enough in place of `explained`.
        half: Part of the held-out energy that must go where the gain is overwhelming.
    """

    covered: float = 0.88
    mostly_covered: float = 0.7
    faintly_covered: float = 0.5
    clear: float = 1.5
    faint: float = 0.03
    faint_nulls: float = 3.0
    smooth: float = 0.05
    least_smooth: float = 110.0
    smooth_nulls: float = 3.0
    unknown: float = 0.15
    unknown_thresholds: float = 4.0
    audible: float = 1.09
    loud: float = 1.15
    loudest: float = 1.25
    swinging: float = 1.04
    material: float = 0.01
    trifle: float = 0.005
    phase: float = 0.65
    heard: float = 0.5
    least: float = 0.001
    tone: float = 2.5
    alone: float = 0.2
    explained: float = 0.7
    still_loud: float = 1.5
    rare: float = 3.0
    overwhelming: float = 10.0
    half: float = 0.5


@dataclass(frozen=True)
class NeedSettings:
    """What a name needs besides a gain.

    Attributes:
        sure: Probability of the region of an effect's numbers that must not hold its absence.
        share: Share of the repetitions in which a name must come again. Below it, it is told as a remark.
        plain: Part of the held-out energy above the noise, each row counting alike, that must go.
        dwarfed: What an effect takes away, root mean square over that of all, below which the form of the others may
            leave as much.
        trace: Part of it below which what covers the mismatch where rows weigh most is nothing that is missing.
    """

    sure: float = 0.95
    share: float = 0.85
    plain: float = 0.5
    dwarfed: float = 0.01
    trace: float = 0.05


@dataclass(frozen=True)
class UndeterminedSettings:
    """From where on a number is not determined by a recording.

    Attributes:
        ratio: Half of the 95 % interval over the number: above it the number may be nothing, or twice itself.
        matters: Torque that half of the interval makes in these motions, over the deviation of the recorded torque:
            below it a number may be nothing, and is known to be small.
        domain: Part of all that is looked for, from which an interval says no more than that.
    """

    ratio: float = 1.0
    matters: float = 0.1
    domain: float = 0.9


@dataclass(frozen=True)
class RepetitionSettings:
    """How often and by which rows names are chosen again.

    Attributes:
        blocks: Repetitions that leave out blocks at random.
        cuts: Repetitions that leave out a part in one piece: the start, the end, or between.
        block: Rows of a block (2 s), longer than rows remember.
        fewest_blocks: Blocks that are drawn from at least, in short recordings too.
        left_out: Part of the rows that a repetition leaves out. With half of them left out a weak effect that is there
            would go as often as one that is not.
        explanations: Explanations that are chosen from, best first, with all parts of the chosen one.
        near: Part of the best gain that such an explanation must have.
        ridge: Added to the squares of an orthonormal basis, for columns that all lie in what is left out.
        longest_step: Longest step along an axis of the curvature, in scales, as far as the linearised refit is trusted.
        slack: Coverage that a repetition may lack: what covers just enough in all rows covers too little in half of
            their parts, which says nothing of the name.
        reached: Part of the squares of what effects add below which they do not act in a part of the rows.
        seed: Of the blocks and of the nulls that are drawn; the same for every recording.
    """

    blocks: int = 40
    cuts: int = 20
    block: int = 100
    fewest_blocks: int = 20
    left_out: float = 0.2
    explanations: int = 12
    near: float = 0.5
    ridge: float = 1e-3
    longest_step: float = 1.0
    slack: float = 0.05
    reached: float = 0.01
    seed: int = 0


@dataclass(frozen=True)
class AliasSettings:
    """When two explanations fit about as well.

    Attributes:
        close: Gain within which two explanations count as equally good: one is then at most some 400 times as likely as
            the other. A smaller value prints fewer alternatives, and more of those that are right are missing.
        form: Part of its gain that the right law may lack, since it is of slightly another form than the joint's.
    """

    close: float = 12.0
    form: float = 0.03


@dataclass(frozen=True)
class AgreementSettings:
    """How explanations that leave the given simulation as it is are looked for.

    Attributes:
        near: Part of the best gain from which another explanation is tried with the simulation's parameters too.
        least: Part of the best gain that one must have, whatever few rows may hide.
        most_near: Explanations that are tried so. Each costs a fit for every form of its effects.
        most_starts: Forms of its effects from which each of them is fitted.
        hides: Energy that a fit may have hidden in inertia and gravity, in units of what it leaves unexplained.
        improbable: Squared distance of inertia and gravity from the simulation, in its stated error, beyond which they
            are doubted: the 95 % point of chi-squared with three numbers. Lower values try more fits.
    """

    near: float = 0.9
    least: float = 0.5
    most_near: int = 2
    most_starts: int = 4
    hides: float = 4.0
    improbable: float = 7.81


@dataclass(frozen=True)
class InPlaceSettings:
    """Which effects are tried in place of a moved inertia or gravity.

    Attributes:
        share: Part of what the simulation as given costs that the columns of an effect must explain to be tried.
        most: Effects that are tried by their columns. Each costs a fit.
        fitted: Effects that are tried as they were fitted without the simulation.
    """

    share: float = 0.3
    most: int = 4
    fitted: int = 2


@dataclass(frozen=True)
class ParameterSettings:
    """When a parameter of the simulation counts as moved.

    Attributes:
        significant: Fall of chi squared that a moved parameter must bring: five standard deviations. A smaller value
            names parameters that slightly wrong forms of friction bend.
        shown: The same where data left out show that one has moved: three standard deviations.
        simpler: Chi squared that one more parameter must be worth: two standard deviations.
        split: Standard deviation of half the difference of the directions, over the Coulomb torque, on joints with
            nothing missing. A joint that slides shows the sum of that and the offset; presliding alone tells the two
            apart, of which a fit is far too sure.
        strong: Residual of the base over its noise from which parameters stray beside a named effect as much as beside
            a strong one; below it they stray the less, the weaker the effect.
        form: Part of what inertia and gravity moved by, as a standard deviation, within which hypotheses do not differ:
            inertia strays from a common factor by as much where torque acts a part of a sample late.
        usual_gain: Largest gain error of a torque signal that is called one. A larger common factor of inertia and
            gravity is a load.
        follows: Chi squared of the inertia's own shift from which it is seen to follow gravity: its 95 % interval
            leaves zero.
        gain_leaves: Chi squared that one common factor may leave of the shifts of inertia and gravity: the 95 % point
            with the two degrees of freedom that it leaves them.
        told_in_percent: Half the difference of the directions, over the Coulomb torque, up to which it is told in per
            cent: a larger one is no share of anything.
        any_speed: Stribeck velocity [rad/s] or [m/s] of a friction that does not fall with speed, where any is right.
        iterations: Steps of a fit with parameters as given; it starts near its end.
        readable: Held-out error over the noise that the named effects may leave of a simulation's own recording for its
            joint to be read off it: what is left biases the parameters.
    """

    significant: float = 25.0
    shown: float = 9.0
    simpler: float = 4.0
    split: float = 0.22
    strong: float = 8.0
    form: float = 0.03
    usual_gain: float = 0.25
    follows: float = 1.96**2
    gain_leaves: float = 5.99
    told_in_percent: float = 0.5
    any_speed: float = 1.0
    iterations: int = 6
    readable: float = 1.5


@dataclass(frozen=True)
class LocationSettings:
    """How the places are found where a mismatch sits.

    Attributes:
        bins: Bins of each quantity, with as many rows each. More of them tell places finer, and less surely.
        share: Part of the energy that the places must hold.
        neighbours: Rows whose mean energy is looked at where that of one row is mostly noise: of something unknown, and
            of moved parameters.
        widest: Part of the recording from which the places of a quantity single nothing out, and are not told.
        bootstraps: Draws for the bands of the maps.
        block: Rows of a block that is drawn (half a second): longer than the residual remembers.
        coarse: Rows whose mean counts as one where the size of the residual is looked at for changes.
        floor: Energy, in noise variances, that is added to that of each row, so that a row of no residual has a
            logarithm.
        fewest: Such means without which no change is looked for.
        between_changes: Such means between two changes at least.
        penalty: Price of a change, in units of the logarithm of their number. A smaller one finds changes in noise.
    """

    bins: int = 24
    share: float = 0.8
    neighbours: int = 5
    widest: float = 0.6
    bootstraps: int = 200
    block: int = 25
    coarse: int = 10
    floor: float = 0.1
    fewest: int = 12
    between_changes: int = 5
    penalty: float = 4.0


@dataclass(frozen=True)
class OvertoneSettings:
    """When a ripple is the form of a stronger one.

    Attributes:
        rhythm: Part of its order by which it may miss a multiple of the other's.
        wave: Part of a wave over the recorded range by which it may miss it too: a short range tells orders no better.
        of_its_own: Part of the other's energy from which a ripple is an effect of its own.
    """

    rhythm: float = 0.01
    wave: float = 0.25
    of_its_own: float = 0.5


@dataclass(frozen=True)
class VelocitySettings:
    """When a recorded velocity is told to be late.

    Attributes:
        least: Lag [s] from which it is told: shorter ones are those of usual velocity filters.
        by_differences: The same in sample periods: a velocity from differences of the position is half of one late,
            and another one where it is sent with the next row.
        longest: Lags below it are tried [s]; a velocity that is later is of no use anyway.
        step: Step between the lags that are tried [s].
        spread: Half of the 95 % interval of the lag [s]: that by which a grid of this step rounds.
        spread_of_period: The same in sample periods, where these are longer.
        slowest: Longest sample period [s] of a recording in which a lag is looked for: slower ones do not show it.
        left: Part of the difference between velocity and derivative that a lag may leave: noise of a slow motion leaves
            nearly all of it.
        smooth: Width over which both are smoothed [s]: else a lag would do for the encoder's steps what smoothing does.
        least_smooth: The same in samples, where these are further apart.
        scale: Relative error of the velocity's scale beyond which it is another quantity, or in another unit.
    """

    least: float = 3e-3
    longest: float = 0.041
    step: float = 5e-4
    by_differences: float = 1.6
    spread: float = 3e-4
    spread_of_period: float = 0.15
    slowest: float = 0.012
    left: float = 0.5
    smooth: float = 0.015
    least_smooth: float = 1.5
    scale: float = 0.1


AGREEMENT = AgreementSettings()
ALIASES = AliasSettings()
CONFIRMATION = ConfirmationSettings()
FORETELLING = ForetellingSettings()
GATES = GateSettings()
IN_PLACE = InPlaceSettings()
LOCATION = LocationSettings()
NEEDS = NeedSettings()
UNDETERMINED = UndeterminedSettings()
OVERTONES = OvertoneSettings()
PARAMETERS = ParameterSettings()
REPETITIONS = RepetitionSettings()
VELOCITY = VelocitySettings()
