"""What the user believes and hands in: the joint as MJCF, the controller as TOML, the friction as a model file."""

import json
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

import numpy as np

_ARM, _GRAVITY = 0.25, 9.81  # [m] of the centre of mass, [m/s²]
_UNITS = {
    "coulomb_torque": "N·m", "static_torque": "N·m", "stribeck_velocity": "rad/s", "viscous_coefficient": "N·m·s/rad",
    "stribeck_exponent": "1",
}  # fmt: skip


def format_simulation(fields: Mapping[str, float], limit: float) -> str:
    """A rigid hinge as MJCF whose gravity torque is `gravity` sin(q + `gravity_angle`) and whose inertia is `inertia`.

    The link's own inertia carries what its mass does not; a motor's armature would do as well.
    """
    mass = fields["gravity"] / (_GRAVITY * _ARM)
    arm = min(_ARM, 0.9 * fields["inertia"] * _GRAVITY / fields["gravity"])  # keeps m r² below the inertia
    mass *= _ARM / arm
    inertia = fields["inertia"] - mass * arm**2
    place = f"{-arm * np.sin(fields['gravity_angle']):.12g} 0 {-arm * np.cos(fields['gravity_angle']):.12g}"
    root = ET.Element("mujoco", model="joint")
    ET.SubElement(root, "option", timestep="0.0005", gravity=f"0 0 -{_GRAVITY}", integrator="implicitfast")
    body = ET.SubElement(ET.SubElement(root, "worldbody"), "body", name="link")
    ET.SubElement(body, "joint", name="joint", type="hinge", axis="0 1 0", damping="0", frictionloss="0")
    moments = f"{inertia:.12g} {inertia:.12g} {inertia:.12g}"
    ET.SubElement(body, "inertial", pos=place, mass=f"{mass:.12g}", diaginertia=moments)
    motors = ET.SubElement(root, "actuator")
    ET.SubElement(motors, "motor", name="joint", joint="joint", ctrllimited="true", ctrlrange=f"-{limit:g} {limit:g}")
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def format_controller(fields: Mapping[str, float]) -> str:
    """The PD or PID loop as TOML.

    torque = gain (q_ref - q) + damping (v_ref - v_f) + integral ∫(q_ref - q) dt, v_f the first-order filtered
    difference of the position; limited to `torque_limit`, the integral held while limited.
    """
    kind = "pid" if fields["integral"] else "pd"
    return (
        "[controller]\n"
        f'kind = "{kind}"\n'
        "frequency = 1000.0               # [Hz]\n"
        f"proportional_gain = {fields['gain']:.9g}  # [N·m/rad]\n"
        f"integral_gain = {fields['integral']:.9g}  # [N·m/(rad·s)]\n"
        f"derivative_gain = {fields['damping']:.9g}  # [N·m·s/rad]\n"
        f"velocity_filter_frequency = {fields['velocity_cutoff'] / (2.0 * np.pi):.9g}  # [Hz] first order\n"
        f"torque_limit = {fields['limit']:g}  # [N·m]\n"
    )


def format_friction(fields: Mapping[str, float]) -> str:
    """A bidirectional Stribeck law as a model file."""
    parameters: dict[str, Any] = {}
    for direction in ("forward", "reverse"):
        values = {
            "coulomb_torque": fields[f"coulomb_{direction}"],
            "static_torque": fields[f"static_{direction}"],
            "stribeck_velocity": fields[f"stribeck_{direction}"],
            "viscous_coefficient": fields[f"viscous_{direction}"],
            "stribeck_exponent": 2.0,
        }
        parameters |= {f"{direction}.{n}": {"value": v, "unit": _UNITS[n]} for n, v in values.items()}
    record = {
        "schema": "fricomp.model/1",
        "joint": "joint",
        "motion": "rotary",
        "torque_unit": "N·m",
        "law": [{"term": "stribeck", "parameters": parameters}],
        "validity": {},
        "provenance": {},
    }
    return json.dumps(record, indent=2, ensure_ascii=False) + "\n"
