"""An arm as its simulation has it: joints, links, what each link weighs, and where each is as the joints move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from fricomp.errors import SimulationFileError
from fricomp.laws import FloatArray
from fricomp.simulation_file import compile_simulation, list_followers, list_mimics

from .inertia import LinkCoordinates, combine_inertia
from .kinematics import JointMotion, move_bodies
from .naming import match_in_order, match_joints


class LinkMotion(NamedTuple):
    """How one link moves along a recording, in its own frame about its own origin.

    Attributes:
        angular_velocity: [rad/s]. Shape (n, 3).
        angular_acceleration: [rad/s²]. Shape (n, 3).
        acceleration: Of the origin, with that of gravity taken off [m/s²]. Shape (n, 3).
        translation: Motion of the origin for each joint [m/rad]. Shape (n, 3, n_joints).
        rotation: Turn of the link for each joint [rad/rad]. Shape (n, 3, n_joints).
        lean: Change of `acceleration` as gravity leans over by a radian, for each of `SimulatedArm.level_axes`
            [m/s²/rad]. Shape (n, 3, 2).
    """

    angular_velocity: FloatArray
    angular_acceleration: FloatArray
    acceleration: FloatArray
    translation: FloatArray
    rotation: FloatArray
    lean: FloatArray


@dataclass(frozen=True)
class Follower:
    """A joint that a linkage or a mimic of the file moves with a recorded one.

    Attributes:
        name: Of the joint.
        leader: Number of the recorded joint.
        path: Its position over that of the leader.
    """

    name: str
    leader: int
    path: Polynomial


@dataclass(frozen=True, eq=False)
class SimulatedArm:
    """Kinematics and inertia of an arm.

    Attributes:
        joints: Names of the joints that were recorded, in the order of all columns.
        links: Names of the links that these joints move.
        inertia: Mass [kg], first moments [kg·m] and moments of inertia [kg·m²] of each link about its own origin: m,
            h_x, h_y, h_z, I_xx, I_xy, I_xz, I_yy, I_yz, I_zz. Shape (n_links, 10).
        armature: Inertia of each joint's rotor behind its gear [kg·m²] or [kg]. Shape (n_joints,).
        friction: Coulomb [N·m] or [N] and viscous friction [N·m·s/rad] or [N·s/m] that the file states of each joint.
            Shape (n_joints, 2).
        rotary: Whether each joint turns.
        held: Names of the joints that nothing was recorded of: they stay where the simulation has them.
        followers: Joints that move with a recorded one.
        remounted: Whether gravity is another one than in the file.
        in_order: Whether recorded joints have numbers alone, and were taken for those of the chain in its order.
        carried: As `inertia`, of the bodies alone that are fixed to a link or held on it. Shape (n_links, 10).
    """

    joints: tuple[str, ...]
    links: tuple[str, ...]
    inertia: FloatArray
    armature: FloatArray
    friction: FloatArray
    rotary: tuple[bool, ...]
    held: tuple[str, ...]
    followers: tuple[Follower, ...]
    carried: FloatArray
    _model: Any
    _bodies: tuple[int, ...]
    _pose: FloatArray
    remounted: bool = False
    in_order: bool = False

    def follow(self, position: FloatArray, velocity: FloatArray, acceleration: FloatArray) -> list[LinkMotion]:
        """Move the links as the joints moved.

        Args:
            position: [rad] or [m]. Shape (n, n_joints), like the others.
            velocity: [rad/s] or [m/s].
            acceleration: [rad/s²] or [m/s²].

        Returns:
            The motion of each of `links`.
        """
        far = _follow_paths(self.followers, position, velocity, acceleration)
        recorded = [self._model.joint(name).id for name in self.joints]
        leaders = [one.leader for one in self.followers]
        following = [self._model.joint(one.name).id for one in self.followers]
        motions = {
            j: JointMotion(*columns)
            for j, *columns in zip(recorded, position.T, velocity.T, acceleration.T, strict=True)
        }
        motions |= {
            j: JointMotion(*columns) for j, *columns in zip(following, *(each.T for each in far[:3]), strict=True)
        }
        moved = move_bodies(self._model, self._pose, motions, self._bodies, len(position))
        down, level = float(np.linalg.norm(self.gravity)), np.array([self.level_axes[name] for name in self.level_axes])
        links = []
        for body in (moved[number] for number in self._bodies):
            columns = np.stack([np.concatenate(body.build_jacobian(j), axis=1) for j in recorded], axis=2)
            for j, leader, slope in zip(following, leaders, far[3].T, strict=True):
                columns[:, :, leader] += slope[:, None] * np.concatenate(body.build_jacobian(j), axis=1)
            links.append(
                LinkMotion(
                    angular_velocity=body.in_own_axes(body.angular_velocity),
                    angular_acceleration=body.in_own_axes(body.angular_acceleration),
                    acceleration=body.in_own_axes(body.acceleration),
                    translation=columns[:, :3],
                    rotation=columns[:, 3:],
                    lean=-down * np.stack([body.in_own_axes(np.tile(e, (len(position), 1))) for e in level], axis=2),
                )
            )
        return links

    def with_gravity(self, gravity: FloatArray) -> SimulatedArm:
        """The same arm, mounted so that gravity is another [m/s²]. Shape (3,)."""
        model = copy(self._model)
        model.opt.gravity[:] = gravity
        return replace(self, _model=model, remounted=True)

    @cached_property
    def link_coordinates(self) -> tuple[LinkCoordinates, ...]:
        """Coordinates of each link about its simulated inertia."""
        return tuple(map(LinkCoordinates, self.inertia))

    @cached_property
    def all_coordinates(self) -> LinkCoordinates:
        """The same of all links at once."""
        return LinkCoordinates(self.inertia)

    @property
    def gravity(self) -> FloatArray:
        """Of the file [m/s²]. Shape (3,)."""
        return np.array(self._model.opt.gravity, dtype=np.float64)

    @property
    def other_gravity(self) -> tuple[float, float, float] | None:
        """The same where it is another one than in the file."""
        x, y, z = self.gravity.tolist()
        return (x, y, z) if self.remounted else None

    @property
    def level_axes(self) -> dict[str, FloatArray]:
        """The two axes of the world that lie most level, by their names, as directions at right angles to gravity."""
        down = self.gravity / max(float(np.linalg.norm(self.gravity)), 1e-12)
        first, second = sorted(np.argsort(np.abs(down))[:2].tolist())
        x = np.eye(3)[first] - down[first] * down
        x /= np.linalg.norm(x)
        y = np.cross(down, x)
        return {"xyz"[first]: x, "xyz"[second]: y * np.sign(y[second])}

    @property
    def order(self) -> tuple[int, ...]:
        """Numbers of the recorded joints in the order of the file, from the base outwards."""
        ids = [self._model.joint(name).id for name in self.joints]
        return tuple(sorted(range(len(ids)), key=ids.__getitem__))

    @property
    def last_link(self) -> int:
        """Number of the link at the end of the chain."""
        return self._bodies.index(int(self._model.jnt_bodyid[self._model.joint(self.joints[self.order[-1]]).id]))

    @property
    def moving_joints(self) -> frozenset[str]:
        """Names of the joints that were recorded, and of those that follow them."""
        return frozenset((*self.joints, *(one.name for one in self.followers)))


def _follow_paths(
    followers: Sequence[Follower], position: FloatArray, velocity: FloatArray, acceleration: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Position, velocity and acceleration of followers, and the slope of each path. Shapes (n, n_followers)."""
    motion = np.zeros((4, len(position), len(followers)))
    for i, one in enumerate(followers):
        q, v, a = (each[:, one.leader] for each in (position, velocity, acceleration))
        slope, bend = one.path.deriv()(q), one.path.deriv(2)(q)
        motion[:, :, i] = one.path(q), slope * v, slope * a + bend * v**2, slope
    return motion[0], motion[1], motion[2], motion[3]


