"""One joint's inertia, gravity, offset and friction from a recorded motion, by filtered regression.

Torque and regressors pass through the same low-pass filter and are decimated together [gautier1997filtering], so the
filter cancels; position is differentiated after a zero-phase low-pass. Only samples that slide count: at rest friction
is whatever holds the joint, such as minus gravity, which a fit would take for gravity and inertia. Rigid body and
friction law are fitted together, a torque that comes late is shifted, and deviations hold for errors that are
correlated.
"""

from dataclasses import dataclass, replace

import numpy as np

from fricomp.blas import one_blas_thread
from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

from ..identification import IdentificationOptions, IdentificationResult, identify
from ..identification.doubt import refuse_impossible, with_covariance, with_open_profiles
from ..identification.estimation.correlated_fit import CorrelatedFit
from ..identification.estimation.form import separable_law
from .joint_samples import FEWEST_SLIDING, JointSamples, RegressionSettings
from .rigid_body import (
    NOT_APART,
    REACH,
    RigidBodyFit,
    Rows,
    compute_slopes,
    fit_rigid_body,
    fit_together,
    is_one_way,
    list_body_columns,
    with_body,
)
from .torque_lag import TorqueLag, estimate_lag
from .verdict import weigh_rivals, with_lag_note, with_offset_note

_DEFAULTS = RegressionSettings()
_SLOW = 60.0
"""Rate below which a diagnosis has a mode of its own [Hz], which a joint that sticks and slips does not stop."""
_SEEN = 2.0
"""Periods of its cutoff that a low-pass sees: before and after a reversal it rings by more than a hundredth."""
_DRIVES = (
    "what inertia and gravity leave of the torque drives the joint at most of the speeds, which friction does not: "
    "something else moves the joint, gravity is not what was asked for (--gravity), or the torque has the other sign"
)
_REFINEMENTS = 3
"""Times that friction and rigid body are refined; a third one moved parameters by less than a standard deviation."""
_LAG_STEPS = 6
"""Times that the lag of the torque is taken off anew, at most; two or three are enough for 20 ms."""
_LAG_SETTLED = 0.1
"""Step of the lag that is too small to take, in its standard deviations."""
_NO_WORSE = 1.1
"""Residual after a lag was taken off over that before it, above which the lag was none: jumps ring in both slopes."""
_LENGTHS = tuple(np.geomspace(1e-5, 0.01, 13).tolist())
"""Lengths of presliding to try, as fractions of the range of the motion; four of the last are 4 % of the range."""
_SETTLED = 4.0
"""Lengths of presliding after which friction is that of sliding: what it lacks has come down to exp(-4) = 2 %."""
_EVIDENCE = 16.0
"""Twice the gain in log-likelihood that presliding must bring: four standard deviations."""


@dataclass(frozen=True)
class MotionIdentification:
    """A joint identified from a recorded motion.

    Attributes:
        rigid_body: Inertia, gravity and offset, with the symmetric friction fitted beside them. The offset is 0 where
            the law has friction of its own in each direction: sliding cannot tell one from the other.
        friction: The friction law fitted to what they leave.
        points: Friction points behind it: velocity and torque. Shape (n, 2).
        lag: How late the torque comes, which has been taken off, also in `points`.
        presliding: Way after each rest and reversal that is left out since friction builds up on it [rad] or [m].
        alike: How many of the samples count as one, because their errors go together.
    """

    rigid_body: RigidBodyFit
    friction: IdentificationResult
    points: FloatArray
    lag: TorqueLag
    presliding: float = 0.0
    alike: float = 1.0


@one_blas_thread()
def identify_motion(
    samples: JointSamples,
    settings: RegressionSettings = _DEFAULTS,
    *,
    law: str = "stribeck",
    options: IdentificationOptions | None = None,
) -> MotionIdentification:
    """Identify rigid body and friction from the filtered samples that slide.

    Where friction has to build up over some way after a rest or a reversal, that way is left out too: neither is it
    sliding friction. A constant torque and friction that differs between the directions look alike while the joint
    slides: a law with a curve for each direction takes the whole of it, and says so, unless friction would have to
    drive the joint in one of them, or that torque may be gravity's.

    Raises:
        IdentificationError: The motion does not tell the parts apart.
    """
    chosen = replace(options or IdentificationOptions(), independent=False)
    bends = bool(separable_law(law).basis.shape_index)
    fit = _fit_aligned(samples, settings, _select_sliding(samples, settings.slowest, bends=bends), law, chosen)
    presliding = _SETTLED * _find_presliding(settings, fit)
    if presliding > 0.0:
        fit = _fit_aligned(
            samples, settings, _select_sliding(samples, settings.slowest, presliding, bends=bends), law, chosen
        )
    friction = fit.friction()
    velocity = samples.velocity[fit.rows]
    result = identify(velocity, friction, noise="absolute", law=law, options=chosen)
    together = fit.together(result)
    n_body = fit.columns.shape[1]
    result = with_covariance(result, fit.lag.widen(together.covariance)[n_body:, n_body:])
    alone = fit_together(fit.columns, fit.left, result, np.flatnonzero(fit.rows), reach=1)
    ratio = np.diag(together.covariance)[n_body:] / np.maximum(np.diag(alone.covariance)[n_body:], 1e-300)
    counts_as_one = max(1.0, float(np.max(ratio)))
    result = with_open_profiles(weigh_rivals(result, fit.found, counts_as_one))
    result = with_lag_note(result, fit.lag)
    result = refuse_impossible(result, velocity, (fit.rigid.inertia, fit.rigid.standard_deviations[0]))
    if fit.shares_offset:
        result = with_offset_note(result, fit.symmetric_offset)
    points = np.stack([velocity, friction], axis=1)
    return MotionIdentification(fit.rigid, result, points, fit.lag, presliding, counts_as_one)


