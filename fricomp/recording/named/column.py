"""What the name of a column says: which quantity, of which joint, in which unit."""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["RAW_UNIT", "ColumnMeaning", "name_joint", "read_column_name", "simplify_joint"]

_TOKEN = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")

_QUANTITIES = {
    "position": ("q", "pos", "position", "positions", "angle", "angles", "theta", "qpos"),
    "velocity": ("dq", "qd", "qdot", "vel", "velocity", "velocities", "speed", "omega", "qvel"),
    "acceleration": ("ddq", "qdd", "qddot", "acc", "acceleration", "accelerations", "qacc"),
    "torque": ("tau", "torque", "torques", "effort", "efforts", "moment", "trq", "tq", "force"),
    "current": ("current", "currents", "amps"),
    "temperature": ("temp", "temperature", "temperatures"),
}
"""Words for a quantity, in small letters. Single letters but q are left out: they are as often a joint's name."""

_WORDS = {word: quantity for quantity, words in _QUANTITIES.items() for word in words}

_WANTED: tuple[str, ...] = (
    "cmd",
    "command",
    "commands",
    "commanded",
    "cmptd",
    "ref",
    "reference",
    "des",
    "desired",
    "target",
    "goal",
)
_WANTED += ("setpoint",)
_MEASURED = {"measured": 2, "meas": 2, "actual": 2, "act": 2, "msr": 2, "feedback": 1, "fb": 1, "state": 1, "states": 1}
_MEASURED |= {"j": 0}
"""Words of columns that were measured, and how surely they say it: the feedback of a controller is a part of a command
as well. `tau_J` is a Franka's."""

_MOTOR = ("motor", "rotor")

_REFERENCES = {"position": "position_reference", "velocity": "velocity_reference", "torque": "torque_command"}

_UNIT = re.compile(
    r"(?<![A-Za-z])((?i:deg/s|degps|dps|deg|degrees|rad/s|mrad|rad|rpm|turns/s|turns|rev|mnm|nm|n·m|ma|mm/s|mm|degc|kn)"
    r"|A(?!\d)|m(?!\d)|N|°C|C(?!\d))(?![A-Za-z])"
)
_UNITS = {
    "position": {
        "deg": "deg",
        "degrees": "deg",
        "mrad": "mrad",
        "m": "m",
        "mm": "mm",
        "turns": "turns",
        "rev": "turns",
    },
    "velocity": {
        "deg": "deg/s",
        "deg/s": "deg/s",
        "degps": "deg/s",
        "dps": "deg/s",
        "rpm": "rpm",
        "turns/s": "turns/s",
        "mm": "mm/s",
        "mm/s": "mm/s",
    },
    "acceleration": {"deg": "deg/s^2", "mm": "mm/s^2"},
    "torque": {"mnm": "mNm", "A": "A", "ma": "mA", "N": "N", "kn": "kN"},
    "current": {"ma": "mA"},
}
"""Unit that a word means for a quantity, longer words in small letters; where none is given it means that of SI."""

_RAW = ("count", "counts", "tick", "ticks", "raw", "lsb", "increments", "pulses", "codes", "steps", "encoder")
"""Words of columns in units of a device, which no name says the size of."""
RAW_UNIT = "counts"


@dataclass(frozen=True)
class ColumnMeaning:
    """What a column holds.

    Attributes:
        channel: Channel of a recording.
        joint: What is left of the name: the joint's own, or a number.
        certainty: How surely the name says that it was measured, from 0.
        unit: Name of its unit; empty where it is that of SI, or not said; `RAW_UNIT` where it is that of a device.
    """

    channel: str
    joint: str
    certainty: int
    unit: str


def read_column_name(name: str) -> ColumnMeaning | None:
    """Say what a column holds by its name; None where no word of it is a quantity.

    `q_3`, `Position3`, `actual_q_2`, `tau_J:4`, `shoulder.effort`, `/joint_states/elbow/velocity`, `q_cmd[deg]:1`.
    """
    words = [(match.group().lower(), match.span()) for match in _TOKEN.finditer(name)]
    known = [k for k, (word, _) in enumerate(words) if word in _WORDS]
    if not known:
        return None
    at = known[-1]
    quantity, start = _WORDS[words[at][0]], words[at][1][0]
    said = [match for match in _UNIT.finditer(name) if match.start() > start]
    dropped, certainty = [words[at][1], *(match.span() for match in said)], 0
    is_wanted = is_motor = is_raw = False
    for k, (word, span) in enumerate(words):
        if word in _WANTED or (word == "d" and k > at):
            is_wanted = True
        elif word in _MEASURED:
            certainty = max(certainty, _MEASURED[word])
        elif word in _MOTOR and quantity == "position":
            is_motor = True
        elif word in _RAW and not said:
            is_raw, certainty = True, -1
        else:
            continue
        dropped.append(span)
    if is_wanted and quantity not in _REFERENCES:
        return None
    channel = _REFERENCES[quantity] if is_wanted else "motor_position" if is_motor else quantity
    unit = RAW_UNIT if is_raw else _find_unit(quantity, said[0].group()) if said else ""
    return ColumnMeaning(channel, _cut_out(name, sorted(dropped)), certainty, unit)


def _find_unit(quantity: str, word: str) -> str:
    known = _UNITS.get(quantity, {})
    return known.get(word if len(word) == 1 else word.lower(), "")


def _cut_out(name: str, spans: list[tuple[int, int]]) -> str:
    """What is left of a name, its last part where it is a path, with one underscore for all marks between words."""
    for start, end in reversed(spans):
        name = f"{name[:start]}\0{name[end:]}"
    parts = [part for part in re.split(r"[/\0]", name) if re.search(r"\w", part.strip("_"))]
    tail = "_".join(parts[-1:] if "/" in name else parts)
    return re.sub(r"[^0-9A-Za-z]+", "_", tail).strip("_")


def simplify_joint(name: str) -> str:
    """The words of a joint's name that tell it from others, so that `joint_1`, `J1` and `1` are the same."""
    words = [match.group().lower() for match in _TOKEN.finditer(name)]
    kept = [word for word in words if word not in ("joint", "joints", "j", "jnt", "axis")]
    return "_".join(str(int(word)) if word.isdigit() else word for word in kept)


def name_joint(left: str) -> str:
    """Name of a joint: what a column calls it, or `joint_3` where that is a number."""
    return f"joint_{int(left)}" if left.isdigit() else left
