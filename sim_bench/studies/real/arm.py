"""Kinematics of arms in the public sets, as MJCF: bodies and axes only, for what their links weigh is identified."""

from collections.abc import Sequence
from math import cos, pi, sin
from typing import NamedTuple


class Link(NamedTuple):
    """One row of a table of Denavit and Hartenberg: offset d [m], length a [m], twist alpha [rad]."""

    offset: float
    length: float
    twist: float


ARMS = {
    # Universal Robots, "DH parameters for calculations of kinematics and dynamics", UR10e.
    "ur10e": (
        Link(0.1807, 0.0, pi / 2),
        Link(0.0, -0.6127, 0.0),
        Link(0.0, -0.57155, 0.0),
        Link(0.17415, 0.0, pi / 2),
        Link(0.11985, 0.0, -pi / 2),
        Link(0.11655, 0.0, 0.0),
    ),
}


def arm_xml(name: str, links: Sequence[Link]) -> str:
    """MJCF of a chain with joints joint_1, joint_2, ...; each body weighs 1 kg, which stands for nothing."""
    lines = [f'<mujoco model="{name}"><compiler angle="radian"/><worldbody>']
    before = Link(0.0, 0.0, 0.0)
    for i, link in enumerate(links, 1):
        place = f'pos="{before.length} 0 {before.offset}" quat="{cos(before.twist / 2)} {sin(before.twist / 2)} 0 0"'
        lines.append(f'<body name="link_{i}" {place}><joint name="joint_{i}" axis="0 0 1"/>')
        lines.append('<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>')
        before = link
    return "\n".join([*lines, "</body>" * len(links), "</worldbody></mujoco>"]) + "\n"
