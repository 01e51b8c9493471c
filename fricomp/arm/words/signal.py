"""How log and simulation fit together in time, and what of the recording counts, in words; from the record alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fricomp.diagnosis.record.result import Quantity

from ..record import ArmRecord, JointRecord

_HELD = 0.5
"""Of the time between rows: nobody knows of a row at which instant within that it was taken."""


def say_signal(record: ArmRecord) -> tuple[str, ...]:
    """Delay, gravity and gain of all torques, and what was compared."""
    lines = [*say_delay(record)]
    if record.tilt is not None:
        lines.append(f"The base is not level: {say_tilt(record.tilt)}.")
    if record.gain is not None:
        lines.append(f"All torques are {record.gain.value:.3g} times those that the simulation asks for.")
    lines.append(
        f"Compared up to {record.cutoff:g} Hz, over {record.duration:.4g} s; above, structure that rings would be "
        "taken for friction."
    )
    if record.left_out > 0.005:
        guided = ", what else moved the arm" if record.guided else ""
        lines.append(
            f"{record.left_out:.0%} of the time was left out: gaps{guided}, and stretches too short between them."
        )
    lines += say_other_joints(record)
    if record.held_joints:
        lines.append(
            f"Held where the simulation has them, since nothing was recorded: {', '.join(record.held_joints)}."
        )
    return tuple(lines)


def say_delay(record: ArmRecord) -> tuple[str, ...]:
    """By how much the torques are surely late or early, if they are."""
    low, high = record.delay.ci95
    if not record.delay.value or low <= 0.0 <= high:
        return ()
    way = "late behind" if record.delay.value > 0.0 else "ahead of"
    own = [joint.name for joint in record.joints if any(one.name == "torque_delay" for one in joint.effects)]
    whose = f"The torques of all joints but {', '.join(own)}" if own else "All torques"
    held = ", as commands are that act until the next row" if high < 0.0 and not _is_odd(record) else ""
    return (
        f"{whose} are {1e3 * abs(record.delay.value):.3g} ms {way} the positions ({1e3 * low:.3g} to {1e3 * high:.3g} "
        f"ms){held}; this was taken off.",
    )


def say_odd_delay(record: ArmRecord) -> tuple[str, ...]:
    """The same where it is more than rows that hold until the next one explain."""
    return say_delay(record) if _is_odd(record) else ()


def _is_odd(record: ArmRecord) -> bool:
    low, high = record.delay.ci95
    return max(low, -high) > _HELD * record.period


def say_mistimed(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """In which joints links ask for another time than friction does, if in any, and what that may be."""
    shown = [
        f"{joint.name} {1e3 * abs(time.value):.3g} ms {'later' if time.value > 0.0 else 'earlier'} "
        f"({1e3 * time.ci95[0]:.3g} to {1e3 * time.ci95[1]:.3g})"
        for joint in joints
        if (time := joint.link_delay) is not None
    ]
    if not shown:
        return ()
    return (
        f"What the links ask for was recorded at another time than the rest, in {', '.join(shown)}, and friction does "
        "not show it, as where a command acts through a drive that lags, or a gear gives way: what else is told of "
        "this joint may stand in for that.",
    )


def say_other_joints(record: ArmRecord) -> tuple[str, ...]:
    """Joints of which less is said, or nothing, and why."""
    lines = []
    if record.one_way:
        lines.append(
            f"Moved one way only, so that friction is not told from a constant torque: {', '.join(record.one_way)}."
        )
    if record.still_joints:
        lines.append(
            f"Stood still, so that nothing is said of them: {', '.join(record.still_joints)}. Their links count with "
            "the one that carries them."
        )
    if record.unknown_joints:
        names = ", ".join(record.unknown_joints)
        lines.append(f"Left out, since the simulation lacks them: {names}. What they move counts as if it stood still.")
    return tuple(lines)


def say_tilt(tilt: Mapping[str, Quantity]) -> str:
    """How far gravity leans over along each level axis, in mrad."""
    parts = (
        f"{1e3 * one.value:+.3g} mrad ({1e3 * one.ci95[0]:.3g} to {1e3 * one.ci95[1]:.3g}) along {name}"
        for name, one in tilt.items()
    )
    return f"gravity leans over by {' and '.join(parts)} of the simulation"
