"""What no effect of the catalogue describes."""

from functools import partial

from . import law
from .effect import Effect, built_of, written
from .joint import LINK, JointParts


def _hung(joint: str, mass: float, below: float = 0.0) -> JointParts:
    """A mass [kg] that moves against the end of the link."""
    inertial = f'<inertial pos="0 0 -{below}" mass="{mass}" diaginertia="1e-4 1e-4 1e-4"/>'
    return JointParts(link=f'{LINK}<body name="loose" pos="0 0 -0.4"><joint name="loose" {joint}/>{inertial}</body>')


_outside = partial(Effect, "outside")

OUTSIDE = (
    _outside(
        "memory_spring",
        "`qfrc_applied` of a spring of 2 N·m/rad whose centre follows the joint within 3 s",
        written(lambda: law.MemorySpring(2.0, 3.0)),
    ),
    _outside(
        "eddy_brake",
        "`qfrc_applied` against the motion, strongest (0.6 N·m) at 0.8 rad/s",
        written(lambda: law.eddy_brake(0.6, 0.8)),
    ),
    _outside(
        "starvation",
        "`dof_frictionloss` begins 30 % higher and runs in within 20 s",
        written(lambda: law.starvation(0.3, 20.0)),
    ),
    _outside(
        "swinging_load",
        "a pendulum of 0.4 kg and 0.1 m hangs on the end of the link: a hinge of its own, `damping` 0.01",
        built_of(_hung('type="hinge" axis="0 1 0" damping="0.01"', 0.4, 0.1)),
        right=("payload_error", "inertia_error"),
    ),
    _outside(
        "loose_mass",
        "0.4 kg slide across the end of the link, 0.1 m from stop to stop, `damping` 1",
        built_of(_hung('type="slide" axis="1 0 0" range="-0.05 0.05" limited="true" damping="1"', 0.4)),
        right=("payload_error", "inertia_error"),
    ),
)
