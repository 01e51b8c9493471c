"""A joint that swings a link in the vertical plane, with friction that its model does not know of."""

import math
from dataclasses import dataclass
from pathlib import Path

from fricomp.control import PositionController, ReferenceState
from fricomp.joint import JointFeedback
from fricomp.laws import Cogging, FrictionLaw, LoadCoulomb
from fricomp.whole_file import write_whole

from ...stand_in import JointSettings, ServoSettings, StandInSettings, sensors_for
from .joint import INERTIA, JOINTS

_MASS, _REACH, _ARMATURE = 1.5, 0.2, 0.02  # [kg], [m], [kg·m²]
_GRAVITY = 9.81 * _MASS * _REACH  # [N·m]

CONCEALED = (LoadCoulomb(0.12), Cogging(0.06, 0.05, 11.0))
"""Beside gravity of 2.9 N·m up to 0.35 N·m of friction from the load, and a ripple of 0.08 N·m."""

_MJCF = f"""<mujoco model="vertical_joint">
  <!-- At zero the link hangs straight down. Friction is not in this file: the stand-in adds it. -->
  <compiler angle="radian"/>
  <option timestep="0.001" gravity="0 0 -9.81">
    <flag contact="disable"/>
  </option>
  <worldbody>
    <body name="link">
      <inertial pos="0 0 -{_REACH}" mass="{_MASS}" diaginertia="0.02 0.02 0.002"/>
      <joint name="joint" axis="0 -1 0" range="-2.6 2.6" limited="true" armature="{_ARMATURE}"/>
    </body>
  </worldbody>
</mujoco>
"""


def vertical_joint(folder: Path, *, position: float = 0.0) -> StandInSettings:
    """The joint with Stribeck friction and `CONCEALED`; its mechanism is written to `joint.xml`.

    Args:
        folder: Where the file goes.
        position: Where the joint starts [rad].
    """
    mjcf = folder / "joint.xml"
    write_whole(mjcf, _MJCF)
    known = JOINTS["moderate"].law
    law = FrictionLaw((*known.terms, *CONCEALED))
    joint = JointSettings("joint", law, sensors_for(known), ServoSettings(torque_limit=12.0), position=position)
    return StandInSettings(mjcf, (joint,))


@dataclass(frozen=True)
class GravityController:
    """PD with the torque of the rigid body, which is the load that the friction depends on.

    Attributes:
        feedback: The PD controller with inertia.
    """

    feedback: PositionController

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill in the torque without compensation."""
        self.feedback.torque_into(out, feedback, reference)
        out[0] += _GRAVITY * math.sin(reference.position[0])

    def load_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill in what the link asks for: gravity, and its part of the inertia."""
        out[0] = _GRAVITY * math.sin(reference.position[0]) + (INERTIA - _ARMATURE) * reference.acceleration[0]


@dataclass(frozen=True)
class MultiSine:
    """A sum of cosines on one joint, which starts at rest: q = sum A cos(2 pi f t).

    Attributes:
        parts: Amplitude [rad] and frequency [Hz] of each.
    """

    parts: tuple[tuple[float, float], ...]

    @property
    def start(self) -> float:
        """Position at time zero [rad]."""
        return sum(amplitude for amplitude, _ in self.parts)

    def sample(self, time: float, state: ReferenceState) -> None:
        """Fill in the motion at `time` [s]."""
        q = v = a = 0.0
        for amplitude, frequency in self.parts:
            omega = 2.0 * math.pi * frequency
            wave = amplitude * math.cos(omega * time)
            q, v, a = q + wave, v - amplitude * omega * math.sin(omega * time), a - omega * omega * wave
        state.position[0], state.velocity[0], state.acceleration[0] = q, v, a
