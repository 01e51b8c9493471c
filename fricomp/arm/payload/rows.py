"""Equations of a payload: the torque of each joint beside columns of its own links and friction, and of the payload."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, filtfilt

from fricomp.laws import FloatArray
from fricomp.recording import Recording

from ..rigid.inertia import N_INERTIA, combine_inertia
from ..rigid.regressor import compute_regressor
from ..rigid.simulated_arm import SimulatedArm
from .settings import SETTINGS

Session = dict[str, Recording]
"""Recordings of all joints at once, by the names of the joints."""

_DISTANCE = 0.1
"""[m] of the point masses that make up a body from its origin: about the size of a link, so that all of their columns
are of one size."""


def _place_points() -> FloatArray:
    """Where ten point masses sit on a body: their masses and moments are independent [m]. Shape (10, 3)."""
    e = np.eye(3)
    points = [np.zeros(3), *e, *-e, e[0] + e[1], e[1] + e[2], e[0] + e[2]]
    return np.asarray(_DISTANCE * np.array(points))


_POINTS = _place_points()
MOMENTS = np.column_stack([np.ones(10), _POINTS])
"""Mass and first moments of ten unit masses at the points that a body is made of. Shape (10, 4)."""

_INERTIA = np.stack([combine_inertia(1.0, point, np.zeros((3, 3))) for point in _POINTS], axis=1)
"""Ten numbers of a link for each of these masses. Shape (10, 10)."""


@dataclass(frozen=True)
class SessionRows:
    """Filtered motion and torques of one session at `SETTINGS.rate`.

    Attributes:
        velocity: Of all joints. Shape (n, n_joints), like the others.
        acceleration: [rad/s²] or [m/s²].
        torque: As recorded.
        simulated: Of the simulation's links and rotors [N·m] or [N].
        bodies: Columns of all links. Shape (n, n_joints, 10 n_links).
        payload: Columns of the last link. Shape (n, n_joints, 10).
    """

    velocity: FloatArray
    acceleration: FloatArray
    torque: FloatArray
    simulated: FloatArray
    bodies: FloatArray
    payload: FloatArray

    @classmethod
    def build(cls, arm: SimulatedArm, session: Session) -> SessionRows:
        series = [session[name] for name in arm.joints]
        dt = float(np.median([one.sample_period for one in series]))
        first, last = max(one.time[0] for one in series), min(one.time[-1] for one in series)
        grid = np.arange(first, last, dt)
        b, a = butter(3, SETTINGS.cutoff * 2.0 * dt)
        position, torque = (
            np.stack([filtfilt(b, a, np.interp(grid, one.time, getattr(one, name))) for one in series], axis=1)
            for name in ("position", "torque")
        )
        velocity = np.gradient(position, dt, axis=0)
        acceleration = np.gradient(velocity, dt, axis=0)
        edge = round(SETTINGS.edge / dt)
        kept = slice(edge, grid.size - edge, max(1, round(1.0 / (SETTINGS.rate * dt))))
        columns = compute_regressor(arm, position[kept], velocity[kept], acceleration[kept])
        links = columns.reshape(*columns.shape[:2], -1, N_INERTIA) @ _INERTIA
        simulated = columns @ arm.inertia.ravel() + acceleration[kept] * arm.armature
        last_link = links[:, :, arm.last_link]
        bodies = links.reshape(columns.shape)
        return cls(velocity[kept], acceleration[kept], torque[kept], simulated, bodies, last_link)


def list_gains(session: Session) -> dict[str, float]:
    """Torque of one unit of the recorded torque, for the joints of which it is known [N·m] or [N].

    Gains that were seen in the log itself (`drive_gain_logged`) go before those that somebody states (`drive_gain`).
    """
    plain = {name: 1.0 for name, one in session.items() if one.metadata.torque_unit in ("N·m", "N")}
    for key in ("drive_gain_logged", "drive_gain"):
        stated = {name: one.metadata.extra.get(key) for name, one in session.items() if name not in plain}
        known = {name: float(gain) for name, gain in stated.items() if isinstance(gain, int | float)}
        if known:
            return plain | known
    return plain


@dataclass(frozen=True)
class JointRows:
    """Equations of one joint: own columns, payload columns (zero in the first session), torque, and fold of a row."""

    own: FloatArray
    payload: FloatArray
    torque: FloatArray
    fold: np.ndarray
    test: np.ndarray


def build_joint_rows(j: int, rows: Sequence[SessionRows], gains: Sequence[float]) -> JointRows:
    """Of one joint, where it moves: one that stands takes any torque up to its friction.

    Of a single session the links are known, and the payload is what they leave.
    """
    torque = np.concatenate([one.torque[:, j] * gain for one, gain in zip(rows, gains, strict=True)])
    v = np.concatenate([one.velocity[:, j] for one in rows])
    slow = SETTINGS.slow * max(float(np.quantile(np.abs(v), SETTINGS.top)), 1e-12)
    sign, moves = np.tanh(v / slow), np.abs(v) >= slow
    friction = np.column_stack([np.ones_like(v), v, sign])
    if len(rows) == 1:
        payload, load = rows[0].payload[:, j], rows[0].simulated[:, j]
        torque, plain = torque - load, np.column_stack([friction, rows[0].acceleration[:, j]])
    else:
        bodies = np.concatenate([one.bodies[:, j] for one in rows])
        payload = np.concatenate([k * one.payload[:, j] for k, one in enumerate(rows)])
        plain, n = np.column_stack([bodies, friction]), bodies.shape[1]
        rigid = np.column_stack([plain, payload])
        load = rigid[:, :n] @ np.linalg.lstsq(rigid[moves], torque[moves], rcond=SETTINGS.rank)[0][:n]
    own = np.column_stack([plain, v * np.abs(v), np.abs(load) * sign])[moves]
    size = np.linalg.norm(own, axis=0)
    seen = size > SETTINGS.dust * size.max()
    U, s, _ = np.linalg.svd(own[:, seen] / size[seen], full_matrices=False)
    lengths = [one.torque.shape[0] for one in rows]
    fold = np.concatenate([np.arange(n) * SETTINGS.folds // n for n in lengths])
    test = np.concatenate([np.arange(n) >= n * (1.0 - SETTINGS.test_share) for n in lengths])
    return JointRows(U[:, s > SETTINGS.rank * s[0]], payload[moves], torque[moves], fold[moves], test[moves])
