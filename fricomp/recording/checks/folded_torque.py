"""A torque that left the range of its register: beyond one end it comes back from the other."""

from __future__ import annotations

import numpy as np

from fricomp.recording.checks.quantum import measure_quantum
from fricomp.recording.checks.torque_causes import fit_joint
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_BITS = (8, 10, 12, 14, 16, 24, 32)
"""Lengths of registers."""
_FILLED = 0.98
"""Part of the range that a torque fills which leaves it."""
_BEYOND = 1.5
"""Ranges within which the unfolded torque stays: one that jumps for another reason runs away."""
_LEAVES = 0.5
"""What the unfolded torque may leave unexplained over what the folded one does."""


def find_folded_torque(recording: Recording) -> tuple[Finding, ...]:
    """A signed torque that is larger than its register holds."""
    span = find_fold(recording)
    if span is None:
        return ()
    unit = recording.metadata.torque_unit
    message = (
        f"torque jumps from one end of a register's range, ±{0.5 * span:.5g} {unit}, to the other: it is larger than "
        "that register holds"
    )
    advice = f"write unwrap = {span:.6g} into the channel of a mapping, and log it with more bits or a larger unit"
    return (Finding("folded_torque", "error", message, advice, column="torque"),)


def find_fold(recording: Recording) -> float | None:
    """The range of a signed register that the torque leaves [as torque]; None where it does not.

    The motion tells: unfolded, the torque is that of a joint, and stays near the range.
    """
    torque = np.asarray(recording.torque)
    travel = float(np.ptp(torque))
    if travel == 0.0 or not np.any(np.abs(np.diff(torque)) > 0.5 * travel):
        return None
    quantum = measure_quantum(torque, most_levels=1.0)
    spans = (quantum * 2.0**bits for bits in _BITS)
    span = next((one for one in spans if _FILLED * one < travel <= one), None)
    if span is None:
        return None
    unfolded = unfold(torque, span)
    as_it_is, mended = fit_joint(recording), fit_joint(recording, unfolded)
    if mended is None or not mended.can_be or float(np.max(np.abs(unfolded))) > _BEYOND * span:
        return None
    return span if as_it_is is None or mended.residual < _LEAVES * as_it_is.residual else None


def unfold(torque: Samples, span: float) -> Samples:
    """The torque without its jumps by this range, its middle within it. Shape (n,)."""
    unfolded = np.unwrap(torque, period=span)
    return np.asarray(unfolded - span * np.round(np.median(unfolded) / span))
