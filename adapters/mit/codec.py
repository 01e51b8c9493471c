"""The MIT frame: q16 dq12 kp12 kd12 tau12, big-endian, each linear over a range [katz2018].

All codes run over a symmetric range, -limit at 0 and +limit at the highest code, so that 0 falls between two codes: a
commanded zero is half a `torque_quantum` off. Codes are rounded; cutting off would bias every torque the same way.
"""

from dataclasses import dataclass
from math import isfinite

from fricomp.errors import AdapterConfigurationError, AdapterValueError

__all__ = ["MitCodec", "MitRanges", "saturate", "to_code"]

CODES_16 = (1 << 16) - 1
CODES_12 = (1 << 12) - 1


@dataclass(frozen=True)
class MitRanges:
    """Ranges that the codes of one motor model span, from minus to plus each; the gains from zero.

    Attributes:
        position: [rad].
        velocity: [rad/s].
        torque: [N·m].
        kp: Stiffness [N·m/rad].
        kd: Damping [N·m·s/rad].

    Raises:
        AdapterConfigurationError: A range is not finite and positive.
    """

    position: float
    velocity: float
    torque: float
    kp: float = 500.0
    kd: float = 5.0

    def __post_init__(self) -> None:
        for name in ("position", "velocity", "torque", "kp", "kd"):
            value = getattr(self, name)
            if not (isfinite(value) and value > 0.0):
                raise AdapterConfigurationError(f"the {name} range must be finite and positive, got {value!r}")


def to_code(value: float, low: float, high: float, codes: int) -> int:
    """The nearest code; what is beyond the range gets the code at its edge.

    Raises:
        AdapterValueError: `value` is not finite.
    """
    if not isfinite(value):
        raise AdapterValueError(f"{value} cannot be sent to a motor")
    return round((min(max(value, low), high) - low) / (high - low) * codes)


def saturate(value: float, limit: float) -> float:
    """The edge of the range that a value is beyond.

    Raises:
        AdapterValueError: It is not finite.
    """
    if not isfinite(value):
        raise AdapterValueError(f"{value} cannot be sent to a motor")
    return min(max(value, -limit), limit)


class MitCodec:
    """Encodes commands and decodes states of one motor.

    Args:
        ranges: Of its model.
    """

    def __init__(self, ranges: MitRanges) -> None:
        self.ranges = ranges
        self.position_quantum = 2.0 * ranges.position / CODES_16
        self.velocity_quantum = 2.0 * ranges.velocity / CODES_12
        self.torque_quantum = 2.0 * ranges.torque / CODES_12
        # Only torque varies in torque mode; with both gains zero the references have no effect.
        self._idle_prefix = self.encode(0.0, 0.0, 0.0, 0.0, 0.0)[:6]

    def encode(self, position: float, velocity: float, kp: float, kd: float, torque: float) -> bytes:
        """A command [rad], [rad/s], [N·m/rad], [N·m·s/rad], [N·m]; values beyond a range saturate.

        Raises:
            AdapterValueError: A value is not finite.
        """
        r = self.ranges
        q = to_code(position, -r.position, r.position, CODES_16)
        dq = to_code(velocity, -r.velocity, r.velocity, CODES_12)
        stiffness = to_code(kp, 0.0, r.kp, CODES_12)
        damping = to_code(kd, 0.0, r.kd, CODES_12)
        tau = to_code(torque, -r.torque, r.torque, CODES_12)
        packed = q << 48 | dq << 36 | stiffness << 24 | damping << 12 | tau
        return packed.to_bytes(8, "big")

    def encode_torque(self, torque: float) -> bytes:
        """A command of torque alone [N·m].

        Raises:
            AdapterValueError: It is not finite.
        """
        limit = self.ranges.torque
        if not -limit <= torque <= limit:
            torque = saturate(torque, limit)
        code = round((torque + limit) / self.torque_quantum)
        return self._idle_prefix + code.to_bytes(2, "big")

    def decode(self, data: bytes) -> tuple[float, float, float]:
        """Position [rad], velocity [rad/s] and torque [N·m] of the five bytes q16 dq12 tau12."""
        packed, ranges = int.from_bytes(data, "big"), self.ranges
        return (
            (packed >> 24) * self.position_quantum - ranges.position,
            (packed >> 12 & 0xFFF) * self.velocity_quantum - ranges.velocity,
            (packed & 0xFFF) * self.torque_quantum - ranges.torque,
        )
