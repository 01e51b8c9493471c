"""Simulations as robots ship them, read for their mass and kinematics: what is only seen or touched plays no part."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from fricomp.errors import MissingExtraError, SimulationFileError
from fricomp.untrusted import read_whole

_NO_MASS, _NO_INERTIA = 1e-9, 1e-12
"""[kg] and [kg·m²] of moving bodies that a file gives none: nothing beside any link."""

_POSSIBLE = 1.0 - 1e-6
"""Of the sum of two moments of inertia that the third may be: rounding must not put it above again."""

_MACROS = ("<xacro:macro ", "<xacro:property ", "<xacro:if ", 'name="${', 'value="${')
"""What stands in the source of a URDF alone: xacro leaves none of it, and may leave `$(arg ...)` of other programs."""


def compile_simulation(path: str | Path, extra: str = "diagnose") -> Any:
    """Compile an MJCF or URDF file for MuJoCo, without meshes, height fields, textures and skins.

    A mesh that is not there (`package://`, a format that MuJoCo does not read) therefore stops nothing. Bodies that
    take their mass from a mesh need it all the same.

    Args:
        path: MJCF or URDF file.
        extra: The extra to name where MuJoCo is not installed.

    Returns:
        MuJoCo's `MjModel`.

    Raises:
        SimulationFileError: The file is not there, is no simulation, or a body has no mass but that of a mesh.
        MissingExtraError: MuJoCo is not installed.
    """
    spec = read_specification(path, extra)
    return compile_specification(spec, path)


def list_joints(path: str | Path) -> list[str]:
    """Names of all joints of a simulation, in the order of the file.

    Raises:
        SimulationFileError: As for `compile_simulation`.
        MissingExtraError: MuJoCo is not installed.
    """
    model = compile_simulation(path)
    return [model.joint(i).name for i in range(model.njnt)]


def compile_specification(spec: Any, path: str | Path) -> Any:
    """Compile what `read_specification` gives, with bodies that can exist.

    Robots ship moments of inertia that no body can have, and links without any mass. The former are lowered to what is
    possible, the latter get a mass that weighs nothing; MuJoCo refuses both.

    Raises:
        SimulationFileError: It is no simulation.
    """
    spec.compiler.boundmass = max(float(spec.compiler.boundmass), _NO_MASS)
    spec.compiler.boundinertia = max(float(spec.compiler.boundinertia), _NO_INERTIA)
    try:
        return spec.compile()
    except ValueError as error:
        if "balanceinertia" not in str(error):
            raise SimulationFileError(f"cannot read the simulation {path}: {error}") from error
    for body in spec.bodies:
        _make_possible(body)
    try:
        return spec.compile()
    except ValueError as error:
        raise SimulationFileError(f"cannot read the simulation {path}: {error}") from error


def read_specification(path: str | Path, extra: str = "diagnose") -> Any:
    """Read an MJCF or URDF file without what has its shape or look from a file; see `compile_simulation`.

    Returns:
        MuJoCo's `MjSpec`, which can be changed before it is compiled.
    """
    try:
        import mujoco
    except ImportError as error:
        raise MissingExtraError("mujoco", extra) from error
    if not Path(path).is_file():
        raise SimulationFileError(f"there is no simulation {path}: give an MJCF or URDF file")
    _refuse_macros(Path(path))
    try:
        spec: Any = mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise SimulationFileError(f"cannot read the simulation {path}: {error}") from error
    _remove_shapes(mujoco, spec, Path(path))
    return spec


def _refuse_macros(path: Path) -> None:
    """Refuse the source of a URDF: MuJoCo reads what is left when its macros are passed over, or ends at a number."""
    try:
        text = read_whole(path).decode("utf-8", "replace")
    except OSError as error:
        raise SimulationFileError(f"cannot read the simulation {path}: {error.strerror or error}") from error
    if any(mark in text for mark in _MACROS):
        raise SimulationFileError(
            f"{path} is the xacro that a URDF is made of, with macros and values to fill in: give what "
            f"`xacro {path.name} > robot.urdf` writes"
        )


class Mimic(NamedTuple):
    """A joint that a linkage, or `mimic` in a URDF, moves with another.

    Attributes:
        follower: Number of the joint.
        leader: Number of the joint that it follows.
        path: Its position over that of the leader.
    """

    follower: int
    leader: int
    path: Polynomial


def list_mimics(model: Any) -> list[Mimic]:
    """Joints of a compiled model that an equality of two joints ties to another: q - q_0 = poly(q' - q'_0)."""
    import mujoco

    found = []
    for e in range(model.neq):
        if int(model.eq_type[e]) != int(mujoco.mjtEq.mjEQ_JOINT) or not model.eq_active0[e]:
            continue
        follower, leader = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
        if leader < 0:
            continue
        start, shift = (float(model.qpos0[model.jnt_qposadr[i]]) for i in (follower, leader))
        shape = Polynomial(model.eq_data[e][:5]).trim()
        found.append(Mimic(follower, leader, shape(Polynomial([-shift, 1.0])) + start))
    return found


def list_followers(model: Any, leaders: Sequence[int]) -> list[Mimic]:
    """Joints that an equality ties to one of these, and that are none of them.

    Args:
        model: A compiled model.
        leaders: Numbers of joints.
    """
    return [one for one in list_mimics(model) if one.leader in leaders and one.follower not in leaders]


def _remove_shapes(mujoco: Any, spec: Any, path: Path) -> None:
    """Delete what has its shape or its look from a file; shapes that need none keep the mass that they give."""
    for geom in [each for each in spec.geoms if each.type in _from_file(mujoco)]:
        body = geom.parent
        if body.joints and not _has_mass_of_its_own(mujoco, body):
            raise SimulationFileError(
                f"{path}: body {body.name!r} has no mass but that of a mesh: give it an <inertial> element"
            )
        spec.delete(geom)
    for each in (*spec.geoms, *spec.sites, *spec.tendons):
        each.material = ""
    for each in (*spec.skins, *spec.meshes, *spec.hfields, *spec.materials, *spec.textures):
        spec.delete(each)


def _from_file(mujoco: Any) -> tuple[Any, ...]:
    kinds = mujoco.mjtGeom
    return kinds.mjGEOM_MESH, kinds.mjGEOM_HFIELD, kinds.mjGEOM_SDF


def _has_mass_of_its_own(mujoco: Any, body: Any) -> bool:
    """Whether a body states its inertia, or has shapes that need no file."""
    return bool(body.explicitinertial) or any(geom.type not in _from_file(mujoco) for geom in body.geoms)


def _make_possible(body: Any) -> None:
    """Lower the largest moment of inertia of a body to the sum of the others, which no body exceeds."""
    import mujoco

    full = np.array(body.fullinertia)
    turn = np.zeros(9)
    if np.isfinite(full[0]):
        xx, yy, zz, xy, xz, yz = full
        moments, axes = np.linalg.eigh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        mujoco.mju_quat2Mat(turn, np.array(body.iquat))
        axes = turn.reshape(3, 3) @ axes
        axes[:, 0] *= np.sign(np.linalg.det(axes))
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, axes.ravel())
        body.fullinertia, body.iquat = [np.nan] * 6, quaternion
    else:
        moments = np.array(body.inertia)
    most = int(np.argmax(moments))
    moments[most] = min(moments[most], _POSSIBLE * float(np.sum(moments) - moments[most]))
    body.inertia = moments
