"""The mechanics of the stand-in: MuJoCo steps the bodies, friction sticks and slides as a law says."""

from collections.abc import Callable, MutableSequence, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any, Literal

from fricomp.errors import MissingExtraError, ParameterError
from fricomp.laws import DynamicTerm, FrictionLaw, OperatingPoint

from .friction import Contact, JointFriction, has_bristle

try:
    import mujoco
except ImportError as error:  # pragma: no cover - depends on the installation
    raise MissingExtraError("mujoco", "sim") from error

__all__ = ["NormalLoad", "Plant", "ThermalSettings"]

NormalLoad = float | Literal["transmitted"] | None
"""Normal load on the friction contact: a constant, the size of the transmitted torque, or unknown."""

# Stiff enough that a joint under 90 % of its breakaway torque creeps by microradians a second; with the time
# constant at two steps the constraint aims at zero velocity at the end of the very step (measured, docs/stand_in.md).
FRICTION_IMPEDANCE = (0.9999, 0.9999, 0.001, 0.5, 2.0)
# Largest dt/J times the bristle's torque per velocity in one substep; 4 is the limit of stability.
BRISTLE_STEP = 0.1
MAX_SUBSTEPS = 64


@dataclass(frozen=True)
class ThermalSettings:
    """First-order warming of a joint by its own friction: T' = (T_a + R P - T) / time_constant.

    Attributes:
        ambient: T_a, also the temperature at the start [°C].
        heating: R, steady rise per watt of friction [K/W]; 0 keeps the joint at T_a.
        time_constant: [s].
    """

    ambient: float = 25.0
    heating: float = 0.0
    time_constant: float = 300.0

    def __post_init__(self) -> None:
        if not (self.heating >= 0.0 and self.time_constant > 0.0):
            raise ParameterError(
                f"heating must not be negative and time_constant positive, got {self.heating} and {self.time_constant}"
            )


