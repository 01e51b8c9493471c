"""Friction that drives the motion: a torque that takes energy out of its joint, and why it seems to.

Each cause is tried before anything is advised: a rigid joint with friction is fitted to the torque as it is, read as a
signed number, moved in time, and turned round. A cause explains the symptom where the joint that it leaves could exist,
and leaves less of the torque unexplained.
"""

import numpy as np

from fricomp.recording.checks.coarse_blocks import average_blocks
from fricomp.recording.checks.joint_fit import average_motion, fit_joint, fit_motion
from fricomp.recording.checks.motion_kind import find_steps
from fricomp.recording.checks.register import find_unsigned_torque
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_LONGEST_DELAY = 0.06
"""Largest delay that is tried [s]: two periods of a slow bus and a filter."""
_DELAY_STEP = 2.5e-4
"""Distance of the delays that are tried [s]."""
_CLEARLY = 0.7
"""What a cause may leave of the residual, times what is left without it."""
_EXPLAINED = 0.5
"""Part of the torque's variance that a turned sign must explain."""
_LEAST_WORK = 0.1  # part of the work on a closed path that must be friction to tell its sign


def find_flipped_torque(recording: Recording) -> tuple[Finding, ...]:
    """Friction that drives the motion: the torque's sign is against the convention."""
    if np.ptp(recording.torque) == 0.0 or find_steps(recording):  # the torque of the motion is not in the log
        return ()
    friction = _friction_in_quarters(recording)
    work = _share_of_work(recording)
    if friction is not None and np.all(friction < 0):
        message = f"torque against the motion: {friction.mean():.3g} {recording.metadata.torque_unit} in its direction"
    elif work is not None and work < -_LEAST_WORK and (friction is None or friction.mean() < 0):
        message = f"torque takes energy out of the joint on a closed path ({100 * work:.0f} % of what it moves)"
    else:
        return ()
    return (_explain_energy(recording, message),)


def _explain_energy(recording: Recording, symptom: str) -> Finding:
    """Say why the torque takes energy out of the joint, with the line to write where one cause explains it.

    Args:
        recording: Its torque takes energy out of the joint.
        symptom: What was seen, in words.
    """
    unsigned = find_unsigned_torque(recording)
    if unsigned:
        return unsigned[0]
    delay = find_delay(recording)
    if delay is not None:
        message = f"{symptom}, because it acts {1e3 * delay:.3g} ms after its stamp"
        advice = (
            f"identification and diagnosis take that off; for other tools write delay = {delay:.4g} into the channel "
            "of a mapping"
        )
        return Finding("late_torque", "warning", message, advice, column="torque")
    turned = fit_joint(recording, -np.asarray(recording.torque))
    if turned is None or (turned.can_be and turned.explained > _EXPLAINED):
        advice = "flip its sign (sign = -1 in a mapping): positive torque accelerates towards positive position"
        return Finding("flipped_torque", "error", symptom, advice, column="torque")
    message = f"{symptom}, and neither another sign nor a delay explains it: something else moves the joint"
    advice = (
        "record it while its neighbours rest and nobody moves it by hand, or give the arm's simulation and all joints"
    )
    return Finding("driven", "error", message, advice, column="torque")


def find_delay(recording: Recording) -> float | None:
    """How long after its stamp the torque acts [s]; None where no delay makes a joint of it that could exist."""
    motion, torque = average_motion(recording), np.asarray(recording.torque)
    if motion is None:
        return None
    at_once = fit_motion(motion, recording, torque, 0.0)
    step = max(_DELAY_STEP, 0.1 * recording.sample_period)
    tried = np.arange(step, _LONGEST_DELAY, step)
    fits = [fit_motion(motion, recording, torque, float(delay)) for delay in tried]
    left = np.array([np.inf if fit is None else fit.residual for fit in fits])
    best = int(np.argmin(left))
    found = fits[best]
    if found is None or at_once is None or best == tried.size - 1 or not found.can_be or found.inertia <= 0.0:
        return None
    if found.residual > _CLEARLY * at_once.residual:
        return None
    return float(tried[best])


def _friction_in_quarters(recording: Recording) -> Samples | None:
    """Torque that goes with the direction of motion in each quarter of the time [as torque].

    Least squares beside inertia, gravity and offset; None where a quarter has not both directions.
    """
    averaged = average_blocks(recording)
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
