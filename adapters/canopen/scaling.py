"""From the drive's own units to SI at the motor shaft, as the drive itself tells it [cia402]."""

from dataclasses import dataclass
from functools import cached_property
from math import inf, tau

from fricomp.errors import AdapterConfigurationError

from . import objects
from .objects import CanOpenObject
from .service import ServiceChannel

__all__ = ["DriveScaling", "read_scaling"]

# Object 60A9 in the SI notation of CiA 303-2: revolutions a minute, by the exponent of ten in the highest byte.
REVOLUTIONS_PER_MINUTE = 0x00B44700
REVOLUTION_MASK = 0x00FFFF00
MINUTE = 60.0

INT16 = 0x7FFF
WHOLE_RANGE = (-0x80000000, 0x7FFFFFFF)


@dataclass(frozen=True)
class DriveScaling:
    """What one count is.

    Attributes:
        position: [rad].
        velocity: [rad/s].
        torque: [N·m].
        highest_torque: Largest torque that the drive takes [N·m].
        highest_velocity: Largest speed of its motor [rad/s].
    """

    position: float
    velocity: float
    torque: float
    highest_torque: float
    highest_velocity: float

    @cached_property
    def highest_torque_count(self) -> int:
        """Largest torque [counts]."""
        return self.count_within(self.highest_torque)

    def count_within(self, torque: float) -> int:
        """A torque [N·m] in whole counts, rounded toward zero."""
        return int(torque / self.torque + 1e-9)


def read_scaling(
    service: ServiceChannel, counts_per_revolution: float | None, velocity_count: float | None
) -> DriveScaling:
    """Read rated torque, encoder, gear and units.

    Args:
        service: To the drive.
        counts_per_revolution: Position counts a motor turn, where the drive is not to be asked.
        velocity_count: One count of velocity at the motor [rad/s], where the drive is not to be asked.

    Raises:
        AdapterConfigurationError: The drive does not tell enough, or its position jumps within its turns.
    """
    _refuse_modulo(service)
    rated = service.read(objects.RATED_TORQUE) * 1e-3
    if rated <= 0.0:
        raise AdapterConfigurationError("the drive's rated torque (6076) is 0: set it on the drive")
    counts = counts_per_revolution or _read_counts(service)
    torque = rated * 1e-3
    most = service.read_if_present(objects.MAX_TORQUE)
    speed = service.read_if_present(objects.MAX_MOTOR_SPEED)
    return DriveScaling(
        position=tau / counts,
        velocity=velocity_count or _read_velocity_count(service, counts),
        torque=torque,
        highest_torque=torque * min(most or INT16, INT16),
        highest_velocity=speed * tau / MINUTE if speed else inf,
    )


def _refuse_modulo(service: ServiceChannel) -> None:
    """A position that begins again within a range of the drive's own (607B) would jump by it.

    Raises:
        AdapterConfigurationError: It does.
    """
    low = service.read_if_present(objects.LOWEST_POSITION)
    high = service.read_if_present(objects.HIGHEST_POSITION)
    if low is not None and high is not None and low < high and (low, high) != WHOLE_RANGE:
        raise AdapterConfigurationError(
            f"the drive's position begins again within {low} to {high} counts (607B), and would jump: set both to 0"
        )


def _read_counts(service: ServiceChannel) -> float:
    """Position counts a motor turn: from feed and gear (6092, 6091) where the drive has them, else from its encoder."""
    feed = _ratio(service, objects.FEED, objects.FEED_SHAFT_REVOLUTIONS)
    if feed is not None:
        gear = _ratio(service, objects.GEAR_MOTOR_REVOLUTIONS, objects.GEAR_SHAFT_REVOLUTIONS)
        return feed / (gear or 1.0)
    encoder = _ratio(service, objects.ENCODER_INCREMENTS, objects.ENCODER_REVOLUTIONS)
    if encoder is None:
        raise AdapterConfigurationError(
            "the drive tells neither encoder resolution (608F) nor feed (6092): give counts_per_revolution"
        )
    return encoder


def _ratio(service: ServiceChannel, numerator: CanOpenObject, denominator: CanOpenObject) -> float | None:
    above, below = service.read_if_present(numerator), service.read_if_present(denominator)
    return above / below if above and below else None


def _read_velocity_count(service: ServiceChannel, counts: float) -> float:
    unit = service.read_if_present(objects.VELOCITY_UNIT)
    if unit and unit & REVOLUTION_MASK == REVOLUTIONS_PER_MINUTE:
        exponent = (unit >> 24) - (256 if unit >> 31 else 0)
        return float(tau / MINUTE * 10.0**exponent)
    return tau / counts
