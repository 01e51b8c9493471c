"""Checks of units and signs: degrees, other factors, flipped signs, motor side, temperature."""

from math import log2, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.motion_kind import find_steps
from fricomp.recording.checks.position_unit import reference_slope
from fricomp.recording.checks.timing_checks import find_gap_length
from fricomp.recording.checks.torque_causes import explain_energy
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_position_step, is_round, is_rounding, shows_radians

Samples = NDArray[np.float64]

DEGREES = 180 / pi
"""Degrees in a radian, 57.3: the factor that a wrong unit leaves."""

_LARGEST_TRAVEL = 4 * pi  # [rad] two turns: more is rare at a joint that does not turn without end
_LARGEST_SPEED = 30.0  # [rad/s] at the joint side of a robot
_LONGEST_TRAVEL = 20.0  # [m]
_TOLERANCE = 0.1
_FEWEST_COUNTS = 50  # whole numbers, and travel, from which on no chance makes them so
_FEWEST_BLOCKS = 80
_CLEARLY = 0.25  # part of the squares that another explanation leaves, below which gravity in degrees is the one
_LIKELY = 0.5  # the same, below which a torque that bends with the position over many turns makes degrees likely
_LEAST_WORK = 0.1  # part of the work on a closed path that must be friction to tell its sign
_FACTORS = {  # derivative of position over the velocity column -> what that means
    DEGREES: "position is in degrees",
    1 / DEGREES: "velocity is in degrees per second",
    2 * pi / 60: "velocity is in revolutions per minute",
    6.0: "position is in degrees and velocity in revolutions per minute",
    2 * pi: "velocity is in turns per second",
    1 / (2 * pi): "position is in turns",
    1000.0: "position is in thousandths (mm, mrad)",
    1e-3: "velocity is in thousandths (mm/s, mrad/s)",
}


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


def find_counts(recording: Recording) -> tuple[Finding, ...]:
    """Positions that are whole numbers throughout: counts of an encoder, and neither radians nor metres."""
    position = np.asarray(recording.position)
    if np.ptp(position) < _FEWEST_COUNTS or not np.all(position == np.round(position)):
        return ()
    if np.unique(position).size < _FEWEST_COUNTS:
        return ()
    message = (
        f"position holds whole numbers alone, from {position.min():.6g} to {position.max():.6g}: counts of an encoder"
    )
    rotary = recording.metadata.motion == "rotary"
    unit = "6.2832 over the counts of a turn" if rotary else "metres a count"
    such = ", such as 0.001534 of 4096 a turn (Dynamixel X)" if rotary else ""
    advice = f"write scale = {unit} in a mapping{such}; 'fricomp convert LOG --inspect --out log.toml' begins one"
    return (Finding("counts", "error", message, advice, column="position"),)


def suspect_degrees_per_second(speed: float) -> tuple[Finding, ...]:
    """A top speed [rad/s] that a joint hardly reaches but that is usual in degrees per second."""
    if speed <= _LARGEST_SPEED:
        return ()
    message = f"velocity reaches {speed:.4g} rad/s: is it in degrees per second (factor 57.3)?"
    advice = "multiply by π/180, or go on if it is right"
    return (Finding("degrees_suspected", "warning", message, advice, column="velocity"),)


def find_velocity_mismatch(recording: Recording) -> tuple[Finding, ...]:
    """A velocity column that is not the derivative of position: by a factor, by sign, or at all."""
    pair = _increments(recording)
    if pair is None:
        return ()
    moved, expected = pair
    factor = float(moved @ expected / (expected @ expected))
    agreement = float(moved @ expected / np.sqrt((moved @ moved) * (expected @ expected)))
    if abs(agreement) < 0.8:
        message = f"velocity does not follow the motion of position (correlation {agreement:.2f})"
        advice = "check that both columns are of the same joint; leave velocity out"
        return (Finding("velocity_mismatch", "warning", message, advice, column="velocity"),)
    return _explain_factor(factor, recording)


def find_flipped_torque(recording: Recording) -> tuple[Finding, ...]:
    """Friction that drives the motion: the torque's sign is against the convention."""
    if find_steps(recording):  # the torque of the motion is not in the log
        return ()
    friction = _friction_in_quarters(recording)
    work = _share_of_work(recording)
    if friction is not None and np.all(friction < 0):
        message = f"torque against the motion: {friction.mean():.3g} {recording.metadata.torque_unit} in its direction"
    elif work is not None and work < -_LEAST_WORK and (friction is None or friction.mean() < 0):
        message = f"torque takes energy out of the joint on a closed path ({100 * work:.0f} % of what it moves)"
    else:
        return ()
    return (explain_energy(recording, message),)


def find_flipped_reference(recording: Recording) -> tuple[Finding, ...]:
    """A reference that runs against the position."""
    slope = reference_slope(recording)
    if slope is None or slope > -0.5:
        return ()
    message = f"position_reference runs against position (slope {slope:.2f})"
    return (Finding("flipped_reference", "error", message, "flip one of them", column="position_reference"),)


def find_motor_side(recording: Recording) -> tuple[Finding, ...]:
    """Torque on the motor side without a gear ratio to bring it to the joint."""
    if recording.metadata.torque_side == "joint" or recording.metadata.gear_ratio is not None:
        return ()
    message = "torque is on the motor side and the gear ratio is unknown"
    return (Finding("motor_side", "error", message, "state gear_ratio in the metadata", column="torque"),)


