"""The compensation of one joint as closures of plain floats, specialised once for a model and its settings.

A closure keeps its constants in cells: reading one costs a fraction of an attribute, and a call no method lookup.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, inf, tanh
from typing import Protocol

from fricomp.control.curve import FrictionCurves
from fricomp.control.settings import CompensationSettings
from fricomp.control.term_torque import FALLING_SHARE_WITHOUT_VELOCITY, build_bristle, build_extra

__all__ = ["HotPath", "TorqueFunction", "build_hot_path"]


class TorqueFunction(Protocol):
    """Compensation torque of one joint."""

    def __call__(
        self,
        velocity_reference: float,
        velocity: float | None = None,
        position_error: float | None = None,
        load: float | None = None,
        position: float = 0.0,
        load_torque: float = 0.0,
        temperature: float | None = None,
    ) -> float:
        """Torque to add to the command; 0.0 for input that is not finite.

        Args:
            velocity_reference: [rad/s] or [m/s].
            velocity: Measured [rad/s] or [m/s]; None where it is not measured.
            position_error: Reference minus measured position [rad] or [m].
            load: Normal load, in the unit of the law's reference load.
            position: [rad] or [m]; used by terms over position.
            load_torque: Torque the joint transmits to its load; used by terms over load torque.
            temperature: [°C]; used by terms over temperature.
        """


@dataclass(frozen=True)
class HotPath:
    """A joint's closures.

    Attributes:
        torque: The compensation.
        reset: Forget state: bristle, rate limit. Not the counter.
        rejected: Number of inputs so far that were not finite.
        set_scale: Multiply dry and viscous friction, for online adaptation.
    """

    torque: TorqueFunction
    reset: Callable[[], None]
    rejected: Callable[[], int]
    set_scale: Callable[[float, float], None]


def build_hot_path(  # noqa: C901
    curves: FrictionCurves, settings: CompensationSettings, period: float
) -> HotPath:
    """Specialise the compensation for one joint; the equation is that of `CompensationSettings`.

    Args:
        curves: The law, taken apart.
        settings: How it is compensated.
        period: Control period [s].
    """
    bristle, reset_bristle = build_bristle(curves, period) if curves.bristle is not None else (None, _nothing)
    extra = build_extra(curves, settings) if curves.extra else None
    measured, share, keep = settings.source == "measured", settings.measured_share, 1.0 - settings.measured_share
    unseen = FALLING_SHARE_WITHOUT_VELOCITY if settings.source == "blend" else 1.0
    band, error_rate, error_band = settings.dead_band, settings.error_rate, settings.error_band
    rest, smoothing, gain, fade = settings.rest_velocity, settings.smoothing, settings.gain, 1.0 / settings.fade_width
    low, high = settings.velocity_range
    forward, reverse = (*curves.forward, high), (*curves.reverse, -low)
    low_load, high_load = settings.load_range or (-inf, inf)
    per_load = curves.load.load_sensitivity / curves.load.reference_load
    insensitive = 1.0 - curves.load.load_sensitivity
    authority, rate = settings.authority, settings.torque_rate * period
    dry_gain = viscous_gain = gain
    last, rejected = 0.0, 0

    # One long function on purpose: a call to an inner one would cost as much as a third of the whole.
    def torque(  # noqa: C901
        velocity_reference: float,
        velocity: float | None = None,
        position_error: float | None = None,
        load: float | None = None,
        position: float = 0.0,
        load_torque: float = 0.0,
        temperature: float | None = None,
    ) -> float:
        nonlocal last, rejected
        try:
            total = blended = drive = velocity_reference
            factor = 1.0
            if velocity is not None:
                total += velocity
                if measured:
                    drive = velocity - band if velocity > band else velocity + band if velocity < -band else 0.0
                blended = keep * drive + share * velocity
            direction = drive
            if position_error is not None:
                total += position_error
                if position_error > error_band:
                    direction += error_rate * (position_error - error_band)
                elif position_error < -error_band:
                    direction += error_rate * (position_error + error_band)
            if load is not None:
                total += load
                factor = insensitive + per_load * (
                    high_load if load > high_load else low_load if load < low_load else load
                )
                if factor < 0.0:
                    factor = 0.0
            if total - total != 0.0:  # infinite or NaN; what follows would turn either into a torque
                raise ValueError
            if direction >= 0.0:
                coulomb, rise, stribeck_velocity, exponent, viscous, edge = forward
            else:
                coulomb, rise, stribeck_velocity, exponent, viscous, edge = reverse
                blended = -blended
            if bristle is None:
                falling = exp(-((blended / stribeck_velocity) ** exponent)) if blended > 0.0 else 1.0
                if velocity is None:
                    falling *= unseen
                elif -rest < velocity < rest:
                    falling += (1.0 - falling) * (1.0 - abs(velocity) / rest)
                tau = factor * (coulomb + rise * falling) * tanh(direction / smoothing)
            else:
                tau = bristle(drive, factor)
            tau = dry_gain * tau + viscous_gain * viscous * drive
            if not -edge <= drive <= edge:
                left = 1.0 - (abs(drive) - edge) * fade
                tau = tau * left if left > 0.0 else 0.0
            if extra is not None:
                tau += extra(drive, position, load_torque, temperature)
            if not -authority <= tau <= authority:
                if tau != tau:
                    raise ValueError
                tau = authority if tau > 0.0 else -authority
            if not -rate <= tau - last <= rate:
                tau = last + rate if tau > last else last - rate
            last = tau
            return tau
        except (TypeError, ValueError, OverflowError):
            last = 0.0
            rejected += 1
            return 0.0

    def reset() -> None:
        nonlocal last
        last = 0.0
        reset_bristle()

    def set_scale(dry_scale: float, viscous_scale: float) -> None:
        nonlocal dry_gain, viscous_gain
        dry_gain, viscous_gain = gain * dry_scale, gain * viscous_scale

    return HotPath(torque, reset, lambda: rejected, set_scale)


def _nothing() -> None:
    """A static law has no state to reset."""
