"""The joint as MJCF text: a plain one, as simulations have it, and one with parts that the plain file leaves out."""

from dataclasses import dataclass

__all__ = [
    "COULOMB",
    "INERTIA",
    "JOINT",
    "LINK",
    "PLAIN",
    "STATIC",
    "STICKING",
    "STRIBECK",
    "VISCOUS",
    "JointParts",
    "write_mjcf",
]

JOINT = "elbow"
"""Name of the joint that is recorded."""

LENGTH, MASS, TURNING, ARMATURE = 0.22, 4.0, 0.02, 0.15
"""Distance of the link's centre of mass [m], its mass [kg], its inertia about that centre and the motor's [kg·m²]."""

INERTIA = MASS * LENGTH**2 + TURNING + ARMATURE
"""Of the plain joint about its axis [kg·m²]."""

COULOMB, STATIC, STRIBECK, VISCOUS = 2.0, 2.5, 0.06, 1.2
"""Friction of every joint: sliding and static torque [N·m], Stribeck velocity [rad/s], damping [N·m·s/rad]."""

LINK = f'<inertial pos="0 0 -{LENGTH}" mass="{MASS}" diaginertia="{TURNING} {TURNING} {TURNING}"/>'
"""The link below its axis."""

STICKING = 'solreffriction="0.002 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'
"""Attributes with which friction loss holds a joint at rest; with MuJoCo's usual ones it creeps."""

_XML = """<mujoco model="arm">
  <compiler angle="radian"/>
  <option timestep="{step}" integrator="implicitfast" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="upper" pos="0 0 1">
      <joint name="{joint}" type="hinge" axis="0 1 0" armature="{armature}" damping="{damping}"
             frictionloss="{loss}" {more}/>
      {link}
    </body>
    {beside}
  </worldbody>
  {connection}
  <actuator>{actuator}</actuator>
</mujoco>
"""


@dataclass(frozen=True)
class JointParts:
    """Pieces of MJCF that differ between joints; those of the plain joint by default.

    Attributes:
        damping: Of the joint, as MuJoCo reads it: one number, or the coefficients of v, v |v| and so on.
        armature: Inertia of the motor [kg·m²].
        attributes: Further attributes of the joint.
        link: What hangs on the joint: its inertia and child bodies.
        beside: Bodies beside the joint's own.
        connection: Elements beside the bodies, such as tendons.
        actuator: The motor.
        bearer: Name of the joint that bears the dry friction.
    """

    damping: str = f"{VISCOUS}"
    armature: float = ARMATURE
    attributes: str = ""
    link: str = LINK
    beside: str = ""
    connection: str = ""
    actuator: str = f'<motor name="{JOINT}" joint="{JOINT}"/>'
    bearer: str = JOINT


PLAIN = JointParts()
"""Nothing is left out."""


def write_mjcf(parts: JointParts, step: float, *, sticks: bool = True) -> str:
    """The MJCF file of a joint.

    Args:
        parts: What it is made of.
        step: Of the simulation [s].
        sticks: Its friction loss holds the joint at rest; else it has MuJoCo's usual impedance, as ordinary files do.
    """
    more = f"{STICKING if sticks else ''} {parts.attributes}".strip()
    text = _XML.format(
        step=step,
        joint=JOINT,
        damping=parts.damping,
        loss=COULOMB if parts.bearer == JOINT else 0.0,
        armature=parts.armature,
        more=more,
        link=parts.link,
        beside=parts.beside,
        connection=parts.connection,
        actuator=parts.actuator,
    )
    return "\n".join(line.rstrip() for line in text.splitlines() if line.strip()) + "\n"
