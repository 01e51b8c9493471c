"""What was taken to be otherwise than log and simulation have it, in words; from the record alone."""

from __future__ import annotations

from collections.abc import Sequence

from ..record import ArmRecord, JointFrame, JointRecord

__all__ = ["name_frame", "say_corrections", "say_gravity", "say_scaled", "say_turned"]


def say_corrections(record: ArmRecord) -> tuple[str, ...]:
    """What was taken to be otherwise than log and simulation have it, before anything was fitted."""
    degrees = "Positions were taken to be in degrees: only then does the simulation explain the torques."
    return (
        *_say_order(record),
        *((degrees,) if record.degrees else ()),
        *_say_unwrapped(record.unwrapped),
        *say_gravity(record.gravity, record.frames_instead),
        *say_turned(record.turned_torques),
        *say_guided(record.guided),
    )


def _say_order(record: ArmRecord) -> tuple[str, ...]:
    """Which joints of the simulation the numbers of the log were taken for, if the log has no names."""
    names = ", ".join(joint.name for joint in record.joints)
    order = f"Joints of the log have numbers alone, and were taken in the order of the simulation's chain: {names}."
    return (order,) if record.in_order else ()


def _say_unwrapped(joints: Sequence[str]) -> tuple[str, ...]:
    return (f"Positions of {', '.join(joints)} wrap round at a turn, and were unwrapped.",) if joints else ()


def say_guided(spans: Sequence[tuple[float, float]]) -> tuple[str, ...]:
    """When something else than the drives moved the arm, if anything did."""
    if not spans:
        return ()
    times = ", ".join(f"{first:.3g} to {last:.3g} s" for first, last in spans)
    return (
        f"At {times} something else than the drives moved or held the arm, such as a hand, a contact or a load that it "
        "picked up: there the torques of nearly all joints are off by more than half of their friction. That time was "
        "left out.",
    )


def say_scaled(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """In whose torques friction and rotors are told, where those that were recorded have a wrong scale."""
    shown = [
        f"{joint.name} (over {1.0 + one.parameters['gain_error'].value:.3g})"
        for joint in joints
        for one in joint.effects
        if one.name == "torque_gain_error"
    ]
    if not shown:
        return ()
    return (
        f"Friction and rotor of {', '.join(shown)} are divided by that scale, here and in the files: mend the scale of "
        "the torque (drive constant, gear ratio or sensor) before you compensate by them.",
    )


def say_turned(joints: Sequence[str]) -> tuple[str, ...]:
    """Whose torques were turned round, if any, and what follows for whoever uses the files."""
    if not joints:
        return ()
    return (
        f"The torque of {', '.join(joints)} was recorded with the opposite sign: positive torque accelerates towards "
        "positive position. It was turned round first; a drive that takes its torques as they were recorded needs the "
        "compensation with the opposite sign as well.",
    )


def say_gravity(gravity: Sequence[float] | None, frames: Sequence[JointFrame]) -> tuple[str, ...]:
    """That gravity is another one than in the file, if it is, and what follows from that."""
    if gravity is None:
        return ()
    if not any(gravity):
        return (
            "The torques have gravity taken off, as those of a controller that adds it by itself. So the simulation "
            "was compared without it, arm.xml has none, and masses show by inertia alone: log whole torques if you "
            "can.",
        )
    axes = ", ".join(f"{one:.3g}" for one in gravity)
    alike = f" These torques would be the same with {'; '.join(map(name_frame, frames))}." if frames else ""
    return (
        f"The arm is mounted otherwise than in the simulation: by the torques, gravity is ({axes}) m/s² in its axes. "
        f"It was taken so, and arm.xml has it so.{alike}",
    )


def name_frame(frame: JointFrame) -> str:
    """How a joint would be read in another frame."""
    position = ("q" if frame.direction > 0 else "-q") + (f" {frame.offset:+.4g} rad" if frame.offset else "")
    return f"{frame.joint}, with position {position}{'' if frame.direction > 0 else ' and torque the other way'}"
