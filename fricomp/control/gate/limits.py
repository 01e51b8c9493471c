"""What one joint may be asked to do, and may be seen doing."""

from collections.abc import Sequence
from dataclasses import dataclass

from fricomp.control.number import is_number
from fricomp.errors import ParameterError

__all__ = ["JointLimits"]


BREAKAWAY_SHARE = 0.45
"""Breakaway torque of a joint for which none is given, of its torque limit [1]: friction of gears stays below, and a
joint that does not move from no torque to all of it is found."""


@dataclass(frozen=True)
class JointLimits:
    """Limits of one joint, in the actuator's torque unit and joint-side SI.

    Attributes:
        torque: Largest commanded torque, either sign [N·m], [N] or [A].
        torque_rate: Fastest change of the commanded torque [N·m/s], [N/s] or [A/s].
        velocity: Speed beyond which the gate trips [rad/s] or [m/s].
        position: Range outside which the gate trips [rad] or [m]; None where the joint turns freely.
        temperature: Temperature above which the gate trips [°C]; None where it is not watched.
        breakaway: Largest torque with which friction may hold the joint. One that stands still while the torque
            changes by more than twice as much, whatever its load, trips the gate. 0.45 of `torque` if None.

    Raises:
        ParameterError: A limit is not finite, not positive, or a range is not ascending.
    """

    torque: float
    torque_rate: float
    velocity: float
    position: tuple[float, float] | None = None
    temperature: float | None = None
    breakaway: float | None = None

    @property
    def breakaway_torque(self) -> float:
        """The breakaway torque as it is given, or a share of the torque limit."""
        return BREAKAWAY_SHARE * self.torque if self.breakaway is None else self.breakaway

    def __post_init__(self) -> None:
        for name in ("torque", "torque_rate", "velocity"):
            value = getattr(self, name)
            if not (is_number(value) and value > 0.0):
                raise ParameterError(f"the {name} limit must be finite and positive, got {value!r}")
            object.__setattr__(self, name, float(value))
        if self.position is not None:
            object.__setattr__(self, "position", _get_range(self.position))
        if self.breakaway is not None:
            if not (is_number(self.breakaway) and self.breakaway > 0.0):
                raise ParameterError(f"the breakaway limit must be finite and positive or None, got {self.breakaway!r}")
            object.__setattr__(self, "breakaway", float(self.breakaway))
        if self.temperature is not None and not is_number(self.temperature):
            raise ParameterError(f"the temperature limit must be finite [°C] or None, got {self.temperature!r}")


def _get_range(limits: tuple[float, float]) -> tuple[float, float]:
    pair = limits if isinstance(limits, Sequence) and len(limits) == 2 and all(map(is_number, limits)) else (0.0, 0.0)
    if not pair[0] < pair[1]:
        raise ParameterError(f"the position limits must be two finite ascending numbers or None, got {limits!r}")
    return float(pair[0]), float(pair[1])
