"""The rigid body of one joint, fitted to filtered samples beside its friction."""

from dataclasses import dataclass, replace

import numpy as np

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

from ..identification import IdentificationResult
from ..identification.estimation.correlated_fit import CorrelatedFit, solve_correlated
from .joint_samples import JointSamples
from .torque_lag import NOISE_KNOWN

Rows = np.ndarray[tuple[int], np.dtype[np.bool_]]
NOT_APART = (
    "the motion does not tell inertia, friction and gravity apart: record one with several speeds and both directions"
)
REACH = 25
"""Samples over which errors go together: five periods of the low-pass's cutoff, over which its answer has died out."""
_MOST_SHRUNK = 0.9
"""Part by which noise may have shrunk an inertia, and it is still corrected; beyond, its deviation says that nothing is
known of it."""
_NOTHING_SEEN = 0.999
"""The same where all of an acceleration may be noise: an inertia then comes out as a thousandth of what it is."""
_NOISE_AT_MOST = 3.0
"""Power of the noise of an acceleration over that of white noise, up to which it may be: at a constant speed the steps
of an encoder are lines, which lie within the low-pass or beside it. On 18 simulated recordings at constant speeds it
was between 0.05 and 2.9 times as much, on 27 that swing between 0.5 and 1.7."""


@dataclass(frozen=True)
class RigidBodyFit:
    """torque = inertia a + F_v v + F_c sgn(v) + offset + g_c cos(q) + g_s sin(q)

    Attributes:
        inertia: [kg·m²] or [kg].
        viscous_coefficient: [N·m·s/rad] or [N·s/m].
        coulomb_torque: [N·m] or [N].
        offset: [N·m] or [N].
        gravity: g_c and g_s [N·m]; zeros where gravity was not fitted.
        standard_deviations: Of inertia, viscous coefficient, Coulomb torque and offset, for correlated errors.
        gravity_deviations: Of g_c and g_s [N·m].
        residual: Root mean square of what is left, as a fraction of the torque's.
        stiffness: Of a spring [N·m/rad] or [N/m] with its standard deviation; zeros where none was fitted.
    """

    inertia: float
    viscous_coefficient: float
    coulomb_torque: float
    offset: float
    gravity: tuple[float, float]
    standard_deviations: tuple[float, ...]
    gravity_deviations: tuple[float, float]
    residual: float
    stiffness: tuple[float, float] = (0.0, 0.0)

    def rigid_torque(self, samples: JointSamples) -> FloatArray:
        """Torque of inertia, gravity and offset. Shape (n,)."""
        g_c, g_s = self.gravity
        gravity = g_c * np.cos(samples.position) + g_s * np.sin(samples.position)
        return np.asarray(self.inertia * samples.acceleration + self.offset + gravity)


def fit_rigid_body(
    samples: JointSamples, *, gravity: bool = False, spring: bool = False, rows: Rows | None = None
) -> RigidBodyFit:
    """Least squares for inertia, symmetric Coulomb and viscous friction, offset, and gravity and a spring if asked.

    Args:
        samples: Filtered samples.
        gravity: Whether gravity acts.
        spring: Whether a spring does.
        rows: Which of them count; all by default, which is right only where the joint never rests. Shape (n,).

    Raises:
        IdentificationError: The motion does not excite all of them.
    """
    chosen = np.ones(len(samples.torque), dtype=bool) if rows is None else rows
    if not chosen.any():
        raise IdentificationError(NOT_APART)
    has_offset = not is_one_way(samples.velocity[chosen])
    body = list_body_columns(samples, gravity, has_offset=has_offset)[chosen]
    position = samples.position[chosen]
    springs = [position - np.mean(position)] if spring and len(position) else []
    columns = np.column_stack([body, *springs, samples.velocity[chosen], samples.direction[chosen]])
    if len(columns) < columns.shape[1]:
        raise IdentificationError(NOT_APART)
    torque = samples.torque[chosen]
    fit = solve_correlated(columns, torque, np.flatnonzero(chosen), REACH)
    if fit.rank < columns.shape[1]:
        raise IdentificationError(NOT_APART)
    viscous, coulomb = fit.solution[-2:].tolist()
    deviations = tuple(np.sqrt(np.diag(fit.covariance))[-2:].tolist())
    residual = float(np.sqrt(np.mean(fit.error**2) / max(float(np.mean(torque**2)), 1e-300)))
    empty = RigidBodyFit(0.0, viscous, coulomb, 0.0, (0.0, 0.0), (0.0, *deviations, 0.0), (0.0, 0.0), residual)
    if springs:
        at = body.shape[1]
        empty = replace(empty, stiffness=(float(fit.solution[at]), float(np.sqrt(fit.covariance[at, at]))))
    return with_body(empty, fit, gravity, has_offset=has_offset)


