"""What tells the unit of a position: the step of its encoder, and a reference beside it."""

from math import pi

import numpy as np

from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_position_step, is_rounding

_FEWEST_BITS, _MOST_BITS = 8, 18
"""Of an encoder with 2ⁿ counts a turn: numbers in single precision have finer steps of that kind."""
_SAME = 0.05
"""Relative error within which a slope is that of a unit."""


def find_turns(recording: Recording) -> tuple[Finding, ...]:
    """Positions in turns, by the step of the encoder or by the reference: viscous friction would be 2π too large."""
    if recording.metadata.motion != "rotary":
        return ()
    said = _say_step(recording) or _say_slope(recording)
    if not said:
        return ()
    advice = (
        'multiply by 2π (unit = "turns" in a mapping); where it is in radians, state encoder_resolution in the metadata'
    )
    return (Finding("turns", "error", f"{said}: factor 6.28, it is in turns", advice, column="position"),)


def reference_slope(recording: Recording) -> float | None:
    """Slope of position over its reference, None where they do not move together."""
    if recording.position_reference is None:
        return None
    reference = recording.position_reference - recording.position_reference.mean()
    position = recording.position - recording.position.mean()
    energy, other = float(reference @ reference), float(position @ position)
    if energy == 0 or other == 0 or abs(reference @ position) < 0.9 * np.sqrt(energy * other):
        return None
    return float(reference @ position / energy)


def _say_step(recording: Recording) -> str:
    """The step of a position that is 1/2ⁿ, or that of the encoder in turns; empty where it is neither."""
    step, resolution = find_position_step(recording.position), recording.metadata.encoder_resolution
    if step is None or is_rounding(step):
        return ""
    if resolution is not None:
        is_told = abs(2.0 * pi * step / resolution - 1.0) < 0.02
        return f"position moves in steps of {step:.4g} where the encoder has {resolution:.4g} rad" if is_told else ""
    counts = round(1.0 / step)
    binary = counts & (counts - 1) == 0 and 2**_FEWEST_BITS <= counts <= 2**_MOST_BITS
    if not binary or abs(counts * step - 1.0) > 1e-5:
        return ""
    return f"position moves in steps of {step:.6g}, which is 1 / 2^{counts.bit_length() - 1}"


def _say_slope(recording: Recording) -> str:
    slope = reference_slope(recording)
    if slope is None or abs(2.0 * pi * slope - 1.0) > _SAME:
        return ""
    return "position moves 6.28 times less far than position_reference"