class Plant:
    """Some joints of an MJCF model under torque, with friction from laws.

    Actuators, damping and friction that the file itself gives these joints are switched off: the drive's torque
    comes from outside and friction from the law alone.

    Args:
        mjcf: The model file.
        joints: Names of hinge or slide joints, in the order of all sequences here.
        laws: Friction of each joint.
        period: Step of `step` [s].
        normal_load: Of each joint; None for all where no law needs it.
        thermal: Of each joint; None for 25 °C throughout.

    Raises:
        ParameterError: The file is not a model, a joint is not in it, or a law is too stiff for the period.
    """

    def __init__(
        self,
        mjcf: Path | str,
        joints: Sequence[str],
        laws: Sequence[FrictionLaw],
        *,
        period: float = 1e-3,
        normal_load: Sequence[NormalLoad] | None = None,
        thermal: Sequence[ThermalSettings] | None = None,
    ) -> None:
        self.joints = tuple(joints)
        n = len(self.joints)
        for what, given in (("laws", laws), ("normal loads", normal_load), ("thermal settings", thermal)):
            if given is not None and len(given) != n:
                raise ParameterError(f"{len(given)} {what} given for {n} joints: give one for each")
        self.model = load_model(mjcf)
        self.data: Any = mujoco.MjData(self.model)
        self.frictions = [JointFriction(law) for law in laws]
        self.contacts = [Contact() for _ in laws]
        self._normal_load = tuple(normal_load or (None,) * n)
        for contact, load in zip(self.contacts, self._normal_load, strict=True):
            contact.normal_load = None if load == "transmitted" else load
        self._thermal = tuple(thermal or (ThermalSettings(),) * n)
        self._locate([_joint_id(self.model, name) for name in self.joints])
        self._take_over()
        mujoco.mj_forward(self.model, self.data)
        self._map_memory()
        self.inertias = tuple(self._M[a] for a in self._diagonal)
        """Inertia about each joint in the model's initial pose, others held [kg·m²]."""
        self.period = period
        self.substeps = self._needed_substeps(period)
        self.model.opt.timestep = self._h = period / self.substeps
        self.model.dof_solref[self._dofs] = (2.0 * self._h / FRICTION_IMPEDANCE[1], 1.0)
        self.reset([self._qpos[a] for a in self._positions])

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.data.time)

    def reset(self, position: Sequence[float], velocity: Sequence[float] | None = None) -> None:
        """Start again at time zero, at ambient temperature.

        Args:
            position: Of each joint [rad] or [m].
            velocity: Of each joint [rad/s] or [m/s]; None for rest.
        """
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self._positions] = position
        self.data.qvel[self._dofs] = velocity if velocity is not None else 0.0
        self.model.dof_frictionloss[self._dofs] = 0.0
        mujoco.mj_forward(self.model, self.data)
        self.temperature = [settings.ambient for settings in self._thermal]
        self.friction_torque = [0.0] * len(self.joints)
        """Torque that friction took during the last step, signed as the laws are [N·m]."""
        self.load_torque = [0.0] * len(self.joints)
        """Torque that each joint transmitted to its load during the last step [N·m]."""
        for friction in self.frictions:
            friction.reset()
        self._warm = any(settings.heating > 0.0 for settings in self._thermal)

    def position(self, joint: int) -> float:
        """True position of a joint [rad] or [m]."""
        return self._qpos[self._positions[joint]]

    def velocity(self, joint: int) -> float:
        """True velocity of a joint [rad/s] or [m/s]."""
        return self._qvel[self._dofs[joint]]

    def step(self, torque: Sequence[float], disturbance: Sequence[float] | None = None) -> None:
        """Advance by one period.

        Args:
            torque: Of each drive on its joint, held over the period [N·m].
            disturbance: External torque on each joint [N·m].
        """
        total = torque if disturbance is None else [t + d for t, d in zip(torque, disturbance, strict=True)]
        for _ in range(self.substeps):
            for joint in self._indices:
                self._load_joint(joint, total[joint])
            self._mj_step(self.model, self.data)
            for joint in self._indices:
                self._account(joint, torque[joint])
        if self._warm:
            self._warm_up()

    def _load_joint(self, joint: int, applied: float) -> None:
        """Set the applied torque and the friction level of one joint for the coming substep."""
        dof, friction, contact = self._dofs[joint], self.frictions[joint], self.contacts[joint]
        velocity, inertia = self._qvel[dof], self._M[self._diagonal[joint]]
        contact.position = self._qpos[self._positions[joint]]
        if self._normal_load[joint] == "transmitted":
            contact.normal_load = abs(self.load_torque[joint])
        if friction.inputs:
            contact.acceleration, contact.load_torque = self._qacc[dof], self.load_torque[joint]
            contact.temperature = self.temperature[joint]
        if friction.pushes:
            applied -= friction.applied(velocity, contact, self._h)
        # All forces but friction, as of the last step, with the change of the applied torque; the other joints'
        # accelerations enter through the coupling that M qacc - friction already holds.
        free = inertia * self._qacc[dof] - self._constraint[dof] + applied - self._applied[dof]
        mobility = self._h / inertia
        self._frictionloss[dof] = friction.level(velocity, velocity + mobility * free, mobility, contact)
        self._applied[dof] = applied

    def _account(self, joint: int, torque: float) -> None:
        """Note what friction and load were over the substep."""
        dof, friction = self._dofs[joint], self.frictions[joint]
        low, high = self._free_range[joint]
        is_free = low < self.contacts[joint].position < high
        resistance = -self._constraint[dof] if is_free else -self._friction_row(dof)
        if friction.pushes:
            resistance += friction.offset + friction.bristle_torque
        self.friction_torque[joint] = resistance
        self.load_torque[joint] = torque - resistance - self._armature[joint] * self._qacc[dof]

    def _friction_row(self, dof: int) -> float:
        """The part of the constraint force on `dof` that is friction, where end stops or contacts may act too."""
        data = self.data
        if data.nefc == data.nf or self._frictionloss[dof] == 0.0:
            return self._constraint[dof] if data.nefc == data.nf else 0.0
        # Friction rows follow the equalities, one for each degree of freedom that has a level.
        row = data.ne + sum(self._frictionloss[before] > 0.0 for before in range(dof))
        return float(data.efc_force[row])

    def _warm_up(self) -> None:
        for joint, settings in enumerate(self._thermal):
            power = abs(self.friction_torque[joint] * self._qvel[self._dofs[joint]])
            target = settings.ambient + settings.heating * power
            self.temperature[joint] += (target - self.temperature[joint]) * self.period / settings.time_constant

    def _locate(self, ids: Sequence[int]) -> None:
        """Find where the joints' numbers stand in MuJoCo's arrays."""
        model = self.model
        self._indices = range(len(ids))
        self._dofs = [int(model.jnt_dofadr[i]) for i in ids]
        self._positions = [int(model.jnt_qposadr[i]) for i in ids]
        self._diagonal = [int(model.M_rowadr[d] + model.M_rownnz[d] - 1) for d in self._dofs]
        self._armature = [float(model.dof_armature[d]) for d in self._dofs]
        self._free_range = [_free_range(model, i) for i in ids]
        self.position_limits = tuple(_position_limits(model, i) for i in ids)
        """End stops of each joint [rad] or [m]; None where it turns freely."""
        self.linear = tuple(mujoco.mjtJoint(model.jnt_type[i]) == mujoco.mjtJoint.mjJNT_SLIDE for i in ids)
        """Whether each joint slides instead of turning."""

    def _take_over(self) -> None:
        model, dofs = self.model, self._dofs
        # Nothing here reads MuJoCo's sensors, and finding islands costs more than it saves on a few joints.
        for flag in ("ACTUATION", "SENSOR", "ISLAND"):
            model.opt.disableflags |= getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}")
        model.dof_damping[dofs] = 0.0
        model.dof_dampingpoly[dofs] = 0.0
        model.dof_frictionloss[dofs] = 0.0
        model.dof_solimp[dofs] = FRICTION_IMPEDANCE

    def _map_memory(self) -> None:
        """Views of MuJoCo's arrays that read and write plain floats, several times faster than numpy scalars."""
        data = self.data
        self._qpos, self._qvel, self._qacc = _floats(data.qpos), _floats(data.qvel), _floats(data.qacc)
        self._applied, self._constraint = _floats(data.qfrc_applied), _floats(data.qfrc_constraint)
        self._M, self._frictionloss = _floats(data.M), _floats(self.model.dof_frictionloss)
        self._mj_step: Callable[[Any, Any], None] = mujoco.mj_step

    def _needed_substeps(self, period: float) -> int:
        """Steps a period so that the bristles' stiffness is resolved: dt/J times torque per velocity is small."""
        most = 1
        for friction, inertia in zip(self.frictions, self.inertias, strict=True):
            for term in friction.law.terms:
                if isinstance(term, DynamicTerm) and has_bristle(term):
                    most = max(most, _substeps(term, inertia, period))
        return most


