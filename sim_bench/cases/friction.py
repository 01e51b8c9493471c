"""Friction inside the plant: a level that the effects bend, and the core that turns it into torque.

Dahl: F' = sigma_0 v (1 - F sgn(v) / g). LuGre adds sigma_1 z'. GMS: elements F_i' = k_i v while sticking,
F_i -> alpha_i g sgn(v) at the rate C while slipping [lampaert2003gms]. Set-valued: F in [-g, g] such that the joint
stays at rest where it can [moreau1988].
"""

import numpy as np

from .compiled import Record, compile_cached

_KELVIN = 273.15


@compile_cached
def compute_base_level(v: float, p: Record) -> float:
    """Dry level g(v) > 0 [N·m] of the joint without any effect."""
    if v >= 0.0:
        x = v / p.stribeck_forward
        return float(p.coulomb_forward + (p.static_forward - p.coulomb_forward) * np.exp(-x * x))
    x = v / p.stribeck_reverse
    return float(p.coulomb_reverse + (p.static_reverse - p.coulomb_reverse) * np.exp(-x * x))


@compile_cached
def _compute_fall(x: float, p: Record) -> float:
    """How much of the static surplus is left at |v| / v_s = x."""
    if p.lorentzian > 0.0:
        return float(1.0 / (1.0 + x * x))
    if p.exponent == 2.0:
        return float(np.exp(-x * x))
    return float(np.exp(-(x**p.exponent)))


@compile_cached
def _load_level(v: float, fall: float, s: Record, p: Record) -> float:
    """What the transmitted load adds to the level [N·m]."""
    load = abs(s.load)
    if p.load_smoothing > 0.0:
        load = np.sqrt(load * load + p.load_smoothing**2) - p.load_smoothing
    level = p.load_coulomb * load + p.load_stribeck * load * fall + p.load_quadratic * s.load * s.load
    if s.load * v > 0.0:
        level += p.load_braking * load
    return float(level)


@compile_cached
def _compute_wave(q: float, p: Record) -> float:
    """Relative change of the level with position."""
    angle = p.wave_order * q + p.wave_phase
    if p.wave_triangle > 0.0:
        return float(p.wave * 2.0 / np.pi * np.arcsin(np.cos(angle)))
    return float(p.wave * np.cos(angle))


@compile_cached
def _compute_warmth(coefficient: float, temperature: float, p: Record) -> float:
    """Viscosity relative to the reference temperature: exponential, Arrhenius or WLF, the same slope there."""
    rise = temperature - p.reference_temperature
    if p.heat_form == 1.0:
        kelvin = p.reference_temperature + _KELVIN
        return float(np.exp(coefficient * kelvin * kelvin * (1.0 / (temperature + _KELVIN) - 1.0 / kelvin)))
    if p.heat_form == 2.0:
        return float(np.exp(-coefficient * 40.0 * rise / (40.0 + rise)))
    return float(np.exp(-coefficient * rise))


@compile_cached
def compute_friction_level(v: float, temperature: float, factor: float, s: Record, p: Record) -> float:
    """Dry level g > 0 [N·m] with all that the effects do to it; `factor` scales it from outside."""
    if v >= 0.0:
        coulomb, surplus, width = p.coulomb_forward, p.static_forward - p.coulomb_forward, p.stribeck_forward
    else:
        coulomb, surplus, width = p.coulomb_reverse, p.static_reverse - p.coulomb_reverse, p.stribeck_reverse
    fall = _compute_fall(abs(v) / width, p)
    level = coulomb * (1.0 + p.coulomb_heat * (temperature - p.reference_temperature)) + surplus * fall
    level += coulomb * _compute_wave(s.position, p) + _load_level(v, fall, s, p)
    level += p.dwell * s.aged
    if p.starvation > 0.0:
        phase = s.travel % p.starvation_period - 0.5 * p.starvation_period
        level += p.starvation * np.exp(-((phase / p.starvation_width) ** 2))
    return float(max(level * factor, 0.02 * coulomb))


