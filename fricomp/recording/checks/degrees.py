"""Positions and velocities in degrees or mm: by steps, limits, reference or gravity, and suspected by their size."""

from math import log2, pi
from typing import NamedTuple

import numpy as np

from fricomp.recording.checks.coarse_blocks import average_blocks
from fricomp.recording.checks.position_unit import reference_slope
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_position_step, is_round, is_rounding, shows_radians
from fricomp.recording.validity import Samples

DEGREES = 180 / pi
"""Degrees in a radian, 57.3: the factor that a wrong unit leaves."""

_LARGEST_TRAVEL = 4 * pi  # [rad] two turns: more is rare at a joint that does not turn without end
_LARGEST_SPEED = 30.0  # [rad/s] at the joint side of a robot
_LONGEST_TRAVEL = 20.0  # [m]
_TOLERANCE = 0.1
_CLEARLY = 0.25  # part of the squares that another explanation leaves, below which gravity in degrees is the one
_LIKELY = 0.5  # the same, below which a torque that bends with the position over many turns makes degrees likely


def find_degrees(recording: Recording) -> tuple[Finding, ...]:
    """Positions that are degrees: by the encoder's step, limits, reference or gravity; suspected by plain size."""
    if recording.metadata.motion != "rotary":
        return _find_millimetres(recording)
    for evidence in (_degrees_by_step, _degrees_by_limits, _degrees_by_reference, _degrees_by_gravity):
        message = evidence(recording)
        if message is not None:
            advice = 'multiply by π/180 (unit = "deg" in a mapping)'
            if evidence is _degrees_by_gravity:
                advice += "; if the position is in radians, state continuous: true"
            return (
                Finding("degrees", "error", f"{message}: factor 57.3, it is in degrees", advice, column="position"),
            )
    return _suspect_degrees(recording)


def suspect_degrees_per_second(speed: float) -> tuple[Finding, ...]:
    """A top speed [rad/s] that a joint hardly reaches but that is usual in degrees per second."""
    if speed <= _LARGEST_SPEED:
        return ()
    message = f"velocity reaches {speed:.4g} rad/s: is it in degrees per second (factor 57.3)?"
    advice = "multiply by π/180, or go on if it is right"
    return (Finding("degrees_suspected", "warning", message, advice, column="velocity"),)


def _degrees_by_step(recording: Recording) -> str | None:
    step = find_position_step(recording.position)
    if step is None:
        return None
    resolution = recording.metadata.encoder_resolution
    if resolution is not None and abs(step / resolution / DEGREES - 1) < 0.02:
        return f"position moves in steps of {step:.4g} where the encoder has {resolution:.4g} rad"
    bits = log2(360 / step)
    if resolution is None and 8 < bits < 27 and abs(bits - round(bits)) < 1e-4:
        return f"position moves in steps of {step:.4g}, which is 360 / 2^{round(bits)}"
    counts = round(360 / step)
    if resolution is None and is_round(counts) and abs(counts * step / 360 - 1) < 1e-5 and not is_rounding(step):
        return f"position moves in steps of {step:.4g}, which is 360 / {counts}"
    return None


def _degrees_by_limits(recording: Recording) -> str | None:
    metadata, reach = recording.metadata, float(np.abs(recording.position).max())
    if metadata.position_limits is not None:
        limit = max(abs(end) for end in metadata.position_limits)
        if reach > 1.5 * limit and reach / DEGREES <= 1.05 * limit:
            return f"position reaches {reach:.4g} where the joint ends at {limit:.4g} rad"
    speed = 0.0 if recording.velocity is None else float(np.percentile(np.abs(recording.velocity), 99))
    if metadata.velocity_limit is not None and speed > 1.5 * metadata.velocity_limit >= 1.5 * speed / DEGREES / 1.05:
        return f"velocity reaches {speed:.4g} where the joint ends at {metadata.velocity_limit:.4g} rad/s"
    return None


def _degrees_by_reference(recording: Recording) -> str | None:
    slope = reference_slope(recording)
    if slope is not None and abs(slope / DEGREES - 1) < _TOLERANCE:
        return "position moves 57.3 times as far as position_reference"
    return None


def _degrees_by_gravity(recording: Recording) -> str | None:
    """Whether the torque follows the sine of the position as an angle in degrees, and nothing else does as well.

    A travel of many turns in radians is one of some ten degrees: gravity turns round with the turns there and bends
    once here. A spring or a cable on a drum is straight over all of it, or bends one way.
    """
    if recording.metadata.continuous or np.ptp(recording.position) < _LARGEST_TRAVEL:
        return None
    left = _leave_by_position(recording)
    if left is None:
        return None
    others = min(left.radians, left.bend)
    if left.degrees > _CLEARLY * others:
        return None
    return (
        "the torque follows the sine of position / 57.3, as gravity does, and leaves "
        f"{np.sqrt(others / max(left.degrees, 1e-300)):.3g} times as much beside anything else"
    )


class _Left(NamedTuple):
    """Squares of the torque beside inertia and friction, with gravity in either unit and with a bend over all."""

    plain: float
    radians: float
    degrees: float
    bend: float


def _leave_by_position(recording: Recording) -> _Left | None:
    rows = average_blocks(recording)
    if rows is None:
        return None
    _, position, torque, velocity, fast = rows
    position, torque = position[fast], torque[fast]
    plain = [np.sign(velocity), velocity, np.gradient(velocity), np.ones(velocity.size)]
    columns = np.column_stack(plain)[fast]

    def leave(*more: Samples) -> float:
        design = np.column_stack([columns, *more])
        design = design / np.maximum(np.linalg.norm(design, axis=0), 1e-300)
        left = torque - design @ np.linalg.lstsq(design, torque, rcond=None)[0]
        return float(left @ left)

    turned = position / DEGREES
    return _Left(
        leave(),
        leave(np.sin(position), np.cos(position)),
        leave(np.sin(turned), np.cos(turned)),
        leave(position, position**2),
    )


def _suspect_degrees(recording: Recording) -> tuple[Finding, ...]:
    if recording.metadata.continuous or recording.metadata.position_limits is not None:
        return ()
    travel = float(np.ptp(recording.position))
    speed = 0.0 if recording.velocity is None else float(np.percentile(np.abs(recording.velocity), 99))
    if travel <= _LARGEST_TRAVEL or shows_radians(recording.position):
        return suspect_degrees_per_second(speed)
    advice = 'multiply by π/180 (unit = "deg" in a mapping); if it is right, state position_limits or continuous: true'
    message = f"position covers {travel:.4g} rad, {travel / 2 / pi:.1f} turns"
    left = _leave_by_position(recording)
    if left is not None and min(left.bend, left.degrees) < _LIKELY * min(left.plain, left.radians):
        message += ", and the torque bends with it over all of them: it seems to be in degrees (factor 57.3)"
        return (Finding("degrees_likely", "warning", message, advice, column="position"),)
    message += ": is it in degrees (factor 57.3)?"
    return (Finding("degrees_suspected", "warning", message, advice, column="position"),)


def _find_millimetres(recording: Recording) -> tuple[Finding, ...]:
    travel = float(np.ptp(recording.position))
    if travel < _LONGEST_TRAVEL or recording.metadata.continuous:
        return ()
    message = f"position covers {travel:.4g} m: is it in millimetres?"
    advice = 'multiply by 0.001 (unit = "mm" in a mapping)'
    return (Finding("millimetres_suspected", "warning", message, advice, column="position"),)
