"""Torques inside the plant that are neither drive, rigid body nor friction; positive ones oppose motion forward."""

import numpy as np

from .compiled import Record, compile_cached


@compile_cached
def compute_position_torque(q: float, v: float, p: Record) -> float:
    """Cogging, spring and end stop [N·m] at a place."""
    torque = 0.0
    if p.cogging != 0.0:
        angle = p.cogging_order * q + p.cogging_phase
        torque += p.cogging * np.sin(angle + p.cogging_sharpness * np.sin(angle))
    stretch = q - p.spring_rest
    torque += p.spring * stretch + p.spring_cubic * stretch**3
    if p.stop > 0.0 and q > p.stop_position:
        depth = (q - p.stop_position) ** p.stop_exponent
        torque += max(p.stop * depth * (1.0 + p.stop_damping * v), 0.0)
    return float(torque)


@compile_cached
def advance_attached(dt: float, s: Record, p: Record) -> float:
    """Torque [N·m] of what hangs on the joint with a memory: cable, detent, absorber, loose coupling."""
    torque = 0.0
    if p.cable != 0.0:
        s.cable_position += dt / p.cable_time * (s.position - s.cable_position)
        torque += p.cable * (s.position - s.cable_position)
    if p.detent != 0.0:
        s.detent_position = min(max(s.detent_position, s.position - p.detent_width), s.position + p.detent_width)
        torque += p.detent * np.sin(p.detent_order * s.detent_position)
    if p.absorber != 0.0:
        torque += _compute_absorber(dt, s, p)
    if p.impact != 0.0:
        torque += p.impact * _compute_ring(dt, s, p)
    return float(torque)


@compile_cached
def _compute_absorber(dt: float, s: Record, p: Record) -> float:
    w = p.absorber_frequency
    force = w * w * (s.position - s.absorber_position) + 2.0 * p.absorber_damping * w * (
        s.velocity - s.absorber_velocity
    )
    s.absorber_velocity += dt * force
    s.absorber_position += dt * s.absorber_velocity
    return float(p.absorber * force)


@compile_cached
def _compute_ring(dt: float, s: Record, p: Record) -> float:
    """A loose coupling strikes when the direction changes and rings out."""
    if s.velocity * s.last_direction < 0.0 and abs(s.velocity) > 5e-3:
        s.last_direction = np.sign(s.velocity)
        s.ring_velocity += p.impact_frequency * s.last_direction
    elif s.last_direction == 0.0:
        s.last_direction = np.sign(s.velocity)
    w = p.impact_frequency
    s.ring_velocity -= dt * (w * w * s.ring_position + 2.0 / p.impact_decay * s.ring_velocity)
    s.ring_position += dt * s.ring_velocity
    return float(s.ring_position)
