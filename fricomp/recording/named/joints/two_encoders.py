"""A motor and its link, told apart by a last letter or word: `theta_m` by `theta_l`, `q_motor` by `q_link`."""

import re
from collections.abc import Mapping
from dataclasses import replace

from ..column import ColumnMeaning

_SIDE = re.compile(
    r"(?P<base>.+?)_?(?:(?P<motor>m|mot|motor|rotor)|(?P<link>l|link|load|j|joint|out|output))(?=$|\s|\[|\()",
    re.IGNORECASE,
)
"""What is said of which side of the gear."""


def pair_encoders(known: Mapping[str, ColumnMeaning]) -> dict[str, ColumnMeaning]:
    """The columns of a log with two positions, that of a motor and that of its link; any other log as it is.

    The velocity is the link's. Of two torques the motor's is the torque, and the link's what it transmits to the load.
    """
    motors = dict[str, tuple[str, str]]()
    links = dict[str, tuple[str, str]]()
    for name, meaning in known.items():
        side = _SIDE.match(name)
        if side is not None:
            one = motors if side["motor"] else links
            one[name] = (meaning.channel.removeprefix("motor_").removeprefix("load_"), side["base"])
    positions = [name for name, meaning in known.items() if meaning.channel in ("position", "motor_position")]
    pair = [one.get(name) for one in (motors, links) for name in positions if name in one]
    if len(positions) != 2 or len(pair) != 2 or pair[0] != pair[1]:
        return dict(known)
    paired = dict(known)
    for name, (channel, _) in motors.items():
        paired[name] = replace(known[name], channel=f"motor_{channel}" if channel == "position" else channel, joint="")
        if channel in ("velocity", "acceleration"):
            del paired[name]
        elif known[name].unit == "m":  # beside q_l, q_m is the motor's angle and no length in metres
            paired[name] = replace(paired[name], unit="")
    both = {channel for channel, _ in motors.values()} & {channel for channel, _ in links.values()}
    for name, (channel, _) in links.items():
        transmits = channel == "torque" and channel in both
        paired[name] = replace(known[name], channel="load_torque" if transmits else channel, joint="")
    return paired
