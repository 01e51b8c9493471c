"""The drive inside the plant: controller at the sample rate, current loop and what the effects do to torque."""

import numpy as np

from .compiled import Record, compile_cached


@compile_cached
def read_position(q: float, s: Record, p: Record) -> float:
    """What the encoder of the loop shows [rad]: eccentric and rounded to its step."""
    seen = q + p.eccentricity * np.sin(p.eccentricity_order * q + p.eccentricity_phase)
    if p.resolution > 0.0:
        seen = np.floor(seen / p.resolution + 0.5) * p.resolution
    return float(seen)


@compile_cached
def compute_command(reference: float, reference_velocity: float, period: float, s: Record, p: Record) -> float:
    """One step of the PD or PID controller with velocity from filtered differences; returns torque [N·m]."""
    seen = read_position(s.position, s, p)
    rate = (seen - s.last_measured) / period
    s.last_measured = seen
    s.filtered_velocity += (rate - s.filtered_velocity) * (1.0 - np.exp(-p.velocity_cutoff * period))
    error = reference - seen
    torque = p.gain * error + p.damping * (reference_velocity - s.filtered_velocity) + s.integral
    torque += p.gravity_feedforward * np.sin(seen + p.gravity_angle)
    limited = min(max(torque, -p.limit), p.limit)
    if limited == torque:
        s.integral += p.integral * error * period
    return float(limited)


@compile_cached
def _lag(torque: float, dt: float, s: Record, p: Record) -> float:
    step = 1.0 - np.exp(-dt * p.drive_order / p.drive_lag)
    s.lag_1 += (torque - s.lag_1) * step
    if p.drive_order == 1.0:
        return float(s.lag_1)
    s.lag_2 += (s.lag_1 - s.lag_2) * step
    return float(s.lag_2)


@compile_cached
def _compute_gain(torque: float, s: Record, p: Record) -> float:
    """Torque after saturation, supply and winding, and a torque constant that waves with the angle."""
    if p.saturation > 0.0:
        x = p.saturation * torque * torque  # relative loss to first order
        torque = torque * (1.0 - x) if p.saturation_form == 0.0 else torque / np.sqrt(1.0 + 2.0 * x)
    if p.sag > 0.0:
        torque *= 1.0 - min(p.sag * abs(torque * s.velocity), 0.6)
    if p.winding_loss > 0.0:
        torque *= 1.0 - min(p.winding_loss * s.winding, 0.6)
    if p.torque_ripple > 0.0:
        angle = p.ripple_order * s.position + p.ripple_phase
        torque *= 1.0 + p.torque_ripple * (np.cos(angle) + p.ripple_second * np.cos(2.0 * angle))
    return float(torque)


@compile_cached
def advance_drive(time: float, dt: float, s: Record, p: Record) -> float:
    """Torque that reaches the joint [N·m] after `dt`; `s.current` is what the drive reports."""
    s.current += (s.command - s.current) * (1.0 - np.exp(-p.current_cutoff * dt))
    torque = s.current
    if p.drive_lag > 0.0:
        torque = _lag(torque, dt, s, p)
    if p.rate_limit > 0.0:
        s.slewed += min(max(torque - s.slewed, -p.rate_limit * dt), p.rate_limit * dt)
        torque = s.slewed
    if p.dead_band > 0.0:
        torque -= p.dead_band * np.tanh(torque / p.dead_band)
    if p.derating > 0.0:
        limit = p.derating * (1.0 - (1.0 - p.derating_floor) * (1.0 - np.exp(-time / p.derating_time)))
        torque = min(max(torque, -limit), limit)
    s.winding += dt * (p.winding_heating * s.current * s.current - s.winding / p.winding_time)
    return float(_compute_gain(torque, s, p))
