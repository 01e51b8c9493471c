"""Gravity that no model knows, from plateaus over the same positions in both directions, and the age of the torque.

A torque signal that is old by t_l reads G(q - v t_l) at the position q. Half the difference of both directions takes
G(q) off, but leaves v t_l G'(q) in the friction, which looks like viscous friction. Gravity itself is the mean of both
directions; its curves come apart by 2 v t_l, and that is seen over the travel:

    tau = G(q - v t_l) + s F(v) + s P(q),   s = sgn(v),

with polynomials G and P, and a level F of its own for each plateau. P is friction that depends on the position or
grows with the load: it is the same at every speed, where the age tells more the faster the joint goes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import chebyshev

from fricomp.laws import FloatArray

from .point import SettledPart

__all__ = ["LAG_PRIOR", "GravityFit", "fit_gravity"]

LAG_PRIOR = (0.003, 0.003)
"""How old a torque signal is where nothing is measured, with its standard deviation [s]: a filter of the current of
some milliseconds, half a period, and the way over the bus."""
# Standard error of the age that ripple of the motor, alike in every plateau, leaves at least [s]; above `VAGUE`
# times the prior's deviation the plateaus tell too little, and so they do `FAR` deviations from what can be.
LEAST, VAGUE, FAR = 5e-4, 0.5, 3.0
# Degrees of G (a sine over nearly a turn to a ten-thousandth) and of P (the bend where the load changes its sign).
GRAVITY_DEGREE, FRICTION_DEGREE = 8, 6
# Plateaus over less than this fraction of the longest way say nothing of either [1].
LONG = 0.02
# Parts of the way whose errors are taken as independent.
SECTIONS = 4
# Fewest plateaus in pairs, and steps towards the best age.
FEWEST_PARTS, STEPS = 4, 4
# Age beyond which a step towards the best one is lost [s].
LARGEST = 0.1


@dataclass(frozen=True)
class GravityFit:
    """Gravity over the position, up to a constant, and the age of the torque.

    Attributes:
        lag: Age of the torque beside the position [s].
        lag_deviation: Its standard error [s].
        is_measured: Whether the plateaus have told the age; else it is `LAG_PRIOR`.
        coefficients: Of Chebyshev polynomials in (q - middle) / half [N·m] or [N]. Shape (n,).
        middle: Of the positions that were seen [rad] or [m].
        half: Of their span [rad] or [m].
    """

    lag: float
    lag_deviation: float
    is_measured: bool
    coefficients: FloatArray
    middle: float
    half: float

    def torque(self, position: FloatArray) -> FloatArray:
        """Gravity [N·m] or [N]; outside of what was seen as at its edge. Shape (n_samples,)."""
        place = np.clip((position - self.middle) / self.half, -1.0, 1.0)
        return np.asarray(chebyshev.chebval(place, self.coefficients))

    def attach(self, part: SettledPart) -> SettledPart:
        """A part with this gravity as its rigid-body torque."""
        samples = part.samples
        return replace(part, samples=samples.with_channels(load_torque=self.torque(samples.position)))


@dataclass(frozen=True)
class _Rows:
    """Samples of all plateaus that count, one below the other. Shape (n_samples,) each."""

    position: FloatArray
    velocity: FloatArray
    torque: FloatArray
    part: np.ndarray[tuple[int], np.dtype[np.intp]]
    section: np.ndarray[tuple[int], np.dtype[np.intp]]

    def within(self, columns: FloatArray) -> FloatArray:
        """Columns less their mean over each plateau: what a level of its own leaves of them."""
        count = np.bincount(self.part).astype(np.float64)
        means = np.column_stack([np.bincount(self.part, weights=column) / count for column in columns.T])
        return np.asarray(columns - means[self.part])


def fit_gravity(parts: Sequence[SettledPart]) -> GravityFit | None:
    """Gravity and the age of the torque from plateaus cut to the same positions; None where there are too few.

    Args:
        parts: Forward and reverse of each pair, see `match_windows`.
    """
    spans = [float(np.ptp(part.samples.position)) for part in parts]
    used = [part for part, span in zip(parts, spans, strict=True) if span > LONG * max(spans) and len(part.samples) > 1]
    if len(used) < FEWEST_PARTS:
        return None
    rows = _build_rows(used)
    middle = 0.5 * float(rows.position.max() + rows.position.min())
    half = 0.5 * float(np.ptp(rows.position))
    lag, deviation, coefficients = 0.0, np.inf, np.zeros(GRAVITY_DEGREE + 1)
    for _ in range(STEPS):
        step, deviation, coefficients = _improve(rows, lag, middle, half)
        lag = float(np.clip(lag + step, -LARGEST, LARGEST))
    return GravityFit(*_weigh_belief(lag, deviation), coefficients, middle, half)


def _weigh_belief(lag: float, deviation: float) -> tuple[float, float, bool]:
    """Age and standard error [s] from what was measured and what can be, and whether the measurement had a say."""
    usual, spread = LAG_PRIOR
    deviation = float(np.hypot(deviation, LEAST))
    if not (deviation <= VAGUE * spread and abs(lag - usual) <= FAR * float(np.hypot(deviation, spread))):
        return usual, spread, False
    weight = 1.0 / (1.0 + (deviation / spread) ** 2)
    return weight * lag + (1.0 - weight) * usual, float(np.sqrt(weight)) * deviation, True


def _improve(rows: _Rows, lag: float, middle: float, half: float) -> tuple[float, float, FloatArray]:
    """A Gauss-Newton step of the age [s], its standard error [s], and gravity at the age so far."""
    place = (rows.position - rows.velocity * lag - middle) / half
    gravity = chebyshev.chebvander(place, GRAVITY_DEGREE)[:, 1:]
    friction = chebyshev.chebvander((rows.position - middle) / half, FRICTION_DEGREE)[:, 1:]
    columns = rows.within(np.column_stack([gravity, np.sign(rows.velocity)[:, None] * friction]))
    torque = rows.within(rows.torque[:, None])[:, 0]
    basis, triangle = np.linalg.qr(columns)
    found = np.linalg.lstsq(triangle, basis.T @ torque, rcond=1e-10)[0]
    coefficients = np.concatenate([[0.0], found[:GRAVITY_DEGREE]])
    slope = chebyshev.chebval(place, chebyshev.chebder(coefficients)) / half
    change = rows.within((-rows.velocity * slope)[:, None])[:, 0]
    change = change - basis @ (basis.T @ change)
    power = float(change @ change)
    if power <= 0.0:
        return 0.0, float("inf"), coefficients
    step = float(change @ torque) / power
    left = torque - columns @ found - step * change
    return step, _compute_error(rows, change, left) / power, coefficients


def _compute_error(rows: _Rows, change: FloatArray, left: FloatArray) -> float:
    """Standard deviation of what errors, alike over a section of the way, do to change @ torque."""
    n_parts = int(rows.part.max()) + 1
    sums = np.bincount(rows.part * SECTIONS + rows.section, weights=change * left, minlength=n_parts * SECTIONS)
    count = len(sums)
    return float(np.sqrt(np.sum(sums**2) * count / (count - 1)))


def _build_rows(parts: Sequence[SettledPart]) -> _Rows:
    position = [part.samples.position for part in parts]
    speed = [np.full(len(q), (q[-1] - q[0]) / part.samples.duration) for part, q in zip(parts, position, strict=True)]
    section = [np.arange(len(q)) * SECTIONS // len(q) for q in position]
    return _Rows(
        np.concatenate(position),
        np.concatenate(speed),
        np.concatenate([part.samples.torque for part in parts]),
        np.repeat(np.arange(len(parts)), [len(q) for q in position]),
        np.concatenate(section),
    )