def _floats(array: Any) -> MutableSequence[float]:
    view: Any = memoryview(array)
    return view  # type: ignore[no-any-return]


def load_model(mjcf: Path | str) -> Any:
    """Compile an MJCF file.

    Raises:
        ParameterError: It does not exist or is not a model.
    """
    try:
        return mujoco.MjModel.from_xml_path(str(mjcf))
    except ValueError as error:
        raise ParameterError(f"{mjcf} is not a model that MuJoCo can load: {error}") from error


def _joint_id(model: Any, name: str) -> int:
    names = [model.joint(i).name for i in range(model.njnt)]
    if name not in names:
        raise ParameterError(
            f"the simulated joint is called {', '.join(names)}, and not {name!r}: name it so in the configuration"
        )
    kind = mujoco.mjtJoint(model.jnt_type[names.index(name)])
    if kind not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
        raise ParameterError(f"joint {name!r} is neither a hinge nor a slide: name one that has a single axis")
    return names.index(name)


def _position_limits(model: Any, joint: int) -> tuple[float, float] | None:
    if not model.jnt_limited[joint]:
        return None
    low, high = (float(edge) for edge in model.jnt_range[joint])
    return low, high


def _free_range(model: Any, joint: int) -> tuple[float, float]:
    """Positions at which no constraint but friction can act on a joint; empty where contacts or couplings exist."""
    contacts = not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONTACT) and model.ngeom > 1
    if contacts or model.neq or model.ntendon:
        return inf, -inf
    if not model.jnt_limited[joint]:
        return -inf, inf
    margin = float(model.jnt_margin[joint])
    return float(model.jnt_range[joint][0]) + margin, float(model.jnt_range[joint][1]) - margin


def _substeps(term: DynamicTerm, inertia: float, period: float) -> int:
    slow = OperatingPoint(1e-9)
    for count in range(1, MAX_SUBSTEPS + 1):
        h = period / count
        torque, _ = term.advance(term.rest_state(), slow, h)
        if h / inertia * float(torque) / 1e-9 <= BRISTLE_STEP:
            return count
    raise ParameterError(
        f"{term.name} is too stiff for inertia {inertia:.3g} kg·m² at a step of {period} s: "
        f"lower sigma_0 or sigma_1, or shorten the period"
    )
