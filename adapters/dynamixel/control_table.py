"""The control table of the X series, and its models as data."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from math import tau
from typing import NamedTuple

import msgspec

from fricomp.joint import CommandMode

__all__ = ["GOALS", "MODES", "Item", "Model", "models"]


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
OPERATING_MODE = Item(11, 1)
CURRENT_LIMIT = Item(38, 2)
TORQUE_ENABLE = Item(64, 1)
STATUS_RETURN_LEVEL = Item(68, 1)
HARDWARE_ERROR = Item(70, 1)
BUS_WATCHDOG = Item(98, 1)  # 20 ms a count; 255 once it has fired
GOAL_CURRENT, GOAL_VELOCITY, GOAL_POSITION = Item(102, 2), Item(104, 4), Item(116, 4)

# Present current, velocity and position in one piece: what every cycle asks for.
STATE = Item(126, 10)
# Torque enable (64) to hardware error (70), and voltage with temperature: slower, and told apart by their length.
CONDITION = Item(64, 7)
WARMTH = Item(144, 3)

MODES: Mapping[CommandMode, int] = {"torque": 0, "velocity": 1, "position": 4}
GOALS: Mapping[CommandMode, Item] = {"torque": GOAL_CURRENT, "velocity": GOAL_VELOCITY, "position": GOAL_POSITION}

VELOCITY_COUNT = 0.229 * tau / 60.0  # [rad/s]
POSITION_COUNT = tau / 4096.0  # [rad]
WATCHDOG_COUNT = 0.02  # [s]


class Model(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A model of servo.

    Attributes:
        name: As the vendor calls it.
        current_count: Unit of its currents [A]; none where it cannot control current.
    """

    name: str
    current_count: float | None = None


class _ModelFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    source: str
    models: dict[str, Model]


@cache
def models() -> Mapping[int, Model]:
    """All models, by the number that a servo tells."""
    content = tomllib.loads((files(__package__) / "models.toml").read_text("utf-8"))
    return {int(number): model for number, model in msgspec.convert(content, _ModelFile).models.items()}