@dataclass(frozen=True)
class _SlidingFit:
    """Rigid body and friction of the samples that slide.

    Attributes:
        samples: All samples, their torque rid of its lag as far as it is known.
        rows: Which samples. Shape (n_samples,).
        columns: What the rigid body's parameters multiply, at them. Shape (n, n_body).
        left: Torque without friction, and without an offset that is not fitted, at them [N·m] or [N]. Shape (n,).
        mixed: What the low-pass does to friction at all samples [N·m] or [N]. Shape (n_samples,).
        rigid: The rigid body.
        found: The friction.
        slope: Of the fitted torque over time, at them [N·m/s] or [N/s]. Shape (n,).
        lag: How late the torque comes, with what was taken off.
        shares_offset: Whether friction takes the offset.
        symmetric_offset: Offset beside symmetric friction [N·m] or [N].
    """

    samples: JointSamples
    rows: Rows
    columns: FloatArray
    left: FloatArray
    mixed: FloatArray
    rigid: RigidBodyFit
    found: IdentificationResult
    slope: FloatArray
    lag: TorqueLag
    shares_offset: bool
    symmetric_offset: float

    def friction(self) -> FloatArray:
        """Friction points: what the rigid body leaves of the torque [N·m] or [N]. Shape (n,)."""
        return np.asarray((self.samples.torque - self.rigid.rigid_torque(self.samples) - self.mixed)[self.rows])

    def together(
        self, found: IdentificationResult, more: FloatArray | None = None, reach: int = REACH
    ) -> CorrelatedFit:
        """Rigid body, small changes of friction and `more` fitted at once; more at the end. Shape (n, n_more)."""
        noise = self.samples.recorded.acceleration_noise if more is None else 0.0
        return fit_together(self.columns, self.left, found, np.flatnonzero(self.rows), more, reach, noise)


def _select_sliding(samples: JointSamples, slowest: float, travel: float = 0.0, *, bends: bool) -> Rows:
    """Which samples slide; refuses a motion with too few. Shape (n,)."""
    rows = samples.sliding(slowest, travel, bends=bends)
    count = int(np.count_nonzero(rows))
    if count < FEWEST_SLIDING:
        sees, rate = _SEEN / samples.recorded.cutoff, 1.0 / samples.recorded.period
        how = "compares on the mean" if rate < _SLOW else "simulates the joint, for which 5 s are enough"
        raise IdentificationError(
            f"{NOT_APART}; of {len(rows)} filtered samples {count} slide in one direction for as long as the low-pass "
            f"sees, which is some {sees:.2g} s at {rate:.3g} Hz and with this encoder, and {FEWEST_SLIDING} are "
            f"needed: record for longer, faster, or let the joint move in one direction for longer; or take 'fricomp "
            f"diagnose', which {how}, and writes friction.json as well"
        )
    return rows


def _fit_aligned(
    samples: JointSamples, settings: RegressionSettings, rows: Rows, law: str, options: IdentificationOptions
) -> _SlidingFit:
    """Rigid body and friction with the torque at the time of the motion that it belongs to."""
    fit = first = _fit_sliding(samples, settings, rows, law, options, 0.0)
    for _ in range(_LAG_STEPS):
        lag = float(np.clip(fit.lag.value, -settings.margin, settings.margin))  # beyond, parts have no torque
        if fit.lag.step < _LAG_SETTLED or lag == fit.lag.taken_off:
            break
        aligned = replace(samples, torque=samples.recorded.torque_after(lag))
        later = _fit_sliding(aligned, settings, rows, law, options, lag)
        if later.rigid.residual > _NO_WORSE * fit.rigid.residual:
            is_shown = fit.rigid.residual * _NO_WORSE < first.rigid.residual
            return _with_unknown_lag(fit if is_shown else first, settings)  # what shows nowhere is not taken off
        fit = later
    return fit


