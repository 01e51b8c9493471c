"""What an identification works on: friction points, checked once."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

LARGEST = 1e100
"""Of any number [N·m, N, rad/s, m/s]: squares of it are still finite, and no joint is near it."""


@dataclass(frozen=True)
class Observations:
    """Friction points in the direction of motion; points at rest carry nothing and are left out.

    Attributes:
        speed: |v| > 0 [rad/s] or [m/s]. Shape (n_points,).
        forward: Whether v > 0. Shape (n_points,).
        magnitude: Friction torque times sgn(v) [N·m] or [N]. Shape (n_points,).
        normal_load: Normal load, or None. Shape (n_points,).
        kept: Positions of the points in the arrays that were given. Shape (n_points,).
        count: How many measured points each stands for; None for one. Shape (n_points,).
    """

    speed: FloatArray
    forward: np.ndarray[tuple[int], np.dtype[np.bool_]]
    magnitude: FloatArray
    normal_load: FloatArray | None
    kept: np.ndarray[tuple[int], np.dtype[np.intp]]
    count: FloatArray | None = None

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.speed)

    @property
    def total(self) -> float:
        """Number of measured points that they stand for."""
        return float(self.size if self.count is None else np.sum(self.count))

    @property
    def root_count(self) -> FloatArray:
        """Square root of how many points each stands for. Shape (n_points,)."""
        return np.ones(self.size) if self.count is None else np.sqrt(self.count)

    @property
    def sign(self) -> FloatArray:
        """+1 forward, -1 in reverse. Shape (n_points,)."""
        return np.where(self.forward, 1.0, -1.0)

    @property
    def velocity(self) -> FloatArray:
        """Velocity [rad/s] or [m/s]. Shape (n_points,)."""
        return self.sign * self.speed

    @property
    def torque_scale(self) -> float:
        """Largest friction torque [N·m] or [N]."""
        return float(np.max(np.abs(self.magnitude)))

    def compute_asymmetry(self) -> float | None:
        """Half of what friction is larger forward than in reverse, over the speeds of both; None if these are apart.

        A constant torque offset of this size [N·m] or [N] looks the same.
        """
        order = np.argsort(self.speed, kind="stable")
        ahead, back = order[self.forward[order]], order[~self.forward[order]]
        if not len(ahead) or not len(back):
            return None
        low, high = np.maximum(*self.speed[[ahead[0], back[0]]]), np.minimum(*self.speed[[ahead[-1], back[-1]]])
        if low > high:
            return None
        speed = np.unique(np.clip(self.speed, low, high))
        sides = [np.interp(speed, self.speed[side], self.magnitude[side]) for side in (ahead, back)]
        return float(np.mean(sides[0] - sides[1])) / 2.0

    def select(self, index: np.ndarray[tuple[int], np.dtype[np.intp]]) -> Observations:
        """The points at the positions `index`, or where a mask is true."""
        load = None if self.normal_load is None else self.normal_load[index]
        count = None if self.count is None else self.count[index]
        return Observations(
            self.speed[index], self.forward[index], self.magnitude[index], load, self.kept[index], count
        )

    def with_magnitude(self, magnitude: FloatArray) -> Observations:
        """The same points with other friction torques."""
        return replace(self, magnitude=magnitude)

    def counting(self, count: FloatArray) -> Observations:
        """The same points, each for so many measured ones."""
        return replace(self, count=count)


def list_places(velocity: FloatArray, normal_load: FloatArray | None = None) -> Observations:
    """Points at which a law is evaluated: their torques are 1. Both of shape (n,); no velocity is zero."""
    index = np.arange(len(velocity), dtype=np.intp)
    return Observations(np.abs(velocity), velocity > 0.0, np.ones_like(velocity), normal_load, index)


def observe(velocity: ArrayLike, torque: ArrayLike, normal_load: ArrayLike | None = None) -> Observations:
    """Check friction points and take those in motion.

    Args:
        velocity: [rad/s] or [m/s]. Shape (n,).
        torque: Friction torque, with the sign of the velocity [N·m] or [N]. Shape (n,).
        normal_load: One load for all points or one a point. Shape () or (n,).

    Raises:
        IdentificationError: Lengths differ, a value is not finite or beyond 1e100, a
            load is not positive, no point is in motion, no torque is there, or friction opposes its sign convention.
    """
    v, tau = _read_column("velocity", velocity), _read_column("torque", torque)
    if len(v) != len(tau):
        raise IdentificationError(f"velocity has {len(v)} values and torque has {len(tau)}; give one torque a velocity")
    load = None
    if normal_load is not None:
        given = np.asarray(normal_load, dtype=np.float64)
        load = _read_column("normal_load", np.full(len(v), given) if given.ndim == 0 else given)
        if len(load) != len(v) or np.any(load <= 0.0):
            raise IdentificationError(
                f"normal_load must be positive, one value for all {len(v)} points or one a point; "
                f"got {len(load)} values, the smallest {load.min(initial=np.inf):g}"
            )
    kept = np.flatnonzero(v != 0.0)
    if not len(kept):
        raise IdentificationError("all points are at rest; friction parameters need points in motion")
    magnitude = tau[kept] * np.sign(v[kept])
    if np.max(np.abs(magnitude)) < 1.0 / LARGEST:
        raise IdentificationError("all torques are zero: the column is empty, or it is not that of the torque")
    if np.mean(magnitude) < 0.0:
        raise IdentificationError(
            "friction torque must have the sign of the velocity (it is what overcomes friction); most of these "
            "points have the opposite sign: pass -torque"
        )
    return Observations(np.abs(v[kept]), v[kept] > 0.0, magnitude, None if load is None else load[kept], kept)


def _read_column(name: str, values: ArrayLike) -> FloatArray:
    array = np.asarray(values, dtype=np.float64).ravel()
    bad = np.flatnonzero(~np.isfinite(array))
    if len(bad):
        raise IdentificationError(f"{name}[{bad[0]}] is {array[bad[0]]}; remove or repair such points first")
    wild = np.flatnonzero(np.abs(array) > LARGEST)
    if len(wild):
        raise IdentificationError(
            f"{name}[{wild[0]}] is {array[wild[0]]:g}, which is no measured value: remove or repair such points first"
        )
    return array
