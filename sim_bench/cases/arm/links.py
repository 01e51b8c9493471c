"""The arm as it is and as its user believes it to be: MuJoCo models of the packaged file with links changed."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import MissingExtraError

try:
    import mujoco
except ImportError as error:  # pragma: no cover - depends on the installation
    raise MissingExtraError("mujoco", "sim") from error

__all__ = ["LINKS", "SIMULATION", "build_true_arm", "compute_torques", "describe_links", "mujoco", "read_believed_arm"]

SIMULATION = Path(__file__).parents[2] / "stand_in" / "mjcf" / "six_joint_arm.xml"
"""What the user has: the packaged arm."""

LINKS = ("turret", "upper_arm", "forearm", "wrist_pitch", "wrist_yaw", "flange")

_SLIGHT_MASS, _SLIGHT_PLACE, _SLIGHT_SIZE = 0.02, 0.002, 0.04
"""Of links that are right: relative deviation of the mass, that of the centre [m], relative of the moments."""

_ROTOR = 0.1
"""Relative deviation of each rotor's inertia."""


def read_believed_arm() -> Any:
    """What the user has, without contacts and limits, which the motion does not reach."""
    model: Any = mujoco.MjModel.from_xml_path(str(SIMULATION))
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
    return model


def build_true_arm(rng: np.random.Generator, wrong_links: int) -> tuple[Any, tuple[str, ...]]:
    """A model of the true arm, and the names of the links that are far off.

    A link that is far off carries a body more or lacks one: 8 to 35 % of its mass, somewhere within it, so that what
    is left is a body that can exist.
    """
    model = read_believed_arm()
    off = tuple(str(name) for name in rng.choice(LINKS[1:], min(wrong_links, len(LINKS) - 1), replace=False))
    for name in LINKS:
        body = model.body(name).id
        model.body_mass[body] *= np.exp(_SLIGHT_MASS * rng.standard_normal())
        model.body_ipos[body] += _SLIGHT_PLACE * rng.standard_normal(3)
        model.body_inertia[body] *= np.exp(_SLIGHT_SIZE * rng.standard_normal())
        if name in off:
            _change_link(model, body, rng)
    model.dof_armature[:] *= np.exp(_ROTOR * rng.standard_normal(model.nv))
    model.body_sameframe[:] = 0  # the centres were moved off the frames that the compiler had found equal
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model, off


def _change_link(model: Any, body: int, rng: np.random.Generator) -> None:
    """Put a body of its own into a link, or take one out of it."""
    mass, centre = float(model.body_mass[body]), np.array(model.body_ipos[body])
    size = np.sqrt(np.sum(model.body_inertia[body]) / (2.0 * mass))  # radius of gyration [m]
    more = mass * rng.uniform(0.08, 0.35) * (1.0 if rng.random() < 0.75 else -0.5)
    place = centre + 0.8 * size * rng.uniform(-1.0, 1.0, 3)
    total = mass + more
    middle = (mass * centre + more * place) / total
    about = _rotate(model, body) + _point(mass, centre - middle) + _point(more, place - middle)
    values, axes = np.linalg.eigh(about)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    turn = np.zeros(4)
    mujoco.mju_mat2Quat(turn, axes.ravel())
    model.body_mass[body], model.body_ipos[body] = total, middle
    model.body_inertia[body], model.body_iquat[body] = np.maximum(values, 1e-5), turn


def _rotate(model: Any, body: int) -> NDArray[np.float64]:
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    axes = turn.reshape(3, 3)
    return np.asarray(axes @ np.diag(model.body_inertia[body]) @ axes.T)


def _point(mass: float, place: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(mass * (place @ place * np.eye(3) - np.outer(place, place)))


def describe_links(model: Any) -> dict[str, dict[str, float]]:
    """Mass [kg] and first moments [kg·m] of each link in its own frame, and each rotor's inertia [kg·m²]."""
    result = {}
    for name in LINKS:
        body = model.body(name).id
        mass, centre = float(model.body_mass[body]), model.body_ipos[body]
        result[name] = {"mass": mass} | {axis: mass * float(centre[k]) for k, axis in enumerate("xyz")}
    return result


def compute_torques(
    model: Any, position: NDArray[np.float64], velocity: NDArray[np.float64], acceleration: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Torques of links and rotors along a motion [N·m]. Shape (n, 6)."""
    data: Any = mujoco.MjData(model)
    result = np.empty_like(position)
    for k in range(len(position)):
        data.qpos[:], data.qvel[:], data.qacc[:] = position[k], velocity[k], acceleration[k]
        mujoco.mj_inverse(model, data)
        result[k] = data.qfrc_inverse
    return result
