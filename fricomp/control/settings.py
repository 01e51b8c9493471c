"""How a compensator works, and the loop it works in."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from fricomp.control.number import LARGEST_NUMBER, is_number
from fricomp.errors import ParameterError

Source = Literal["reference", "blend", "measured"]


@dataclass(frozen=True)
class LoopDynamics:
    """The position loop that a compensation works in: u = stiffness (q_r - q) + damping (v_r - v).

    Attributes:
        inertia: J [kg·m²] or [kg].
        stiffness: Proportional gain [N·m/rad] or [N/m].
        damping: Derivative gain [N·m·s/rad] or [N·s/m].
        delay: From the joint's motion to the torque that answers it, without the velocity's filter [s].
        velocity_filter: Time constant of the low pass on the measured velocity [s].

    Raises:
        ParameterError: A value is not finite, negative, or the inertia is zero.
    """

    inertia: float
    stiffness: float
    damping: float
    delay: float = 0.0
    velocity_filter: float = 0.0

    def __post_init__(self) -> None:
        for name in ("inertia", "stiffness", "damping", "delay", "velocity_filter"):
            value = getattr(self, name)
            if not is_number(value, 0.0):
                raise ParameterError(f"{name} of the loop must be finite and not negative, got {value!r}")
        if self.inertia == 0.0:
            raise ParameterError("the inertia of the loop must be positive")


@dataclass(frozen=True)
class DriveLimits:
    """What a drive, or the safety gate in front of it, lets through.

    Attributes:
        torque: Largest torque, either sign [N·m] or [N].
        torque_rate: Fastest change of it [N·m/s] or [N/s].

    Raises:
        ParameterError: A limit is not positive.
    """

    torque: float = math.inf
    torque_rate: float = math.inf

    def __post_init__(self) -> None:
        for name in ("torque", "torque_rate"):
            value = getattr(self, name)
            if not (is_number(value, 0.0, math.inf) and value > 0.0):
                raise ParameterError(f"the drive's limit of {name} must be positive, got {value!r}")


NO_LIMITS = DriveLimits()
"""A drive that gives every torque at once."""


@dataclass(frozen=True)
class CompensationSettings:
    """How a static compensation is formed; see `choose_settings` for values that fit a model.

    With x = v_r, or the measured velocity beyond its dead band where that is the source,

    tau = gain (tanh((x + k e)/smoothing) dry(s) + viscous x),  s = max(0, sgn(x) ((1-w) v_r + w v_measured))

    Terms over load, position and temperature that resist like dry friction are part of dry, which they never turn below
    zero, and so is what rests have brought; those that drag go with the viscous term, and what holds a position or
    follows the acceleration is added with the gain alone.

    Attributes:
        source: What decides the direction. `blend` takes the direction from the reference and the speed on the
            curve from the measurement, which follows a falling branch as it is met.
        measured_share: w; 0 for `reference`, 1 for `measured` [1].
        smoothing: Velocity over which the direction changes [rad/s] or [m/s].
        dead_band: Measured velocity that counts as rest; `measured` only [rad/s] or [m/s].
        gain: Share of the modelled friction that is compensated [1].
        authority: Largest compensation, in the model's torque unit.
        torque_rate: Fastest change of the compensation, per second; input that is rejected gives zero at once.
        rest_velocity: Below it a measured joint counts as resting and gets the breakaway torque; 0 for no assistance.
        error_rate: k: direction that a position error gives to a resting reference; 0 for none [1/s].
        error_band: Position error that gives none [rad] or [m].
        velocity_range: Range of validity; outside it the compensation fades [rad/s] or [m/s].
        fade_width: Width over which it fades to zero [rad/s] or [m/s].
        normal_load_range: Normal loads beyond it count as its ends; None for no bound.
        load_torque_range: The same for the torque that the joint transmits to its load.
        temperature_range: The same for the temperature [°C].
        acceleration_range: The same for the acceleration of the reference [rad/s²] or [m/s²].
        notes: Why it is so, in sentences.

    Raises:
        ParameterError: A value is outside its domain.
    """

    source: Source
    measured_share: float
    smoothing: float
    gain: float
    authority: float
    velocity_range: tuple[float, float]
    fade_width: float
    dead_band: float = 0.0
    torque_rate: float = math.inf
    rest_velocity: float = 0.0
    error_rate: float = 0.0
    error_band: float = 0.0
    normal_load_range: tuple[float, float] | None = None
    load_torque_range: tuple[float, float] | None = None
    temperature_range: tuple[float, float] | None = None
    acceleration_range: tuple[float, float] | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.source not in ("reference", "blend", "measured"):
            raise ParameterError(f"source must be 'reference', 'blend' or 'measured', got {self.source!r}")
        for name in ("smoothing", "authority", "fade_width", "torque_rate"):
            highest = LARGEST_NUMBER if name in ("smoothing", "authority") else math.inf
            if not (is_number(getattr(self, name), 0.0, highest) and getattr(self, name) > 0.0):
                finite = "" if highest == math.inf else "finite and "
                raise ParameterError(f"{name} must be {finite}positive, got {getattr(self, name)!r}")
        for name in ("dead_band", "rest_velocity", "error_rate", "error_band"):
            if not is_number(getattr(self, name), 0.0):
                raise ParameterError(f"{name} must be finite and not negative, got {getattr(self, name)!r}")
        if not is_number(self.measured_share, 0.0, 1.0):
            raise ParameterError(f"measured_share must lie from 0 to 1, got {self.measured_share!r}")
        if not is_number(self.gain, 0.0, 2.0):
            raise ParameterError(f"gain must lie from 0 to 2 (below 1 to under-compensate), got {self.gain!r}")
        self._require_ranges()

    def _require_ranges(self) -> None:
        for name in ("velocity", "normal_load", "load_torque", "temperature", "acceleration"):
            bounds = getattr(self, f"{name}_range")
            if bounds is not None and not _is_ordered(bounds):
                raise ParameterError(f"{name}_range must be (lowest, highest), got {bounds!r}")


def _is_ordered(bounds: object) -> bool:
    """Whether these are two numbers, the lower one first; NaN is not ordered."""
    if not (isinstance(bounds, Sequence) and len(bounds) == 2):
        return False
    return all(is_number(bound, -math.inf, math.inf) for bound in bounds) and bool(bounds[0] <= bounds[1])
