"""The control table of the X series, and its models as data."""

import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from math import tau
from typing import NamedTuple

import msgspec

from fricomp.joint import CommandMode

__all__ = ["GOALS", "MODES", "UNWANTED", "Item", "Model", "models"]


class Item(NamedTuple):
    """One item of the table.

    Attributes:
        address: Where it is.
        size: [byte].
    """

    address: int
    size: int


MODEL_NUMBER = Item(0, 2)
RETURN_DELAY = Item(9, 1)  # 2 µs a count
DRIVE_MODE = Item(10, 1)
OPERATING_MODE = Item(11, 1)
CURRENT_LIMIT, VELOCITY_LIMIT = Item(38, 2), Item(44, 4)
# Up to the shutdown mask: a read across the gap before 60, which older firmware has not got, is answered.
STARTUP = Item(52, 12)
TORQUE_ENABLE = Item(64, 1)
STATUS_RETURN_LEVEL = Item(68, 1)
HARDWARE_ERROR = Item(70, 1)
BUS_WATCHDOG = Item(98, 1)  # 20 ms a count; 255 once it has fired
GOAL_CURRENT, GOAL_VELOCITY, GOAL_POSITION = Item(102, 2), Item(104, 4), Item(116, 4)

PRESENT_POSITION = Item(132, 4)
# Present current, velocity and position in one piece.
STATE = Item(126, 10)
# From torque enable to bus watchdog: first and last byte tell whether a servo is energised and guarded.
CONDITION = Item(64, 35)

# Position is mode 5, current-based: the loops of velocity (1) and extended position (4) end in a voltage, and neither
# goal current nor current limit bounds them.
MODES: Mapping[CommandMode, int] = {"torque": 0, "velocity": 1, "position": 5}
GOALS: Mapping[CommandMode, Item] = {"torque": GOAL_CURRENT, "velocity": GOAL_VELOCITY, "position": GOAL_POSITION}

# What a servo may not be set to: item, place in it, bit, and what it would do.
UNWANTED: Sequence[tuple[Item, int, int, str]] = (
    (DRIVE_MODE, 0, 0x08, "switches its torque on by itself when a goal comes: clear bit 3 of its drive mode (10)"),
    (DRIVE_MODE, 0, 0x02, "follows another servo and takes no goals: clear bit 1 of its drive mode (10)"),
    (STARTUP, 8, 0x01, "switches its torque on with its power: clear bit 0 of its startup configuration (60)"),
)

VELOCITY_COUNT = 0.229 * tau / 60.0  # [rad/s]
POSITION_COUNT = tau / 4096.0  # [rad]
WATCHDOG_COUNT = 0.02  # [s]
LARGEST_POSITION = 1_048_575  # goal of current-based position, 256 turns either way [counts]


class Model(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A model of servo.

    Attributes:
        name: As the vendor calls it.
        current_count: Unit of its currents [A]; none where it cannot control current.
        indirect_data: Address of its first indirect datum; the indirect addresses begin at 168 everywhere.
    """

    name: str
    current_count: float | None = None
    indirect_data: int = 224


class _ModelFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    source: str
    models: dict[str, Model]


@cache
def models() -> Mapping[int, Model]:
    """All models, by the number that a servo tells."""
    content = tomllib.loads((files(__package__) / "models.toml").read_text("utf-8"))
    return {int(number): model for number, model in msgspec.convert(content, _ModelFile).models.items()}
