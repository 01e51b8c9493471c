"""The answer on an arm in one sentence, and in the title of its page; from the record alone."""

from __future__ import annotations

from collections.abc import Sequence

from fricomp.diagnosis.effects import EFFECTS

from ..record import ArmRecord, JointRecord
from .brief import is_unexplained, list_doubts, say_unexplained
from .quantity import show_share
from .signal import say_mistimed
from .stated import list_off_stated


def write_opening(record: ArmRecord) -> str:
    """What is wrong, in a sentence."""
    named = [f"{joint.name} ({effect.name})" for joint in record.joints for effect in joint.effects]
    if named and is_recorded_wrong(record):
        return f"Torques are recorded wrong, and no physics is named: {', '.join(named)}."
    if named:
        return f"The simulation leaves out physics in {', '.join(named)}."
    doubts = (*list_doubts(record), *say_unexplained(record), *say_mistimed(record.joints))
    if doubts:
        return doubts[0]
    off, stated = any(link.state == "off" for link in record.links), list_off_stated(record.joints)
    if stated:
        return say_numbers(record.joints, stated, off=off)
    return say_links(record.joints) if off else say_nothing_missing(record.joints)


def is_recorded_wrong(record: ArmRecord) -> bool:
    """Whether all that is named is of the torque signals, such as their scale or their delay."""
    return {EFFECTS[one.name].kind for joint in record.joints for one in joint.effects} == {"measurement"}


def write_title(record: ArmRecord) -> str:
    """The answer in a few words."""
    if any(joint.effects for joint in record.joints):
        said = "torques are recorded wrong" if is_recorded_wrong(record) else "physics is missing"
    elif list_doubts(record):
        said = "what was found is in doubt"
    elif left := [joint.name for joint in record.joints if is_unexplained(joint)]:
        said = f"unexplained torque in {', '.join(left)}"
    elif late := [joint.name for joint in record.joints if joint.link_delay is not None]:
        said = f"torque at another time in {', '.join(late)}"
    elif list_off_stated(record.joints):
        said = "only numbers of the simulation are off"
    elif any(link.state == "off" for link in record.links):
        said = "only links are off"
    elif any(joint.unnamed for joint in record.joints):
        said = "nothing is named"
    else:
        said = "no physics is missing"
    return f"Arm of {len(record.joints)} joints: {said}"


def say_numbers(joints: Sequence[JointRecord], stated: Sequence[str], *, off: bool) -> str:
    """That friction or rotors that the simulation states are off, and links where they are as well."""
    most = max(joints, key=lambda joint: joint.link_change)
    links = f", and links by {show_share(most.link_change)} of the torque of {most.name} at most" if off else ""
    return (
        f"Only numbers of the simulation are off: friction or rotors that it states of {', '.join(stated)}{links}; "
        f"{_say_rest(joints)}."
    )


def say_links(joints: Sequence[JointRecord]) -> str:
    """That links alone are off, and how much of the torques that is."""
    most = max(joints, key=lambda joint: joint.link_change)
    return (
        f"Only links are off, by {show_share(most.link_change)} of the torque of {most.name} at most; "
        f"{_say_rest(joints)}."
    )


def say_nothing_missing(joints: Sequence[JointRecord]) -> str:
    """That nothing is, and how much of the torques links change that are each as simulated, one by one."""
    most = max(joints, key=lambda joint: joint.link_change)
    opening = (
        "Nothing is named: joints have plain friction, or little beside it,"
        if any(joint.unnamed for joint in joints)
        else "Nothing is missing: joints have plain friction,"
    )
    return f"{opening} and links are as simulated but for {show_share(most.link_change)} of the torque of {most.name}."


def _say_rest(joints: Sequence[JointRecord]) -> str:
    return f"{'nothing is named' if any(joint.unnamed for joint in joints) else 'no physics is missing'} in any joint"
