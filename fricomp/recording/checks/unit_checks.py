"""Checks of units and signs: counts, other factors, flipped signs, motor side, temperature."""

from math import pi

import numpy as np

from fricomp.recording.checks.degrees import DEGREES
from fricomp.recording.checks.position_unit import reference_slope
from fricomp.recording.checks.timing_checks import find_gap_length
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_TOLERANCE = 0.1
_FEWEST_COUNTS = 50  # whole numbers, and travel, from which on no chance makes them so
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


def find_velocity_mismatch(recording: Recording) -> tuple[Finding, ...]:
    """A velocity column that is not the derivative of position: by a factor, by sign, or at all."""
    compared = compare_rate(recording)
    if compared is None:
        return ()
    factor, agreement = compared
    if abs(agreement) < 0.8:
        message = f"velocity does not follow the motion of position (correlation {agreement:.2f})"
        advice = "check that both columns are of the same joint; leave velocity out"
        return (Finding("velocity_mismatch", "warning", message, advice, column="velocity"),)
    return _explain_factor(factor, recording)


def compare_rate(recording: Recording) -> tuple[float, float] | None:
    """How many times as far the position moves as the velocity column says, and the correlation of both ways.

    None where there is no velocity, or nothing moves.
    """
    pair = _increments(recording)
    if pair is None:
        return None
    moved, expected = pair
    both = float(moved @ expected)
    return both / float(expected @ expected), both / float(np.sqrt((moved @ moved) * (expected @ expected)))


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