def read_arm(
    path: str | Path,
    joints: Sequence[str],
    names: Mapping[str, str] | None = None,
    still: Mapping[str, float] | None = None,
) -> SimulatedArm:
    """Read an arm from MJCF or URDF.

    Joints that mimic a recorded one, by URDF's `mimic` or MJCF's equality of two joints, move with it. Other joints
    that are not listed, such as those of a gripper or of a second arm, are held where the file has them.

    Args:
        path: The file.
        joints: Names of the recorded joints, in the order of their columns.
        names: Names in the simulation by such names, where they differ by more than the word joint.
        still: Positions [rad] or [m] of joints that stood still, by their names in the simulation: they are held there.

    Raises:
        SimulationFileError: The file cannot be read, lacks a joint, a joint is neither a hinge nor a slide, or the base
            that carries them floats.
    """
    model = compile_simulation(path)
    import mujoco

    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE): True, int(mujoco.mjtJoint.mjJNT_SLIDE): False}
    every = [model.joint(i).name for i in range(model.njnt)]
    movable = [name for i, name in enumerate(every) if int(model.jnt_type[i]) in kinds]
    in_order = {} if names else _match_in_order(model, joints, movable)
    matched = in_order or match_joints(joints, movable, names or {})
    ids = [every.index(matched[name]) for name in joints]
    dofs = model.jnt_dofadr[ids]
    _refuse_floating(model, ids, path)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT) | int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    followers = tuple(
        Follower(model.joint(one.follower).name, ids.index(one.leader), one.path) for one in list_followers(model, ids)
    )
    moved = _find_moved(model, [*ids, *(every.index(one.name) for one in followers)])
    carried = {body: [each for each in range(model.nbody) if _link_of(model, each, moved) == body] for body in moved}
    moving = {*matched.values(), *(one.name for one in followers)}
    pose = _place_still(model, ids, {every.index(name): place for name, place in (still or {}).items()})
    return SimulatedArm(
        joints=tuple(matched[name] for name in joints),
        links=tuple(model.body(body).name or f"body {body}" for body in moved),
        inertia=np.array([_weigh(model, pose, body, carried[body]) for body in moved]),
        armature=np.array(model.dof_armature[dofs]),
        friction=np.stack([model.dof_frictionloss[dofs], np.ravel(model.dof_damping)[dofs]], axis=1),
        rotary=tuple(kinds[int(model.jnt_type[i])] for i in ids),
        held=tuple(name for name in every if name not in moving),
        followers=followers,
        carried=np.array([_weigh(model, pose, body, [i for i in carried[body] if i != body]) for body in moved]),
        _model=model,
        _bodies=tuple(moved),
        _pose=pose,
        in_order=bool(in_order),
    )


