"""First estimate of the base model: least squares in weak form, where no acceleration is ever formed.

For a test function phi that vanishes at the ends of its window, the integral of phi J q'' is that of phi'' J q.
Rows lie where the joint keeps moving in one direction; the two Stribeck velocities are found by variable projection.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_erosion
from scipy.optimize import minimize, nnls
from scipy.signal import fftconvolve

from fricomp.errors import DiagnosisError

from ..inputs.rigid import RigidJoint
from ..inputs.track import FloatArray, Track
from .observer import Plant
from .settings import JOINT

__all__ = ["estimate_beside", "estimate_plants", "estimate_rest_speed"]


def estimate_rest_speed(tracks: Sequence[Track], width: float = JOINT.row_width) -> float:
    """Estimate the speed below which samples say nothing about sliding [rad/s] or [m/s]. It is a small part of what the
    joint reaches, but at least the speed that one encoder step in a window of `width` [s] looks like."""
    top = max(float(np.quantile(np.abs(track.velocity), 0.98)) for track in tracks)
    step = max(track.resolution for track in tracks) / width
    return min(JOINT.rest_speed, max(JOINT.rest_share * top, step))


class WeakRows(NamedTuple):
    """Rows of the weak form: shape (n,) each, `gravity` of shape (n, 3), or (n, 1) of a linear joint, with the offset;
    `beside` of shape (n, k) what is looked for beside the plant."""

    torque: FloatArray
    inertia: FloatArray
    gravity: FloatArray
    beside: FloatArray
    velocity: FloatArray
    direction: FloatArray

    @property
    def free(self) -> int:
        """Number of the columns that may have either sign: of offset, gravity and what is beside."""
        return int(self.gravity.shape[1] + self.beside.shape[1])


def estimate_plants(
    tracks: Sequence[Track],
    *,
    width: float = JOINT.row_width,
    rest_speed: float | None = None,
    known: RigidJoint | None = None,
) -> tuple[Plant, ...]:
    """Estimate first plants from the moving parts of `tracks`. There is a second one where friction falls over all
    speeds and leaves little Coulomb torque: it has at least half of the friction in the slowest rows.

    Args:
        tracks: Recordings of one joint.
        width: Window of the test function [s].
        rest_speed: Slower samples take no part [rad/s]; None for that of `estimate_rest_speed`.
        known: Inertia and gravity of a simulation, which decide where the rows do not.

    Raises:
        DiagnosisError: Too few samples are faster.
    """
    rest_speed = estimate_rest_speed(tracks, width) if rest_speed is None else rest_speed
    positions = [track.position - track.position.mean() for track in tracks]
    sprung = _gather_rows(tracks, [(one,) for one in positions], width, rest_speed)
    falls, solution, chosen = _choose_beside(sprung, rest_speed, known)
    usual, level = (_build_plant(falls, solution, chosen, hold=hold) for hold in (False, True))
    return (usual,) if usual == level else (usual, level)


def estimate_beside(
    tracks: Sequence[Track],
    shapes: Sequence[Sequence[FloatArray]],
    *,
    width: float = JOINT.row_width,
    known: RigidJoint | None = None,
) -> tuple[int, float, Plant]:
    """Estimate a plant beside the torque of a known shape, of whatever size, that suits it best.

    Args:
        tracks: Recordings of one joint.
        shapes: Torques that may be there, of whatever size, along each of them [N·m] or [N]. Each of shape (n,).
        width: Window of the test function [s].
        known: Inertia and gravity of a simulation, which decide where the rows do not.

    Returns:
        Which of them, its size, and the plant beside it.

    Raises:
        DiagnosisError: The joint hardly ever slides.
    """
    rest_speed = estimate_rest_speed(tracks, width)
    joined = _gather_rows(tracks, list(zip(*shapes, strict=True)), width, rest_speed)
    rows, best = [joined._replace(beside=joined.beside[:, [k]]) for k in range(len(shapes))], 0
    if len(rows) > 1:
        falls, _ = _fit_falls(joined._replace(beside=joined.beside[:, :0]), rest_speed, known)
        best = int(np.argmin([_compute_cost(falls, one, known) for one in rows]))
    found = _fit_falls(rows[best], rest_speed, known)
    return best, float(found[1][rows[best].free]), _build_plant(*found, rows[best], hold=False)


def _gather_rows(
    tracks: Sequence[Track], beside: Sequence[Sequence[FloatArray]], width: float, rest_speed: float
) -> WeakRows:
    """Rows of all recordings, as many as are needed, beside the samples of some columns along each of them.

    Raises:
        DiagnosisError: There are too few.
    """
    rows = [_build_rows(track, width, rest_speed, own) for track, own in zip(tracks, beside, strict=True)]
    joined = WeakRows(*(np.concatenate(part) for part in zip(*rows, strict=True)))
    if joined.torque.size < 20:
        needed = max(2 * _measure_margin(track, width) * track.dt for track in tracks)
        raise DiagnosisError(
            f"the joint hardly ever slides faster than {rest_speed:g} rad/s (or m/s) in one direction for "
            f"{needed:.2g} s on end: record a faster motion, or where it moves in jumps, such as steps of a reference, "
            "one that goes on for longer in one direction"
        )
    keep = np.linspace(0, joined.torque.size - 1, min(JOINT.most_rows, joined.torque.size)).astype(int)
    return WeakRows(*(part[keep] for part in joined))


def _choose_beside(
    sprung: WeakRows, rest_speed: float, known: RigidJoint | None
) -> tuple[FloatArray, FloatArray, WeakRows]:
    """Fit the rows alone, beside a spring, or beside friction that grows with the load, where one of these takes most.

    Neither is a part of the plant: effects that the search may find, of which a strong one would pass for an inertia.

    Args:
        sprung: Rows with the column of a spring.
        rest_speed: Slower samples take no part [rad/s].
        known: Inertia and gravity of a simulation.

    Returns:
        Logarithms of both Stribeck velocities, shape (2,), what is linear beside them, shape (p,), and the rows.
    """
    alone = sprung._replace(beside=sprung.beside[:, :0])
    falls, solution = _fit_falls(alone, rest_speed, known)
    most = JOINT.beside_left * _compute_cost(falls, alone, known)
    if _compute_cost(falls, sprung, known) < most:
        return *_fit_falls(sprung, rest_speed, known), sprung
    if alone.gravity.shape[1] == 1:
        return falls, solution, alone
    loaded, gravity = alone, solution[2:4]
    for _ in range(JOINT.load_rounds):  # the load is that of a gravity which is found beside it
        loaded = alone._replace(beside=(np.abs(alone.gravity[:, 1:] @ gravity) * alone.direction)[:, None])
        found = _fit_falls(loaded, rest_speed, known)
        gravity = 0.5 * (gravity + found[1][2:4])
    return (*found, loaded) if _compute_cost(found[0], loaded, known) < most else (falls, solution, alone)


def _fit_falls(rows: WeakRows, rest_speed: float, known: RigidJoint | None) -> tuple[FloatArray, FloatArray]:
    """Logarithms of both Stribeck velocities, shape (2,), and what is linear beside them, shape (p,).

    Args:
        rows: Of all recordings.
        rest_speed: Slower samples take no part [rad/s].
        known: Inertia and gravity of a simulation.
    """
    top = float(np.quantile(np.abs(rows.velocity), 0.98))
    grid = np.log(np.geomspace(max(2 * rest_speed, 0.01 * top), 0.5 * top, 6))
    start = min((_compute_cost(np.array([a, a]), rows, known), a) for a in grid)[1]
    found = minimize(
        _compute_cost, np.array([start, start]), args=(rows, known), method="Nelder-Mead", options={"maxiter": 80}
    )
    falls = np.clip(found.x, np.log(JOINT.lowest_stribeck * top), np.log(top))  # without static friction one runs away
    return falls, _solve(falls, rows, known)[0]


def _count_window(track: Track, width: float) -> int:
    """Samples of a window [s] of the test function, an odd number."""
    return max(5, 2 * round(width / track.dt / 2) + 1)


def _measure_margin(track: Track, width: float) -> int:
    """Samples on both sides of a row's centre in which the joint has to slide: half the window, and the filters'."""
    return _count_window(track, width) // 2 + max(3, round(0.021 / track.dt))


def _build_rows(track: Track, width: float, rest_speed: float, beside: Sequence[FloatArray]) -> WeakRows:
    length = _count_window(track, width)
    s = (np.arange(length) + 1.0) / (length + 1)
    phi = 0.5 - 0.5 * np.cos(2 * np.pi * s)
    span = (length + 1) * track.dt
    curvature = 2 * np.pi**2 / span**2 * np.cos(2 * np.pi * s)
    total = phi.sum()
    moving = np.abs(track.velocity) > rest_speed
    margin = _measure_margin(track, width)
    ok = np.zeros(track.size, dtype=bool)
    for sign in (1.0, -1.0):
        ok |= binary_erosion(moving & (np.sign(track.velocity) == sign), np.ones(2 * margin + 1))
    centres = np.flatnonzero(ok)[:: max(1, length // 2)]

    def average(samples: FloatArray, weights: FloatArray) -> FloatArray:
        result: FloatArray = fftconvolve(samples, weights, mode="same")[centres] / total
        return result

    q = track.position
    curvature = curvature - curvature.mean()
    gravity = [np.ones_like(q)] + ([np.cos(q), np.sin(q)] if track.rotary else [])
    return WeakRows(
        torque=average(track.torque, phi),
        inertia=average(q - q.mean(), curvature),
        gravity=np.stack([average(g, phi) for g in gravity], axis=1),
        beside=np.stack([average(one, phi) for one in beside], axis=1),
        velocity=average(track.velocity, phi),
        direction=np.sign(track.velocity[centres]),
    )


def _build_columns(log_speeds: FloatArray, rows: WeakRows) -> FloatArray:
    columns = [rows.inertia, *rows.gravity.T, *rows.beside.T]
    for speed, sign in zip(np.exp(log_speeds), (1.0, -1.0), strict=True):
        on = rows.direction == sign
        fall = np.exp(-((rows.velocity / speed) ** 2))
        columns += [on * sign, on * sign * fall, on * rows.velocity]
    return np.stack(columns, axis=1)


def _solve(log_speeds: FloatArray, rows: WeakRows, known: RigidJoint | None) -> tuple[FloatArray, float]:
    """Least squares with inertia and friction not negative, gravity, offset and what is beside free, a touch of ridge.

    Of solutions that fit alike it takes the one near the simulation, with hardly any offset, even directions and
    friction that hardly falls with speed: sliding shows an offset and the difference of the directions as one sum,
    and one speed shows Coulomb, static and viscous torque as one.
    """
    A = _build_columns(log_speeds, rows)
    free = rows.free
    split = np.concatenate([A, -A[:, 1 : 1 + free]], axis=1)
    norm = np.linalg.norm(split, axis=0) + 1e-12
    forward, reverse = norm[1 + free : 4 + free], norm[4 + free : 7 + free]
    forward[:] = reverse[:] = np.hypot(forward, reverse)  # one direction may hold no rows, and is as large all the same
    ridge = 1e-4 * np.sqrt(rows.torque.size)
    R = np.asarray(np.linalg.qr(np.concatenate([split, rows.torque[:, None]], axis=1), mode="r"))
    size = norm / np.sqrt(rows.torque.size)
    usual, wanted = _build_usual(size, rows, known)
    usual, wanted = (JOINT.usual_weight * np.sqrt(rows.torque.size) * one for one in (usual, wanted))
    system = np.concatenate([R[:, :-1] / size, ridge * np.eye(norm.size), usual])
    target = np.concatenate([R[:, -1], np.zeros(norm.size), wanted])
    x, cost = nnls(system, target)
    x = x / size
    x[1 : 1 + free] -= x[A.shape[1] :]
    return x[: A.shape[1]], float(cost)


def _build_usual(size: FloatArray, rows: WeakRows, known: RigidJoint | None) -> tuple[FloatArray, FloatArray]:
    """Rows and right sides of what is usual: no offset, nothing beside, no fall of friction with speed, directions that
    are alike, and inertia and gravity of the simulation.

    Shapes (k, p), (k,).
    """
    free, beside = rows.free, 1 + rows.gravity.shape[1]  # where what is beside begins
    opposite, forward = 6 + free, 1 + free  # where gravity stands once more, turned round; where friction begins
    usual = [{one: 1.0, opposite + one: -1.0} for one in (1, *range(beside, 1 + free))]
    usual += [{forward + 1: 1.0}, {forward + 4: 1.0}]
    usual += [{one: 1.0, one + 3: -1.0} for one in range(forward, forward + 3)]
    wanted = [0.0] * len(usual)
    if known is not None:
        columns = (0, *range(2, beside))
        usual += [{0: 1.0}, *({column: 1.0, opposite + column: -1.0} for column in columns[1:])]
        body = known.inertia, *known.gravity
        wanted += [value * size[column] for value, column in zip(body, columns, strict=False)]
    system = np.zeros((len(usual), size.size))
    for row, signs in zip(system, usual, strict=True):
        row[list(signs)] = list(signs.values())
    return system, np.array(wanted)


def _compute_cost(log_speeds: FloatArray, rows: WeakRows, known: RigidJoint | None) -> float:
    return _solve(log_speeds, rows, known)[1]


def _build_plant(log_speeds: FloatArray, x: FloatArray, rows: WeakRows, *, hold: bool) -> Plant:
    free = rows.free
    gravity = (float(x[2]), float(x[3])) if rows.gravity.shape[1] == 3 else (0.0, 0.0)
    f, r = (tuple(map(float, part)) for part in (x[1 + free : 4 + free], x[4 + free :]))
    speeds = np.exp(log_speeds)
    floor = 1e-3 * float(np.std(rows.torque))
    slowest = float(np.quantile(np.abs(rows.velocity), JOINT.slow_share)) if hold else np.inf
    forward, reverse = (_bound_curve(part, floor, float(vs), slowest) for part, vs in zip((f, r), speeds, strict=True))
    inertia = max(float(x[0]), 1e-3 * float(np.std(rows.torque) / (np.std(rows.inertia) + 1e-9)))
    return Plant(
        inertia=inertia,
        gravity=gravity,
        offset=float(x[1]),
        forward=forward,
        reverse=reverse,
        sigma_0=1e4 * max(forward[0], reverse[0]),
    )


def _bound_curve(
    found: tuple[float, ...], floor: float, speed: float, slowest: float
) -> tuple[float, float, float, float]:
    """Coulomb and static torque, Stribeck velocity, viscous coefficient.

    The Coulomb torque is at least half of the dry friction at the speed `slowest`, and the static torque at most twice
    the Coulomb torque: more than slow rows hold is a guess.
    """
    held = found[0] + found[1] * float(np.exp(-((slowest / speed) ** 2)))
    coulomb = max(found[0], 0.5 * held, floor)
    return coulomb, min(max(found[0] + found[1], coulomb), 2.0 * coulomb), speed, found[2]