def is_one_way(velocity: FloatArray) -> bool:
    """Whether all of these samples go one way: then friction and a constant torque are one, and count as friction."""
    return bool(np.all(velocity > 0.0) or np.all(velocity < 0.0))


def list_body_columns(samples: JointSamples, gravity: bool, *, has_offset: bool) -> FloatArray:
    """What inertia, gravity and offset multiply, in this order. Shape (n, n_body)."""
    columns = [samples.acceleration]
    columns += [np.cos(samples.position), np.sin(samples.position)] if gravity else []
    columns += [np.ones_like(samples.torque)] if has_offset else []
    return np.stack(columns, axis=1)


def fit_together(
    body: FloatArray,
    left: FloatArray,
    found: IdentificationResult,
    at: np.ndarray[tuple[int], np.dtype[np.intp]],
    more: FloatArray | None = None,
    reach: int = REACH,
    noise: float = 0.0,
) -> CorrelatedFit:
    """Rigid body and small changes of the friction parameters, fitted at once.

    Gravity over a short way and friction that differs between the directions are nearly the same: fitted in turns they
    would creep towards the optimum, and each would look as certain as if the other were known.

    Args:
        body: Columns of the rigid body at the samples that slide. Shape (n, n_body).
        left: Torque without the friction of `found` [N·m] or [N]. Shape (n,).
        found: Friction identified so far.
        at: Position of each sample in time. Shape (n,).
        more: Further columns, which come last. Shape (n, n_more).
        reach: Samples over which errors go together.
        noise: Standard deviation of the acceleration's noise, whose shrinking is undone [rad/s²] or [m/s²].
    """
    columns = np.hstack([body, compute_slopes(found)] if more is None else [body, compute_slopes(found), more])
    fit = solve_correlated(columns, left, at, reach)
    return _undo_shrinking(fit, columns, noise) if noise > 0.0 else fit


def _undo_shrinking(fit: CorrelatedFit, columns: FloatArray, noise: float) -> CorrelatedFit:
    """The fit without the part by which noise in the acceleration, its first column, shrinks the inertia.

    That is the noise's share of what the other columns leave of the acceleration [fuller1987measurement], and they take
    over what the inertia loses. As the noise is known to a part only, so is the correction; the inertia's deviation
    holds that all of the acceleration may be noise.

    Args:
        fit: Of these columns.
        columns: Shape (n, n_fit).
        noise: Standard deviation of the acceleration's noise [rad/s²] or [m/s²].
    """
    others = columns[:, 1:] / np.maximum(np.linalg.norm(columns[:, 1:], axis=0), 1e-300)
    held = np.linalg.lstsq(others, columns[:, 0], rcond=None)[0]
    alone = float(np.sum((columns[:, 0] - others @ held) ** 2))
    share = min(len(columns) * noise**2 / max(alone, 1e-300), _MOST_SHRUNK)
    along = np.concatenate([[1.0], -held / np.maximum(np.linalg.norm(columns[:, 1:], axis=0), 1e-300)])
    moved = share / (1.0 - share) if share < _MOST_SHRUNK else 0.0  # of noise alone it would make noise of friction
    back = np.eye(len(along))
    back[:, 0] += moved * along
    doubt = NOISE_KNOWN * moved * float(fit.solution[0]) * along
    most = min(_NOISE_AT_MOST * share, _NOTHING_SEEN)
    doubt[0] = (most / (1.0 - most) - moved) * np.hypot(fit.solution[0], np.sqrt(fit.covariance[0, 0]))
    return fit._replace(
        solution=back @ fit.solution, covariance=back @ fit.covariance @ back.T + np.outer(doubt, doubt)
    )


def compute_slopes(found: IdentificationResult) -> FloatArray:
    """What a small change of each friction parameter does to its points. Shape (n, n_parameters)."""
    optimum = found.at_points
    return np.asarray(found.observations.sign[:, None] * optimum.jacobian / np.exp(optimum.logs))


def with_body(rigid: RigidBodyFit, fit: CorrelatedFit, gravity: bool, *, has_offset: bool) -> RigidBodyFit:
    """`rigid` with inertia, gravity and, where `fit` has it, offset of `fit`, which come first in it."""
    values, deviations = fit.solution.tolist(), np.sqrt(np.diag(fit.covariance)).tolist()
    last = 3 if gravity else 1
    _, viscous, coulomb, of_offset = rigid.standard_deviations
    return replace(
        rigid,
        inertia=values[0],
        gravity=(values[1], values[2]) if gravity else (0.0, 0.0),
        offset=values[last] if has_offset else rigid.offset,
        standard_deviations=(deviations[0], viscous, coulomb, deviations[last] if has_offset else of_offset),
        gravity_deviations=(deviations[1], deviations[2]) if gravity else (0.0, 0.0),
    )
