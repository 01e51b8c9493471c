"""The compensation of one joint as closures of plain floats, specialised once for a model and its settings.

A closure keeps its constants in cells: reading one costs a fraction of an attribute, and a call no method lookup.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, inf, nan, tanh
from typing import Protocol

from fricomp.control.bristle import FALLING_SHARE_WITHOUT_VELOCITY, build_bristle
from fricomp.control.curve import FrictionCurves
from fricomp.control.extra_terms import INPUT_TERMS, build_extra
from fricomp.control.lag import build_lag
from fricomp.control.settings import CompensationSettings

__all__ = ["HotPath", "TorqueFunction", "build_hot_path"]


class TorqueFunction(Protocol):
    """Compensation torque of one joint."""

    def __call__(
        self,
        velocity_reference: float,
        velocity: float | None = None,
        position_error: float | None = None,
        normal_load: float | None = None,
        position: float | None = None,
        load_torque: float | None = None,
        temperature: float | None = None,
        acceleration: float | None = None,
    ) -> float:
        """Torque to add to the command; 0.0 for input that is no finite number, or has no finite torque.

        So does a position, load torque or acceleration that the model depends on and that is not given. The 0.0 comes
        at once, whatever the rate of the settings.

        Args:
            velocity_reference: [rad/s] or [m/s].
            velocity: Measured [rad/s] or [m/s]; None where it is not measured.
            position_error: Reference minus measured position [rad] or [m].
            normal_load: Normal load, in the unit of the law's reference load.
            position: [rad] or [m]; used by terms over position.
            load_torque: Torque the joint transmits to its load; used by terms over load torque.
            temperature: [°C]; used by terms over temperature.
            acceleration: Of the reference [rad/s²] or [m/s²]; used by terms over acceleration.
        """


@dataclass(frozen=True)
class HotPath:
    """A joint's closures.

    Attributes:
        torque: The compensation.
        reset: Forget state: bristle, lag, rests, rate limit. Not the counter.
        rejected: Number of inputs so far that were no finite number, or had no finite torque.
        rejection: Why the last of them was.
        set_scale: Multiply dry and viscous friction, for online adaptation.
    """

    torque: TorqueFunction
    reset: Callable[[], None]
    rejected: Callable[[], int]
    rejection: Callable[[], str]
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
    bristle, reset_bristle = (
        build_bristle(curves, period, settings.smoothing) if curves.bristle is not None else (None, _nothing)
    )
    extra, reset_extra = build_extra(curves.extra, settings, period) if curves.extra else (None, _nothing)
    lagging, reset_lag = (
        build_lag(curves.lag, period, settings.velocity_range) if curves.lag > 0.0 else (None, _nothing)
    )
    square = curves.forward.exponent == curves.reverse.exponent == 2.0
    measured, share, keep = settings.source == "measured", settings.measured_share, 1.0 - settings.measured_share
    unseen = FALLING_SHARE_WITHOUT_VELOCITY if settings.source == "blend" else 1.0
    smoothing, gain, fade = settings.smoothing, settings.gain, 1.0 / settings.fade_width
    forward, reverse = tuple(curves.forward), tuple(curves.reverse)
    mean_viscous = 0.5 * (curves.forward.viscous + curves.reverse.viscous)
    half_viscous = 0.5 * (curves.forward.viscous - curves.reverse.viscous)
    per_load = curves.load.load_sensitivity / curves.load.reference_load
    insensitive = 1.0 - curves.load.load_sensitivity
    error_rate = settings.error_rate
    # Both ends of every range, because a sign costs as much as a comparison.
    low, high = settings.velocity_range
    low_load, high_load = settings.normal_load_range or (-inf, inf)
    if per_load > 0.0:  # below this load dry friction would drive
        low_load = max(low_load, -insensitive / per_load)
    low_band, high_band = -settings.dead_band, settings.dead_band
    low_error, high_error = -settings.error_band, settings.error_band
    low_rest, high_rest = -settings.rest_velocity, settings.rest_velocity
    lowest, highest = -settings.authority, settings.authority
    fall, climb = -settings.torque_rate * period, settings.torque_rate * period
    dry_gain = viscous_gain = gain
    last, rejected, rejection = 0.0, 0, ""
    no_position, no_load_torque, no_acceleration = (
        nan if any(isinstance(term, INPUT_TERMS[name]) for term in curves.extra) else 0.0
        for name in ("position", "load_torque", "acceleration")
    )

    # One long function on purpose: a call to an inner one would cost as much as a third of the whole.
    def torque(  # noqa: C901
        velocity_reference: float,
        velocity: float | None = None,
        position_error: float | None = None,
        normal_load: float | None = None,
        position: float | None = None,
        load_torque: float | None = None,
        temperature: float | None = None,
        acceleration: float | None = None,
    ) -> float:
        nonlocal last, rejected, rejection
        try:
            total = blended = drive = velocity_reference
            factor = 1.0
            if velocity is not None:
                total += velocity
                if measured:
                    drive = velocity - high_band if velocity > high_band else min(velocity - low_band, 0.0)
                blended = keep * drive + share * velocity
            direction = drive
            if position_error is not None:
                total += position_error
                if position_error > high_error:
                    direction += error_rate * (position_error - high_error)
                elif position_error < low_error:
                    direction += error_rate * (position_error - low_error)
            if normal_load is not None:
                total += normal_load
                factor = insensitive + per_load * (
                    high_load if normal_load > high_load else low_load if normal_load < low_load else normal_load
                )
            if extra is not None:
                q = no_position if position is None else position
                carried = no_load_torque if load_torque is None else load_torque
                a = no_acceleration if acceleration is None else acceleration
                total += q + carried + a + (0.0 if temperature is None else temperature)
            if total - total != 0.0:  # infinite or NaN; what follows would turn either into a torque
                raise ValueError("an input is not finite, or one that the model depends on is missing")
            dragged = drive
            if lagging is not None:
                felt, dragged = lagging(blended, drive)
            if direction >= 0.0:
                coulomb, rise, stribeck_velocity, exponent, viscous = forward
            else:
                coulomb, rise, stribeck_velocity, exponent, viscous = reverse
                blended = -blended
            if lagging is not None:  # the velocity that drags has not turned yet, and the coefficient must not jump
                viscous = mean_viscous + half_viscous * tanh(direction / smoothing)
            if bristle is None:
                falling = 1.0
                speed = blended if lagging is None else abs(felt)
                if speed > 0.0:
                    ratio = speed / stribeck_velocity
                    falling = exp(-ratio * ratio if square else -(ratio**exponent))
                if velocity is None:
                    falling *= unseen
                elif low_rest < velocity < high_rest:
                    falling += (1.0 - falling) * (1.0 - abs(velocity) / high_rest)
                level = factor * (coulomb + rise * falling)
                tau = level * tanh(direction / smoothing)
            else:
                tau, level = bristle(drive, dragged, factor)
            if extra is None:
                tau = dry_gain * tau + viscous_gain * viscous * dragged
            else:
                dry, drag, held = extra(blended, drive, q, carried, temperature, a)
                if dry < -level:  # all of dry friction together may vanish, but it never drives
                    dry = -level
                tau = dry_gain * (tau + dry * tanh(direction / smoothing)) + viscous_gain * (viscous * dragged + drag)
            if not low <= drive <= high:
                left = 1.0 - (drive - high if drive > high else low - drive) * fade
                tau = tau * left if left > 0.0 else 0.0
            if extra is not None:
                tau += gain * held
            if not lowest <= tau <= highest:
                if tau - tau != 0.0:
                    raise ValueError("the torque is not finite")
                tau = highest if tau > 0.0 else lowest
            if not fall <= tau - last <= climb:
                tau = last + climb if tau > last else last + fall
            last = tau
            return tau
        except (TypeError, ValueError, OverflowError) as error:
            last, rejection = 0.0, f"{type(error).__name__}: {error}"
            rejected += 1
            return 0.0

    def reset() -> None:
        nonlocal last
        last = 0.0
        reset_bristle()
        reset_lag()
        reset_extra()

    def set_scale(dry_scale: float, viscous_scale: float) -> None:
        nonlocal dry_gain, viscous_gain
        dry_gain, viscous_gain = gain * dry_scale, gain * viscous_scale

    return HotPath(torque, reset, lambda: rejected, lambda: rejection, set_scale)


def _nothing() -> None:
    """What has no state has nothing to reset."""
