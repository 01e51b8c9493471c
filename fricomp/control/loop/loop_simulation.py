"""A joint that truly sticks, in a position loop with compensation: many cases at once, in lock step.

Meant for questions about stability and robustness, where thousands of loops have to be run; the stand-in joint of the
simulation bench has the full sensor chain.
"""

from dataclasses import dataclass

import numpy as np

from fricomp.control.compensation.batch import compute_compensation, compute_friction
from fricomp.control.compensation.curve import FrictionCurves
from fricomp.control.settings import NO_LIMITS, CompensationSettings, DriveLimits, LoopDynamics
from fricomp.laws import FloatArray

_SUBSTEPS = 4


@dataclass(frozen=True)
class LoopCases:
    """Cases that are simulated together. Arrays have shape (n_cases,).

    Attributes:
        loop: The position loop; its delay is replaced by `delay`.
        gain: Of the compensation [1].
        friction_scale: Of the joint's friction against the model [1].
        delay: From motion to torque [s].
        velocity_quantum: Step of the measured velocity; 0 for none [rad/s] or [m/s].
        velocity_filter: Time constant of the low pass on the measured velocity [s].
        drive: Limits of the torque.
    """

    loop: LoopDynamics
    gain: FloatArray
    friction_scale: FloatArray
    delay: FloatArray
    velocity_quantum: float = 0.0
    velocity_filter: float = 0.0
    drive: DriveLimits = NO_LIMITS


@dataclass(frozen=True)
class SimulatedLoop:
    """What the cases did.

    Attributes:
        position: Shape (n_ticks, n_cases) [rad] or [m].
        velocity: Shape (n_ticks, n_cases) [rad/s] or [m/s].
    """

    position: FloatArray
    velocity: FloatArray


def simulate_loop(
    curves: FrictionCurves,
    settings: CompensationSettings,
    cases: LoopCases,
    reference: tuple[FloatArray, FloatArray],
    *,
    period: float = 1e-3,
    start_velocity: FloatArray | float = 0.0,
    start_offset: FloatArray | float = 0.0,
    compensated: FrictionCurves | None = None,
) -> SimulatedLoop:
    """Run the loop along a reference.

    Args:
        curves: Friction of the joint.
        settings: Of the compensation; the gain is that of `cases`.
        cases: What differs between the loops.
        reference: Position and velocity of the reference, each of shape (n_ticks,) or (n_ticks, n_cases).
        period: Control period [s].
        compensated: What the compensation takes for the friction; the truth if None.
        start_velocity: Velocity of the joint at the start; one, or one a case [rad/s] or [m/s].
        start_offset: Position of the joint at the start, from its reference; likewise [rad] or [m].
    """
    q_ref, v_ref = reference
    known = compensated or curves
    loop, n_ticks, n_cases = cases.loop, len(q_ref), len(cases.gain)
    static = cases.friction_scale * np.array([[sum(curves.forward[:2])], [sum(curves.reverse[:2])]])
    position, velocity = np.zeros((n_ticks, n_cases)), np.zeros((n_ticks, n_cases))
    q, v = np.zeros(n_cases) + q_ref[0] + start_offset, np.zeros(n_cases) + start_velocity
    smooth = 1.0 - np.exp(-period / cases.velocity_filter) if cases.velocity_filter else 1.0
    limit, step = cases.drive.torque, cases.drive.torque_rate * period
    sent = np.zeros(n_cases)
    filtered, behind, column = v, cases.delay / period, np.arange(n_cases)
    for k in range(n_ticks):
        position[k], velocity[k] = q, v
        row = np.clip(k - behind, 0.0, None)
        low = row.astype(np.int64)
        high, part = np.minimum(low + 1, k), row - low
        q_seen = position[low, column] * (1.0 - part) + position[high, column] * part
        v_seen = velocity[low, column] * (1.0 - part) + velocity[high, column] * part
        if cases.velocity_quantum:
            v_seen = np.round(v_seen / cases.velocity_quantum) * cases.velocity_quantum
        filtered = filtered + smooth * (v_seen - filtered)
        error = q_ref[k] - q_seen
        torque = loop.stiffness * error + loop.damping * (v_ref[k] - filtered)
        wanted = cases.gain * compute_compensation(known, settings, np.zeros(n_cases) + v_ref[k], filtered, error)
        torque = np.clip(torque + np.clip(wanted, -settings.authority, settings.authority), -limit, limit)
        sent = np.clip(torque, sent - step, sent + step)
        q, v = _advance_sliding(curves, cases, static, (q, v, sent), period)
    return SimulatedLoop(position, velocity)


def _advance_sliding(
    curves: FrictionCurves,
    cases: LoopCases,
    static: FloatArray,
    state: tuple[FloatArray, FloatArray, FloatArray],
    period: float,
) -> tuple[FloatArray, FloatArray]:
    """One control period under constant torque; the joint stops where its velocity would change sign."""
    q, v, torque = state
    h, inertia = period / _SUBSTEPS, cases.loop.inertia
    holds = np.abs(torque) <= np.where(torque > 0.0, static[0], static[1])
    breakaway = np.where(torque > 0.0, static[0], -static[1])
    for _ in range(_SUBSTEPS):
        resting = v == 0.0
        friction = np.where(
            resting, np.where(holds, torque, breakaway), cases.friction_scale * compute_friction(curves, v)
        )
        after = v + h / inertia * (torque - friction)
        v = np.where(after * v < 0.0, 0.0, after)
        q = q + h * v
    return q, v
