"""The regressors that a straightforward engineer would try, by the name of the effect."""

import numpy as np

from ...kit.rigid_joint import Samples
from .data import BaselineData


def build_library(data: BaselineData) -> dict[str, Samples]:
    """Columns by effect, each of shape (n, k)."""
    v, load, sign = data.velocity, data.load, np.sign(data.velocity)
    fall = np.exp(-((v / data.stribeck_velocity) ** 2))
    slope = -2.0 * v / data.stribeck_velocity**2 * fall  # of the Stribeck curve
    library = {
        "load_coulomb": [np.abs(load) * sign],
        "load_stribeck": [np.abs(load) * fall * sign],
        "load_quadratic": [load**2 * sign],
        "frictional_lag": [data.acceleration * slope * sign],
        "stribeck_shape": [sign * np.exp(-np.abs(v) / data.stribeck_velocity)],
        "power_law_viscous": [np.abs(v) ** 0.6 * sign],
        "quadratic_drag": [v * np.abs(v)],
        "joint_elasticity": [data.torque_bend],
        "torque_delay": [data.torque_rate],
        "torque_saturation": [data.expected**3],
        "supply_sag": [data.expected * np.abs(data.expected * v)],
        "spring_torque": [data.position, data.position**2],
        "end_stop": [np.maximum(data.position - np.quantile(data.position, 0.93), 0.0)],
        "backlash": [-load * (np.abs(load) < 0.1 * np.abs(load).max())],
        **_build_position_columns(data, sign),
        **_build_memory_columns(data),
    }
    if data.temperature is not None:
        rise = data.temperature - data.temperature.mean()
        library["thermal_friction"] = [rise * v, rise * sign]
    return {name: np.stack(columns, axis=1) for name, columns in library.items()}


def _build_position_columns(data: BaselineData, sign: Samples) -> dict[str, list[Samples]]:
    q, v = data.position, data.velocity
    wave = [f(n * q) * sign for n in (1, 2, 3, 4, 6) for f in (np.sin, np.cos)]
    motor = data.gear_ratio * q
    ripple = [f(k * motor) for k in (1, 2) for f in (np.sin, np.cos)]
    error = [weight * f(2.0 * motor) for weight in (v**2, data.acceleration) for f in (np.sin, np.cos)]
    return {"position_coulomb": wave, "cogging": ripple, "kinematic_error": error}


def _build_memory_columns(data: BaselineData) -> dict[str, list[Samples]]:
    q, tau = data.whole.T
    heat = np.cumsum(tau**2 - np.mean(tau**2))[data.kept] * data.expected / tau.size
    loops = [_play(tau, width)[data.kept] for width in np.array([0.1, 0.3]) * np.abs(tau).max()]
    slides = [(q - _play(q, width))[data.kept] for width in (5e-4, 2e-3, 8e-3)]
    return {
        "torque_constant_heating": [heat],
        "torque_sensor_hysteresis": loops,
        "presliding_hysteresis": slides,
    }


def _play(values: Samples, width: float) -> Samples:
    """Play operator of half width `width`, on every fifth sample."""
    out, state = np.empty_like(values), values[0]
    for i in range(0, values.size, 5):
        state = min(max(state, values[i] - width), values[i] + width)
        out[i : i + 5] = state
    return out
