"""A torque that becomes another multiple of itself within the recording, once or several times: two logs in one."""

from collections.abc import Sequence

import numpy as np

from fricomp.recording.checks.joint_fit import average_motion
from fricomp.recording.checks.torque_step import REST, SHOWN, TorqueStep, count_alike, list_columns, locate_torque_step
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.root_mean_square import compute_rms

_HALVES = ((0.0, 0.5), (0.25, 0.75), (0.5, 1.0))
"""Parts of a recording in which a change is looked for that another one takes back: those a quarter of it apart are
seen."""
_SLACK = 0.5
"""Time by which two steps found in different parts may differ and be one [s]: some blocks of a filter."""


def find_gain_change(recording: Recording) -> tuple[Finding, ...]:
    """A torque with several sizes, which is refused; or a friction with two, at once, which is told."""
    steps = locate_torque_steps(recording)
    if not steps:
        return ()
    said = [f"{step.factor:.3g} times as large from {_say_time(step)} s on" for step in steps]
    edges = [f"--from {step.after:.3f}" for step in steps[:-1]]
    between = [f"{one} --to {step.before:.3f}" for one, step in zip(edges, steps[1:], strict=True)]
    parts = [f"--to {steps[0].before:.3f}", *between, f"--from {steps[-1].after:.3f}"]
    apart = f"take the parts apart ({', '.join(parts)})"
    if steps[0].is_gain:
        message = (
            f"torque is {', and again '.join(said)}, what inertia and gravity ask for as well as friction: its scale "
            "changes, as of two logs in one, another torque constant or a driver set up anew"
        )
        advice = f"{apart}; only one of them is in its unit, or multiply the other by its factor first"
        return (Finding("gain_change", "error", message, advice, column="torque"),)
    message = (
        f"friction is {said[0]}, at once: the scale of the torque changes, or a brake, a load on the bearings or "
        "another joint"
    )
    return (Finding("friction_step", "warning", message, f"{apart}: no one curve is both", column="torque"),)


def _say_time(step: TorqueStep) -> str:
    return f"{step.before:.3f}" if step.after - step.before < REST else f"{step.before:.3f} to {step.after:.3f}"


def locate_torque_steps(recording: Recording) -> list[TorqueStep]:
    """The times at which the torque becomes another multiple, or the one at which friction does; empty where nothing
    does.

    Two changes that take each other back are no step of the whole recording, or one of friction: they are looked for in
    halves of it, and believed where all of them together explain it.
    """
    if average_motion(recording) is None:
        return []
    step = locate_torque_step(recording)
    found = [step] if step is not None and step.is_gain else []
    size = len(recording)
    for begin, end in _HALVES:
        half = locate_torque_step(recording.rows(slice(round(begin * size), round(end * size))))
        if half is not None and half.is_gain and not any(_is_same(half, one) for one in found):
            found.append(half)
    found.sort(key=lambda one: one.before)
    if found and (step in found or _explain_all(recording, found)):
        return found
    return [] if step is None else [step]


def _is_same(one: TorqueStep, other: TorqueStep) -> bool:
    """Whether two steps are at the same time, so far as rows that slide tell it."""
    return one.before < other.after + _SLACK and other.before < one.after + _SLACK


def _explain_all(recording: Recording, steps: Sequence[TorqueStep]) -> bool:
    """Whether a joint whose torque has all of these sizes explains a recording better than one with a single size."""
    motion = average_motion(recording)
    if motion is None:
        return False
    joint = list_columns(motion, np.asarray(recording.torque), rotary=recording.metadata.motion == "rotary")
    time = motion.time[motion.rows]
    size = np.prod([np.where(time >= step.after, step.factor, 1.0) for step in steps], axis=0)
    kept = joint.of_body | joint.of_friction
    left = [
        joint.target - columns @ np.linalg.lstsq(columns, joint.target, rcond=None)[0]
        for columns in (joint.columns[:, kept], joint.columns[:, kept] * size[:, None])
    ]
    nats = 0.5 * time.size / count_alike(left[1])
    return bool(nats * np.log(compute_rms(left[0]) ** 2 / max(compute_rms(left[1]) ** 2, 1e-300)) > SHOWN)