def find_wrong_temperature(recording: Recording) -> tuple[Finding, ...]:
    """Temperatures no joint has in degrees Celsius."""
    temperature = recording.temperature
    if temperature is None or (temperature.min() > -60 and temperature.max() < 200):
        return ()
    kelvin = temperature.min() > 200 and temperature.max() < 480
    message = f"temperature runs from {temperature.min():.4g} to {temperature.max():.4g} °C"
    advice = "it looks like kelvin: subtract 273.15" if kelvin else "give degrees Celsius or leave it out"
    return (Finding("temperature_unit", "warning", message, advice, column="temperature"),)


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
    rows = _average_blocks(recording)
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


def _increments(recording: Recording) -> tuple[Samples, Samples] | None:
    """What position moved in each block of samples, and what the velocity column says it should have."""
    if recording.velocity is None or len(recording) < 100:
        return None
    rows = max(10, round(0.05 / recording.sample_period))
    step = np.diff(recording.time) * 0.5 * (recording.velocity[1:] + recording.velocity[:-1])
    path = np.concatenate([[0.0], np.cumsum(step)])
    marks = np.arange(0, len(recording), rows)
    moved, expected = np.diff(recording.position[marks]), np.diff(path[marks])
    gaps = np.flatnonzero(np.diff(recording.time) > find_gap_length(recording))
    whole = np.diff(np.searchsorted(gaps, marks)) == 0  # what happened in a gap is in neither of both
    moved, expected = moved[whole], expected[whole]
    if not moved.size:
        return None
    usual = np.abs(moved) <= 20 * np.percentile(np.abs(moved), 75)  # wraps have a check of their own
    moved, expected = moved[usual], expected[usual]
    still = np.abs(moved).sum() < 40 * (recording.metadata.encoder_resolution or 0.0)
    return None if still or not moved.any() or not expected.any() else (moved, expected)


def _explain_factor(factor: float, recording: Recording) -> tuple[Finding, ...]:
    if abs(factor - 1) < _TOLERANCE:
        return ()
    if abs(factor + 1) < _TOLERANCE:
        message = "velocity has the opposite sign of the motion of position"
        return (Finding("flipped_velocity", "error", message, "flip one of them", column="velocity"),)
    factors = dict(_FACTORS)
    if recording.metadata.gear_ratio is not None:
        factors[1 / recording.metadata.gear_ratio] = "velocity is on the motor side"
    for expected, meaning in factors.items():
        if abs(factor / expected - 1) < 0.5 * _TOLERANCE:
            code = "degrees" if "degrees" in meaning else "velocity_unit"
            column = "position" if meaning.startswith("position") else "velocity"
            message = f"position moves {factor:.4g} times as far as velocity says: {meaning}"
            advice = "name the unit in a mapping"
            if code == "degrees":
                message += " (factor 57.3)"
            return (Finding(code, "error", message, advice, column=column),)
    message = f"position moves {factor:.4g} times as far as velocity says"
    advice = (
        "check the unit of both; of a drive in MIT mode, whether both were read with this motor's own ranges (P_MAX, "
        "V_MAX): those of another motor leave one factor at all speeds"
    )
    return (Finding("velocity_scale", "warning", message, advice, column="velocity"),)


def _friction_in_quarters(recording: Recording) -> Samples | None:
    """Torque that goes with the direction of motion in each quarter of the time [as torque].

    Least squares beside inertia, gravity and offset; None where a quarter has not both directions.
    """
    averaged = _average_blocks(recording)
    if averaged is None:
        return None
    time, position, torque, velocity, fast = averaged
    gravity = (np.sin(position), np.cos(position)) if recording.metadata.motion == "rotary" else (position,)
    design = np.column_stack([np.sign(velocity), np.gradient(velocity, time), np.ones(time.size), *gravity])
    found = []
    for quarter in np.array_split(np.arange(time.size), 4):
        chosen = quarter[fast[quarter]]
        if min((velocity[chosen] > 0).sum(), (velocity[chosen] < 0).sum()) < 5:
            return None
        solution = np.linalg.lstsq(design[chosen], torque[chosen], rcond=None)[0]
        share = abs(solution[0]) / max(float(np.std(torque[chosen])), 1e-300)
        found.append(solution[0] if share > 0.05 else 0.0)
    return np.array(found)


class _Blocks(NamedTuple):
    """Means over blocks of rows, the velocity between them, and which are fast and go the way of their neighbours.

    Swings as short as a block leave a torque of inertia that looks like friction of the other sign. Shapes (n_blocks,).
    """

    time: Samples
    position: Samples
    torque: Samples
    velocity: Samples
    fast: NDArray[np.bool_]


def _average_blocks(recording: Recording) -> _Blocks | None:
    """Means over 50 ms; None where there are too few."""
    rows = max(5, round(0.05 / recording.sample_period))
    count = len(recording) // rows * rows
    time, position, torque = (
        values[:count].reshape(-1, rows).mean(axis=1)
        for values in (recording.time, recording.position, recording.torque)
    )
    if time.size < _FEWEST_BLOCKS:
        return None
    velocity = np.gradient(position, time)
    fast = np.abs(velocity) > 0.1 * np.percentile(np.abs(velocity), 98)
    fast[1:-1] &= (velocity[1:-1] * velocity[:-2] > 0.0) & (velocity[1:-1] * velocity[2:] > 0.0)
    return _Blocks(time, position, torque, velocity, fast)


def _share_of_work(recording: Recording) -> float | None:
    """Net work of the torque over the sum of its magnitudes on a path that returns; None where it does not.

    Friction is all that takes work on such a path, so the share is positive: inertia, gravity and springs
    give back what they took.
    """
    step = np.diff(recording.position)
    path = float(np.abs(step).sum())
    open_part = abs(recording.position[-1] - recording.position[0])
    if path == 0 or (open_part > 0.1 * path and not recording.metadata.continuous):
        return None
    work = 0.5 * (recording.torque[1:] + recording.torque[:-1]) * step
    total = float(np.abs(work).sum())
    return float(work.sum()) / total if total > 0 else None