def _with_unknown_lag(fit: _SlidingFit, settings: RegressionSettings) -> _SlidingFit:
    """The fit where its motion tells no lag: that is what was taken off, as uncertain as before the motion was seen."""
    lag = replace(fit.lag, value=fit.lag.taken_off, deviation=fit.lag.unknown)
    together = fit.together(fit.found)
    together = together._replace(covariance=lag.widen(together.covariance))
    has_offset = fit.columns.shape[1] > (3 if settings.gravity else 1)
    return replace(fit, lag=lag, rigid=with_body(fit.rigid, together, settings.gravity, has_offset=has_offset))


def _fit_sliding(
    samples: JointSamples,
    settings: RegressionSettings,
    rows: Rows,
    law: str,
    options: IdentificationOptions,
    lag: float,
) -> _SlidingFit:
    """Rigid body and friction in turns, each rigid body fitted together with small changes of the friction.

    Args:
        samples: All samples.
        settings: Whether gravity acts.
        rows: Which samples slide. Shape (n_samples,).
        law: The law of friction.
        options: Of its identification.
        lag: What their torque was rid of [s].
    """
    rigid = fit_rigid_body(samples, gravity=settings.gravity, rows=rows)
    symmetric_offset = rigid.offset
    bidirectional = separable_law(law).bidirectional  # its curves hold any offset: fitted beside them it is anything
    shares_offset = bidirectional and not settings.level_gravity and abs(symmetric_offset) < rigid.coulomb_torque
    if shares_offset:
        rigid = replace(rigid, offset=0.0, standard_deviations=(*rigid.standard_deviations[:3], 0.0))
    velocity, mixed = samples.velocity[rows], np.zeros_like(samples.torque)
    has_offset = not bidirectional and not is_one_way(velocity)
    columns = list_body_columns(samples, settings.gravity, has_offset=has_offset)[rows]
    for refinement in range(_REFINEMENTS):
        friction = (samples.torque - rigid.rigid_torque(samples) - mixed)[rows]
        if np.mean(friction * np.sign(velocity)) < 0.0:
            raise IdentificationError(_DRIVES)
        found = identify(velocity, friction, None, "least_squares", "absolute", law=law, options=options)
        filtered = samples.recorded.filtered_torque(found.model)
        mixed = filtered - np.asarray(found.model.torque(samples.velocity))
        left = (samples.torque - filtered)[rows] - (rigid.offset if bidirectional else 0.0)
        noise = samples.recorded.acceleration_noise
        reach = REACH if refinement == _REFINEMENTS - 1 else 1  # how sure it is, is asked of the last one alone
        together = fit_together(columns, left, found, np.flatnonzero(rows), reach=reach, noise=noise)
        rigid = with_body(rigid, together, settings.gravity, has_offset=has_offset)
    slope = np.gradient(rigid.rigid_torque(samples) + filtered, samples.recorded.time)[rows]
    measured = np.gradient(samples.torque, samples.recorded.time)[rows]
    targets = (slope, measured, left)
    late = estimate_lag(lag, np.hstack([columns, compute_slopes(found)]), targets, rows, REACH, samples.recorded)
    together = together._replace(covariance=late.widen(together.covariance))
    rigid = with_body(rigid, together, settings.gravity, has_offset=has_offset)
    return _SlidingFit(samples, rows, columns, left, mixed, rigid, found, slope, late, shares_offset, symmetric_offset)


def _find_presliding(settings: RegressionSettings, fit: _SlidingFit) -> float:
    """Length over which friction builds up after a rest or a reversal [rad] or [m]; 0 where none shows.

    Bristles deflect before they slip: friction lacks a part that dies out exponentially with the way [dahl1968].
    Errors that go together count as one, else any misfit of the law would pass for presliding; what a torque that comes
    late would explain does not count.
    """
    samples = fit.samples
    plain = fit.together(fit.found, fit.slope[:, None], reach=1).error  # deviations are not looked at here
    best = float(plain @ plain) * np.exp(-_EVIDENCE * REACH / len(plain))
    found = 0.0
    for length in np.array(_LENGTHS) * np.ptp(samples.position):
        lacking = samples.recorded.presliding(settings.slowest * samples.top_speed, float(length))[fit.rows]
        together = fit.together(fit.found, np.column_stack([fit.slope, lacking]), reach=1)
        left_over = float(together.error @ together.error)
        if left_over < best and together.solution[-1] < 0.0:
            best, found = left_over, float(length)
    return found