@compile_cached
def compute_viscous_torque(v: float, temperature: float, s: Record, p: Record) -> float:
    """The part of friction that vanishes with speed [N·m]."""
    slope = p.viscous_forward if v >= 0.0 else p.viscous_reverse
    if p.viscous_heat != 0.0:
        slope *= _compute_warmth(p.viscous_heat, temperature, p)
    torque = slope * v + p.drag * v * abs(v)
    if p.power != 0.0:
        torque += p.power * np.sign(v) * abs(v) ** p.power_exponent
    if p.eyring != 0.0:
        torque += p.eyring * np.arcsinh(v / p.eyring_velocity)
    if p.eddy != 0.0:
        x = v / p.eddy_velocity
        torque += p.eddy * 2.0 * x / (1.0 + x * x)
    if p.thixotropy != 0.0:
        torque += p.thixotropy * np.sign(v) * np.sqrt(abs(v)) * (1.0 - s.thixotropic)
    return float(torque)


@compile_cached
def advance_memory(v: float, dt: float, s: Record, p: Record) -> None:
    """Advance what friction remembers: lagging speed, age of the contact, structure of the grease, travel."""
    if p.lag > 0.0:
        s.lagged_velocity += (v - s.lagged_velocity) * (1.0 - np.exp(-dt / p.lag))
    else:
        s.lagged_velocity = v
    if p.dwell != 0.0:
        _advance_age(v, dt, s, p)
    if p.thixotropy != 0.0:
        broken = 1.0 - np.exp(-abs(v) / 0.3)
        s.thixotropic += dt / p.thixotropy_time * (broken - s.thixotropic)
    s.travel += abs(v) * dt


@compile_cached
def _advance_age(v: float, dt: float, s: Record, p: Record) -> None:
    """Ageing at rest, exponential or logarithmic, lost again over the slip distance."""
    slip = abs(v) * dt / p.dwell_slip
    resting = np.exp(-((v / 1e-3) ** 2))
    if p.dwell_form == 1.0:  # d/dt ln(1 + t / T) / ln(1 + 100) expressed through the age itself
        s.aged += resting * dt / (p.dwell_time * np.log(101.0)) * np.exp(-s.aged * np.log(101.0))
    else:
        s.aged += resting * dt / p.dwell_time * (1.0 - s.aged)
    s.aged *= np.exp(-slip)


@compile_cached
def advance_bristles(
    v: float, dt: float, level: float, shape: tuple[float, float, float, float], z: np.ndarray, shares: np.ndarray
) -> float:
    """Friction torque [N·m] of a core with bristles after `dt`; `z` holds its state and is advanced.

    Args:
        v: Velocity [rad/s].
        dt: [s]
        level: g > 0 [N·m].
        shape: Number of the core, sigma_0 [N·m/rad], sigma_1 [N·m·s/rad], slip rate [1/s].
        z: Element torques [N·m], shape (ELEMENTS,).
        shares: Strengths alpha_i and stiffnesses k_i / sigma_0 of the elements, shape (2, ELEMENTS).
    """
    core, sigma_0, sigma_1, rate = shape
    if core == 2.0:
        return float(_advance_elements(v, dt, level, sigma_0, rate, z, shares))
    before = z[0]
    target = level * np.sign(v)
    z[0] = target + (before - target) * np.exp(-sigma_0 * abs(v) * dt / level)
    return float(z[0] + sigma_1 * (z[0] - before) / (sigma_0 * dt))


@compile_cached
def _advance_elements(
    v: float, dt: float, level: float, sigma_0: float, rate: float, z: np.ndarray, shares: np.ndarray
) -> float:
    total = 0.0
    for i in range(z.size):
        limit = shares[0, i] * level
        trial = z[i] + shares[1, i] * sigma_0 * v * dt
        if abs(trial) > limit:
            target = np.sign(trial) * limit
            trial = target if abs(z[i]) <= limit else target + (z[i] - target) * np.exp(-rate * dt)
        z[i] = trial
        total += trial
    return float(total)
