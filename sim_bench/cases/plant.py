"""The concealed plant as numbers: every field of the joint, its controller, its drive and each effect.

A field's neutral value is the one with which its effect is absent; an effect is a handful of fields set otherwise.
Units: rad, rad/s, N·m, s, °C; torque on the joint side.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

# Friction cores by the number that the kernel knows them by.
CORES = {"dahl": 0, "lugre": 1, "gms": 2, "set_valued": 3}
ELEMENTS = 5  # elasto-plastic elements of the generalised Maxwell-slip core

_RIGID = {"inertia": 0.5, "link_inertia": 0.3, "gravity": 0.0, "gravity_angle": 0.0}
_FRICTION = {
    "coulomb_forward": 1.0, "coulomb_reverse": 1.0, "static_forward": 1.2, "static_reverse": 1.2,
    "stribeck_forward": 0.05, "stribeck_reverse": 0.05, "viscous_forward": 0.5, "viscous_reverse": 0.5,
    "core": 0.0, "sigma_0": 1e5, "sigma_1": 0.0, "slip_rate": 4000.0,  # slip_rate [1/s] of the Maxwell elements
    "base_sigma_0": 1e5, "base_sigma_1": 0.0,
}  # fmt: skip
_LOOP = {
    "gain": 100.0, "damping": 10.0, "integral": 0.0, "velocity_cutoff": 300.0, "limit": 100.0,  # cutoff [rad/s]
    "gravity_feedforward": 0.0, "resolution": 2.4e-5, "current_cutoff": 6000.0,
}  # fmt: skip
_CURVE = {
    "exponent": 2.0, "lorentzian": 0.0, "power": 0.0, "power_exponent": 0.7, "eyring": 0.0, "eyring_velocity": 0.2,
    "drag": 0.0, "lag": 0.0, "dwell": 0.0, "dwell_time": 1.0, "dwell_form": 0.0, "dwell_slip": 0.01,
}  # fmt: skip
_LOAD = {"load_coulomb": 0.0, "load_smoothing": 0.0, "load_stribeck": 0.0, "load_quadratic": 0.0, "load_braking": 0.0}
_HEAT = {
    "viscous_heat": 0.0, "coulomb_heat": 0.0, "heat_form": 0.0, "reference_temperature": 25.0,
    "winding_loss": 0.0, "winding_heating": 0.0, "winding_time": 20.0,  # loss [1/K]; heating [K/(s (N·m)^2)]
}  # fmt: skip
_POSITION = {
    "wave": 0.0, "wave_order": 1.0, "wave_phase": 0.0, "wave_triangle": 0.0,
    "cogging": 0.0, "cogging_order": 100.0, "cogging_phase": 0.0, "cogging_sharpness": 0.0,
    "spring": 0.0, "spring_rest": 0.0, "spring_cubic": 0.0, "stop": 0.0, "stop_position": 1.0, "stop_exponent": 1.0,
    "stop_damping": 0.0,
}  # fmt: skip
_TRANSMISSION = {
    "kinematic": 0.0, "kinematic_order": 200.0, "kinematic_phase": 0.0,
    "flexible": 0.0, "stiffness": 1e5, "hardening": 0.0, "gap": 0.0, "spring_damping": 1.0,  # hardening [1/(N·m)^2]
}  # fmt: skip
_DRIVE = {
    "saturation": 0.0, "saturation_form": 0.0, "sag": 0.0, "drive_lag": 0.0, "drive_order": 1.0,
    "torque_ripple": 0.0, "ripple_order": 100.0, "ripple_phase": 0.0, "ripple_second": 0.0,
    "rate_limit": 0.0, "dead_band": 0.0, "derating": 0.0, "derating_time": 20.0, "derating_floor": 0.4,
}  # fmt: skip
_SENSOR = {"eccentricity": 0.0, "eccentricity_order": 1.0, "eccentricity_phase": 0.0}
_OUTSIDE = {
    "detent": 0.0, "detent_order": 40.0, "detent_width": 0.05, "cable": 0.0, "cable_time": 3.0,
    "thixotropy": 0.0, "thixotropy_time": 2.0, "eddy": 0.0, "eddy_velocity": 0.3,
    "absorber": 0.0, "absorber_frequency": 50.0, "absorber_damping": 0.02,  # absorber: mass as inertia [kg·m²]
    "impact": 0.0, "impact_frequency": 200.0, "impact_decay": 0.05,
    "starvation": 0.0, "starvation_period": 4.0, "starvation_width": 0.8,
}  # fmt: skip

NEUTRAL: dict[str, float] = {
    **_RIGID, **_FRICTION, **_LOOP, **_CURVE, **_LOAD, **_HEAT, **_POSITION, **_TRANSMISSION, **_DRIVE, **_SENSOR,
    **_OUTSIDE,
}  # fmt: skip

_PLANT = np.dtype([(name, np.float64) for name in NEUTRAL])

# What the kernel carries from one substep to the next.
STATE = np.dtype(
    [
        (name, np.float64)
        for name in (
            "position", "velocity", "link_position", "link_velocity", "acceleration", "lagged_velocity",
            "current", "lag_1", "lag_2", "slewed", "applied", "winding", "aged", "cable_position", "detent_position",
            "thixotropic", "absorber_position", "absorber_velocity", "ring_position", "ring_velocity", "load",
            "felt_position", "felt_velocity", "last_direction", "travel", "integral", "filtered_velocity",
            "last_measured", "command",
        )
    ]
)  # fmt: skip


def build_plant(fields: Mapping[str, float]) -> NDArray[np.void]:
    """A structured array of shape (1,) with `fields` set and all others neutral.

    Raises:
        KeyError: A field is not of the plant.
    """
    plant = np.zeros(1, dtype=_PLANT)
    for name, value in NEUTRAL.items():
        plant[name] = value
    for name, value in fields.items():
        if name not in NEUTRAL:
            raise KeyError(f"the plant has no field {name!r}")
        plant[name] = value
    return plant
