"""The arm in motion: MuJoCo's mass matrix and bias, a loop at every joint, friction solved for in each step."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import DiagnosisError

from .friction import solve_step
from .links import compute_torques, mujoco
from .motion import ArmReference

PERIOD = 0.002
"""Time between samples [s]."""

_STEP, _FINE_STEP = 1e-3, 5e-4  # [s] of the dynamics; the fine one where a gear's teeth meet
_BANDWIDTH, _DAMPING = 2.0 * np.pi * 7.0, 0.8  # of the position loops [rad/s], [1]
_SMOOTHING = 2e-3  # [s] of the load that friction sees: the acceleration of one step is not what a gear feels
_LOST = 0.5  # [rad] away from the reference an arm counts as unstable


@dataclass(frozen=True)
class Gap:
    """A gear whose teeth do not touch: the motor moves on its own within it.

    Attributes:
        joint: Number of the joint.
        width: Whole free travel [rad].
        stiffness: Of the teeth in contact [N·m/rad].
    """

    joint: int
    width: float
    stiffness: float


@dataclass(frozen=True)
class ArmRun:
    """What happened; arrays of shape (n, 6).

    Attributes:
        time: [s]. Shape (n,).
        position: That encoders see: of the motor where a joint has a gap [rad].
        velocity: Of the same [rad/s].
        torque: Of the motors, mean over a sample [N·m].
        load: Transmitted torque [N·m].
        heat: Temperature over that of the start [K].
    """

    time: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    torque: NDArray[np.float64]
    load: NDArray[np.float64]
    heat: NDArray[np.float64]


def run_arm(
    model: Any,
    believed: Any,
    table: NDArray[np.float64],
    reference: ArmReference,
    heat: NDArray[np.float64],
    gap: Gap | None = None,
) -> ArmRun:
    """Move the arm along a reference.

    Args:
        model: The true arm.
        believed: What the loop's feed-forward knows.
        table: Friction of the joints.
        reference: At `PERIOD`.
        heat: Temperature over that of the start [K]. Shape (n, 6).
        gap: Of one gear.

    Raises:
        DiagnosisError: The loop loses its reference.
    """
    ahead = compute_torques(believed, *reference)
    plant = _Plant(model, table, reference.position[0], gap)
    inertia = np.diag(plant.read_mass_matrix()) + model.dof_armature
    gains = inertia * _BANDWIDTH**2, inertia * 2.0 * _DAMPING * _BANDWIDTH
    n = len(reference.position)
    position, velocity, torque, load = (np.empty((n, 6)) for _ in range(4))
    for k in range(n):
        position[k], velocity[k] = plant.position, plant.velocity
        load[k] = plant.load
        torque[k] = plant.advance(reference.position[k], reference.velocity[k], ahead[k], gains, heat[k])
        if not np.abs(plant.position - reference.position[k]).max() < _LOST:
            raise DiagnosisError("the concealed arm is unstable: draw another seed")
    time = np.asarray(PERIOD * np.arange(n), dtype=np.float64)
    return ArmRun(time, position, velocity, torque, load, heat)


class _Plant:
    """State of the arm: links, and the motor of the one joint that may have a gap."""

    def __init__(self, model: Any, table: NDArray[np.float64], start: NDArray[np.float64], gap: Gap | None) -> None:
        self._model, self._data, self._table, self._gap = model, mujoco.MjData(model), table, gap
        self._step = _STEP if gap is None else _FINE_STEP
        self._links, self._rates = start.copy(), np.zeros(6)
        self._motor = float(start[gap.joint]) if gap is not None else 0.0
        self._motor_rate = 0.0
        self._armature = np.array(model.dof_armature)
        self._bristle, self.load = np.zeros(6), np.zeros(6)
        self._mass, self._bias, self._friction = np.zeros((6, 6)), np.zeros(6), np.zeros(6)
        if gap is not None:  # the motor's own friction and inertia are not the link's
            self._link_table, self._motor_table = table.copy(), table[gap.joint : gap.joint + 1].copy()
            self._link_table[gap.joint, :] = 0.0
            self._link_table[gap.joint, 3] = 1.0
            self._armature[gap.joint] = 0.0

    @property
    def position(self) -> NDArray[np.float64]:
        """That the encoders see [rad]."""
        return self._seen(self._links, self._motor)

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Of the same [rad/s]."""
        return self._seen(self._rates, self._motor_rate)

    def _seen(self, links: NDArray[np.float64], motor: float) -> NDArray[np.float64]:
        seen = links.copy()
        if self._gap is not None:
            seen[self._gap.joint] = motor
        return seen

    def read_mass_matrix(self) -> NDArray[np.float64]:
        """Of the links, without rotors [kg·m²]."""
        model, data = self._model, self._data
        data.qpos[:], data.qvel[:] = self._links, self._rates
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_crb(model, data)
        mujoco.mj_fullM(model, data, self._mass)
        mujoco.mj_comVel(model, data)
        mujoco.mj_rne(model, data, 0, self._bias)
        return self._mass - np.diag(model.dof_armature)

    def advance(
        self,
        position: NDArray[np.float64],
        velocity: NDArray[np.float64],
        ahead: NDArray[np.float64],
        gains: tuple[NDArray[np.float64], NDArray[np.float64]],
        heat: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """One sample; gives the mean torque of the motors [N·m]."""
        steps, total = round(PERIOD / self._step), np.zeros(6)
        for i in range(steps):
            target = position + i * self._step * velocity
            torque = ahead + gains[0] * (target - self.position) + gains[1] * (velocity - self.velocity)
            total += torque
            self._move(torque, heat)
        return total / steps

    def _move(self, torque: NDArray[np.float64], heat: NDArray[np.float64]) -> None:
        links, h = self.read_mass_matrix(), self._step
        force, table = torque - self._bias, self._table
        if self._gap is not None:
            force, table = self._drive_through_gap(torque, force, heat), self._link_table
        whole = links + np.diag(self._armature)
        new = solve_step(
            table, self._links, self._rates, self._bristle, self.load, heat, whole, force, h, self._friction
        )
        felt = links @ ((new - self._rates) / h) + self._bias
        self.load += (felt - self.load) * min(1.0, h / _SMOOTHING)
        self._links, self._rates = self._links + h * new, new

    def _drive_through_gap(
        self, torque: NDArray[np.float64], force: NDArray[np.float64], heat: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Move the motor of the joint with the gap; gives the forces on the links."""
        assert self._gap is not None
        j, h = self._gap.joint, self._step
        twist = self._motor - self._links[j]
        beyond = twist - np.clip(twist, -0.5 * self._gap.width, 0.5 * self._gap.width)
        inertia = float(self._model.dof_armature[j])
        damping = 0.2 * np.sqrt(self._gap.stiffness * inertia) if beyond else 0.0
        passed = self._gap.stiffness * beyond + damping * (self._motor_rate - self._rates[j])
        at, out = slice(j, j + 1), np.zeros(1)
        (rate,) = solve_step(
            self._motor_table,
            np.array([self._motor]),
            np.array([self._motor_rate]),
            self._bristle[at],
            self.load[at],
            heat[at],
            np.array([[inertia]]),
            np.array([torque[j] - passed]),
            h,
            out,
        )
        self._motor_rate, self._motor = float(rate), self._motor + h * float(rate)
        result = force.copy()
        result[j] = passed - self._bias[j]
        return result