def _match_in_order(model: Any, joints: Sequence[str], movable: Sequence[str]) -> dict[str, str]:
    """Names of joints by their place in the chain, where names say nothing and there is no other; else none."""
    try:
        match_joints(joints, movable, {})
    except SimulationFileError:
        return match_in_order(joints, _list_chain(model, movable))
    return {}


def _list_chain(model: Any, movable: Sequence[str]) -> list[str]:
    """Names of the joints that move by themselves, from the base outwards; none where they branch."""
    following = {model.joint(one.follower).name for one in list_mimics(model)}
    chain = [name for name in movable if name not in following]
    bodies = [int(model.jnt_bodyid[model.joint(name).id]) for name in chain]
    return chain if all(_link_of(model, above, [below]) == below for below, above in pairwise(bodies)) else []


def _refuse_floating(model: Any, joints: Sequence[int], path: str | Path) -> None:
    """Refuse an arm whose base moves in ways that nobody recorded."""
    import mujoco

    free = (int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL))
    loose = {int(model.jnt_bodyid[i]): model.joint(i).name for i in range(model.njnt) if int(model.jnt_type[i]) in free}
    for joint in joints:
        body = int(model.jnt_bodyid[joint])
        while body:
            if body in loose:
                raise SimulationFileError(
                    f"{path}: joint {model.joint(joint).name!r} stands on body {model.body(body).name!r}, which floats "
                    f"(joint {loose[body]!r}), and nothing was recorded of it. If it stood still, take that joint out "
                    "of the file"
                )
            body = int(model.body_parentid[body])


def _place_still(model: Any, recorded: Sequence[int], still: Mapping[int, float]) -> FloatArray:
    """The pose in which joints are held: where they stood still, and what follows one of those where it takes it."""
    pose, places = np.array(model.qpos0), dict(still)
    for one in list_mimics(model):
        if one.leader in still and one.follower not in (*recorded, *still):
            places[one.follower] = float(one.path(still[one.leader]))
    for joint, place in places.items():
        pose[model.jnt_qposadr[joint]] = place
    return pose


def _find_moved(model: Any, joints: Sequence[int]) -> list[int]:
    """Bodies that a recorded joint is of: with all that is fixed to one, it is one link."""
    return sorted({int(model.jnt_bodyid[i]) for i in joints})


def _link_of(model: Any, body: int, moved: Sequence[int]) -> int:
    """The link that carries a body: the nearest one below it that a recorded joint moves."""
    while body and body not in moved:
        body = int(model.body_parentid[body])
    return body


def _weigh(model: Any, pose: FloatArray, link: int, bodies: Sequence[int]) -> FloatArray:
    """Inertia of bodies that are fixed to a link about its own origin, the held joints as they are."""
    import mujoco

    data: Any = mujoco.MjData(model)
    data.qpos[:] = pose
    mujoco.mj_kinematics(model, data)
    origin, turn = np.array(data.xpos[link]), np.array(data.xmat[link]).reshape(3, 3)
    total = np.zeros(10)
    for body in bodies:
        centre = turn.T @ (data.xipos[body] - origin)
        axes = turn.T @ np.array(data.ximat[body]).reshape(3, 3)
        about = axes @ np.diag(model.body_inertia[body]) @ axes.T
        total += combine_inertia(float(model.body_mass[body]), centre, about)
    return total
