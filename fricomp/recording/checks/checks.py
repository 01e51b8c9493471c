"""Everything that may mislead about a recording, looked for in one go.

What makes a recording unusable at all (samples that are not finite, time that falls, columns of other
lengths) is refused where the recording is made; here is what a valid recording may still have wrong.
"""

from collections.abc import Callable
from typing import NamedTuple
from weakref import WeakKeyDictionary

from fricomp.recording.checks.copied import find_copied_torque
from fricomp.recording.checks.degrees import find_degrees
from fricomp.recording.checks.gain_change import find_gain_change
from fricomp.recording.checks.lost_sign import find_lost_sign
from fricomp.recording.checks.motion_kind import (
    find_hand_motion,
    find_held_output,
    find_one_way,
    find_silent_torque,
    find_steps,
)
from fricomp.recording.checks.position_jumps import find_position_jumps
from fricomp.recording.checks.position_unit import find_turns
from fricomp.recording.checks.register import find_folded_torque, find_unsigned_torque
from fricomp.recording.checks.sign_change import find_sign_change
from fricomp.recording.checks.signal_checks import find_rest, find_spikes
from fricomp.recording.checks.stuck import find_stuck
from fricomp.recording.checks.timing_checks import (
    find_gaps,
    find_jitter,
    find_low_rate,
    find_rate_change,
    find_wrong_time_unit,
)
from fricomp.recording.checks.torque_causes import find_flipped_torque
from fricomp.recording.checks.torque_sensor import find_torque_gain
from fricomp.recording.checks.unit_change import find_unit_change
from fricomp.recording.checks.unit_checks import (
    find_counts,
    find_flipped_reference,
    find_motor_side,
    find_velocity_mismatch,
    find_wrong_temperature,
)
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording

_Check = Callable[[Recording], tuple[Finding, ...]]

_CHECKS: tuple[_Check, ...] = (
    find_wrong_time_unit,
    find_low_rate,
    find_gaps,
    find_jitter,
    find_rate_change,
    find_rest,
    find_counts,
    find_unit_change,
    find_position_jumps,
    find_stuck,
    find_spikes,
    find_motor_side,
    find_wrong_temperature,
    find_copied_torque,
    find_unsigned_torque,
    find_folded_torque,
    find_lost_sign,
)
_OF_UNWRAPPED: tuple[_Check, ...] = (  # a wrap would look like many other things to them
    find_degrees,
    find_turns,
    find_velocity_mismatch,
    find_sign_change,
    find_gain_change,
    find_flipped_torque,
    find_flipped_reference,
    find_one_way,
    find_steps,
    find_torque_gain,
    find_held_output,
    find_hand_motion,
    find_silent_torque,
)
_ORDER = {"error": 0, "warning": 1, "note": 2}
_FOUND = WeakKeyDictionary[Recording, tuple[Finding, ...]]()
"""What was found in each recording that is still held."""


class CheckedRecording(NamedTuple):
    """A recording with everything its checks found, the gravest first."""

    recording: Recording
    findings: tuple[Finding, ...]


def check_recording(recording: Recording) -> tuple[Finding, ...]:
    """Return everything that may mislead about a recording, the gravest first.

    A finding of severity "error" means that no friction can be identified from the recording as it
    is; `raise_errors` turns such findings into an exception. A recording never changes, so it is looked at once.
    """
    if recording not in _FOUND:
        _FOUND[recording] = _look_for_all(recording)
    return _FOUND[recording]


def _look_for_all(recording: Recording) -> tuple[Finding, ...]:
    findings = [finding for check in _CHECKS for finding in check(recording)]
    if not any(finding.code in ("wrap", "degrees") for finding in findings):
        findings += [finding for check in _OF_UNWRAPPED for finding in check(recording)]
    if any(finding.code == "sign_change" for finding in findings):  # which explains what the others see
        findings = [finding for finding in findings if finding.code not in ("flipped_torque", "driven")]
    first = {(finding.code, finding.column): finding for finding in reversed(findings)}
    once = [finding for finding in findings if first[finding.code, finding.column] is finding]
    return tuple(sorted(once, key=lambda finding: _ORDER[finding.severity]))
