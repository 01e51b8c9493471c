"""Torques in registers: signed numbers that were read as unsigned ones, and numbers beyond what a register holds."""

from typing import NamedTuple

import numpy as np

from fricomp.recording.checks.joint_fit import fit_joint
from fricomp.recording.checks.quantum import measure_quantum
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_BITS = (8, 12, 14, 16, 24, 32)
"""Lengths of registers."""
_USUAL_BITS = 16
"""Length of most registers of currents."""
_WHOLE_RANGE = 0.02
"""Relative distance of a jump from the range of a register: the torque itself moves on meanwhile."""
_WHOLE_JUMP = 0.8
"""Part of the largest torque from which on a jump is a whole one; interpolation makes two of one."""
_BETWEEN = 0.05
"""Part of the rows that may lie between both ends of the range: interpolation puts them there."""
_FOLDED_BITS = (8, 10, 12, 14, 16, 24, 32)
"""Lengths of registers."""
_FILLED = 0.98
"""Part of the range that a torque fills which leaves it."""
_BEYOND = 1.5
"""Ranges within which the unfolded torque stays: one that jumps for another reason runs away."""
_LEAVES = 0.5
"""What the unfolded torque may leave unexplained over what the folded one does."""


class Register(NamedTuple):
    """What a signed torque was stored in.

    Attributes:
        bits: Its length.
        span: Its range [as torque].
        sure: Whether the steps of the torque tell the length.
    """

    bits: int
    span: float
    sure: bool


def find_unsigned_torque(recording: Recording) -> tuple[Finding, ...]:
    """A signed torque that was read as an unsigned number: it jumps by the whole range of its register."""
    register = find_register(recording)
    if register is None:
        return ()
    unit = recording.metadata.torque_unit
    message = (
        f"torque jumps by {register.span:.5g} {unit} and back, the range of a register: it is a signed number of "
        f"{register.bits} bits that was read as an unsigned one"
    )
    if not register.sure:
        message += " (16 where its steps do not tell the length; see the manual)"
    advice = (
        f"write signed_bits = {register.bits} into the channel of a mapping where its column holds the counts, or "
        f"signed_range = {register.span:.6g} [{unit}] where they are scaled ('fricomp convert LOG --inspect' has a "
        "mapping to edit)"
    )
    return (Finding("unsigned_torque", "error", message, advice, column="torque"),)


def find_register(recording: Recording) -> Register | None:
    """The register of a signed torque that was read as an unsigned number; None where it was not.

    Its values lie next to zero and next to the range of the register, nowhere between, and never further apart than the
    range: kicks of a controller do. Where the range is no power of two of the torque's steps, a torque in pulses looks
    alike: then only the motion tells.
    """
    torque = np.asarray(recording.torque)
    torque = -torque if torque.max() < -torque.min() else torque
    jumps = np.abs(np.diff(torque))
    if not np.any(jumps > 0.5 * float(np.ptp(torque))):
        return None
    whole = jumps[jumps > _WHOLE_JUMP * torque.max()]
    span = float(np.median(whole) if whole.size else torque.max())
    low = np.abs(torque) < 0.25 * span
    between = float(np.mean(~low & (np.abs(torque - span) >= 0.25 * span)))
    quantum = measure_quantum(torque[low]) if np.count_nonzero(low) > 1 else 0.0
    if between > _BETWEEN:
        return None
    sign = 1.0 if recording.torque.max() >= -recording.torque.min() else -1.0
    as_it_is = fit_joint(recording)
    bits = round(np.log2(span / quantum)) if quantum > 0.0 else 0
    if bits in _BITS and abs(span / (quantum * 2.0**bits) - 1.0) < _WHOLE_RANGE:
        span = quantum * 2.0**bits
        as_signed = fit_joint(recording, sign * read_signed(torque, span))
        plain = as_it_is and as_signed and as_it_is.can_be and as_it_is.residual < as_signed.residual
        return None if plain or float(np.ptp(torque)) > span else Register(bits, span, sure=True)
    as_signed = fit_joint(recording, sign * read_signed(torque, span))
    if as_it_is is None or as_signed is None or as_it_is.can_be or not as_signed.can_be:
        return None
    return Register(_USUAL_BITS, span, sure=False)


def read_signed(values: Samples, span: float) -> Samples:
    """Unsigned readings of a register of the range `span` as signed ones."""
    return np.where(values >= 0.5 * span, values - span, values)


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
    spans = (quantum * 2.0**bits for bits in _FOLDED_BITS)
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
