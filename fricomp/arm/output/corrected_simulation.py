"""The simulation with what was found: inertia of the links, rotors, and the friction that MuJoCo can hold."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import FricompError
from fricomp.export import apply_to_mjcf, export_mjcf
from fricomp.laws import FloatArray
from fricomp.simulation_file import read_specification

from ..answer import ArmAnswer
from ..comparison.torque_scale import find_own_scale
from ..fit import ArmFit
from ..friction_model import build_friction_model
from ..rigid.inertia import can_exist, split_inertia

_LIGHT = 1e-9
"""[kg] and [kg·m²] of bodies that are fixed to a link, where the link weighs what all of them do."""


def correct_simulation(answer: ArmAnswer, simulation: str | Path) -> tuple[str, list[str]]:
    """MJCF of the corrected arm, and what it loses, a line a joint.

    Meshes are left out, as in all that is read for its dynamics.

    Args:
        answer: On the arm.
        simulation: The file that was compared.
    """
    fit = answer.identification.fit
    spec: Any = read_specification(simulation)
    spec.compile()
    bodies = {str(body.name) or f"body {body.id}": body for body in spec.bodies}
    for name, inertia, carried in zip(fit.arm.links, fit.inertia, fit.arm.carried, strict=True):
        _weigh_link(bodies[name], inertia, carried, fit.arm.moving_joints)
    for j, (name, rotor) in enumerate(zip(fit.arm.joints, fit.armature, strict=True)):
        spec.joint(name).armature = max(float(rotor), 0.0) / find_own_scale(fit, j)[0]
    spec.option.gravity = _lean_gravity(fit)
    spec.compile()
    text, lost = spec.to_xml(), []
    for j, name in enumerate(fit.arm.joints):
        try:
            export = export_mjcf(build_friction_model(answer.identification, j))
        except FricompError as error:
            lost.append(f"{name}: no friction is written: {error}")
            continue
        text = apply_to_mjcf(export, text, name)
        lost.append(f"{name}: {export.fidelity}")
    return text, lost


def _lean_gravity(fit: ArmFit) -> FloatArray:
    """Gravity as it acts on the arm in the axes of the simulation [m/s²]: as large as in the file."""
    gravity = fit.arm.gravity
    size = float(np.linalg.norm(gravity))
    for far, axis in zip(fit.lean[0].tolist() if fit.model.tilted else (), fit.arm.level_axes.values(), strict=False):
        gravity = gravity + far * size * axis
    return np.asarray(gravity * size / max(float(np.linalg.norm(gravity)), 1e-12))


def _weigh_link(body: Any, inertia: FloatArray, carried: FloatArray, joints: frozenset[str]) -> None:
    """Give a link what was found: what it carries stays as in the file where the rest is a body that can exist."""
    own = inertia - carried
    if can_exist(own):
        _set_inertia(body, *split_inertia(own))
        return
    _set_inertia(body, *split_inertia(inertia))
    for child in _list_fixed(body, joints):
        _set_inertia(child, _LIGHT, np.zeros(3), _LIGHT * np.eye(3))


def _set_inertia(body: Any, mass: float, centre: FloatArray, about: FloatArray) -> None:
    """Give a body this mass [kg], centre [m] and inertia about it [kg·m²], along its principal axes."""
    import mujoco

    principal, axes = np.linalg.eigh(about)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    turn = np.zeros(4)
    mujoco.mju_mat2Quat(turn, axes.ravel())
    body.explicitinertial, body.fullinertia = True, [np.nan] * 6
    body.mass, body.ipos, body.iquat, body.inertia = mass, centre, turn, np.maximum(principal, _LIGHT)


def _list_fixed(body: Any, joints: frozenset[str]) -> list[Any]:
    """Bodies below one that no recorded joint moves: they are part of its link."""
    fixed = []
    for child in body.bodies:
        if not any(joint.name in joints for joint in child.joints):
            fixed += [child, *_list_fixed(child, joints)]
    return fixed
