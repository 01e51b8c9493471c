"""Goals in a servo's counts: of a command, of a torque limit, and those of a stop."""

from collections.abc import Sequence
from math import ceil

from fricomp.errors import AdapterConfigurationError, AdapterValueError

from ..transmission import SCALED_UNITS
from .control_table import GOAL_CURRENT, TORQUE_ENABLE
from .packet import sync_write_packet
from .report import REPORT_SIZE, STATUS_BYTES

__all__ = ["compute_current_bound", "encode_goals", "stop_packets"]

# A limit that is a whole number of counts in decimals must not lose one to its binary fraction.
ROUNDING = 1e-9


def compute_current_bound(limit: float, unit: str, gear_ratio: float, count: float) -> int:
    """The most counts of current within a torque limit, rounded towards zero.

    Args:
        limit: Of the joint, in `unit`.
        unit: Of the drive's torque; ampere passes a gear unscaled.
        gear_ratio: Drive turns for one joint turn [1].
        count: Drive torque for one count of current, in `unit`.

    Raises:
        AdapterConfigurationError: The limit is less than one count.
    """
    step = count * (gear_ratio if unit in SCALED_UNITS else 1.0)
    bound = int(limit / step * (1.0 + ROUNDING))
    if bound < 1:
        raise AdapterConfigurationError(f"a torque limit of {limit:g} {unit} is less than the servo's step of {step:g}")
    return bound


def encode_goals(values: Sequence[float], counts: Sequence[float], bounds: Sequence[int]) -> list[int]:
    """Values in the nearest whole numbers of their counts, none beyond its bound.

    A servo drops a goal beyond its own limit without a word, and goes on with the one before.

    Raises:
        AdapterValueError: A value is not finite.
    """
    try:
        goals = [round(value / count) for value, count in zip(values, counts, strict=True)]
    except (ValueError, OverflowError) as error:
        raise AdapterValueError(f"{list(values)} cannot be sent to servos: {error}") from error
    return [min(max(goal, -bound), bound) for goal, bound in zip(goals, bounds, strict=True)]


def stop_packets(servos: bytes) -> bytes:
    """Zero current and torque off, as often as it takes for two of them to come after everything else.

    The rest of a packet that was cut by discarding it would swallow the first; and servos that are answering destroy
    what comes, until the last of them has done so.
    """
    idle = sync_write_packet(GOAL_CURRENT.address, dict.fromkeys(servos, bytes(2)))
    off = sync_write_packet(TORQUE_ENABLE.address, dict.fromkeys(servos, b"\0"))
    longest_answers = len(servos) * (REPORT_SIZE + STATUS_BYTES)
    return (idle + off) * (2 + ceil(longest_answers / len(idle + off)))
