"""Goals in a servo's counts: of a command, of a torque limit, and those of a stop."""

from collections.abc import Sequence
from math import ceil

from fricomp.errors import AdapterConfigurationError, AdapterValueError
from fricomp.joint import CommandMode, JointCommand

from ..transmission import SCALED_UNITS
from .control_table import GOAL_CURRENT, GOALS, LARGEST_POSITION, POSITION_COUNT, TORQUE_ENABLE, VELOCITY_COUNT
from .packet import SyncWriter, sync_write_packet
from .report import REPORT_SIZE, STATUS_BYTES

__all__ = ["GoalWriter", "compute_current_bound", "encode_goals", "stop_packets"]

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


class GoalWriter:
    """The packet of each mode that takes the goals of all servos, in their counts and within their own limits.

    Args:
        servos: Their identifiers.

    Attributes:
        torque_counts: Torque [N·m], or current [A], of one count of current of each servo.
        current_limits: Of each servo [counts]; like the others filled in once the servos were asked.
        velocity_limits: Of each servo [counts].
    """

    def __init__(self, servos: bytes) -> None:
        n_servos = len(servos)
        self.torque_counts = [1.0] * n_servos
        self.current_limits, self.velocity_limits = [0] * n_servos, [0] * n_servos
        domains: dict[CommandMode, tuple[Sequence[float], Sequence[int]]] = {
            "torque": (self.torque_counts, self.current_limits),
            "velocity": ([VELOCITY_COUNT] * n_servos, self.velocity_limits),
            "position": ([POSITION_COUNT] * n_servos, [LARGEST_POSITION] * n_servos),
        }
        self._modes = {mode: (SyncWriter(*GOALS[mode], servos), *domain) for mode, domain in domains.items()}

    def encode(self, command: JointCommand, mode: CommandMode) -> bytes:
        """The packet of a command, each goal cut to its limit.

        Raises:
            AdapterValueError: A value is not finite.
        """
        writer, counts, bounds = self._modes[mode]
        return writer.encode(encode_goals(getattr(command, mode), counts, bounds))


def stop_packets(servos: bytes) -> bytes:
    """Zero current and torque off, as often as it takes for two of them to come after everything else.

    The rest of a packet that was cut by discarding it would swallow the first; and servos that are answering destroy
    what comes, until the last of them has done so.
    """
    idle = sync_write_packet(GOAL_CURRENT.address, dict.fromkeys(servos, bytes(2)))
    off = sync_write_packet(TORQUE_ENABLE.address, dict.fromkeys(servos, b"\0"))
    longest_answers = len(servos) * (REPORT_SIZE + STATUS_BYTES)
    return (idle + off) * (2 + ceil(longest_answers / len(idle + off)))
