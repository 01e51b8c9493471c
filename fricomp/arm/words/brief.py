"""The answer on an arm in short: what is wrong, in which joints and links, what to do, and what joints share; from the
record alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fricomp.diagnosis.effects import EFFECTS
from fricomp.overview import AT_BOUND

from ..matter import LEAST_MATTER
from ..record import ArmRecord, JointEffect, JointFrame, JointRecord
from .corrections import name_frame, say_corrections, say_scaled
from .links import name_link, say_lone_link
from .quantity import show_quantity, show_share
from .signal import say_mistimed, say_odd_delay, say_other_joints, say_tilt
from .stated import list_off_stated, say_stated

_LEAST, _SHARE = 3, 0.5
"""Joints, and part of all joints, in which an effect must show to be told as shared."""

_WORSE = 1.2
"""Held-out error of the model, in that of the simulation, from which on the recording does not hold what is told."""

_CAUSES = {
    "load_coulomb": "the same kind of gear in all of them, or torques of the joints in wrong units",
    "load_quadratic": "the same kind of gear in all of them, or torques of the joints in wrong units",
    "presliding_hysteresis": "the same kind of gear or bearing in all of them, or a clock that is coarse at reversals",
    "thermal_friction": "the arm that warms up as a whole: let it run warm, or record both states",
    "torque_delay": "the bus or the drives' firmware: look at how late the torques are stamped",
    "torque_gain_error": "the supply, or torque constants of one kind: compare them with the drives' data sheets",
}
"""What effects have in common where several joints show them."""


_OFFSET = 0.1
"""Part of a joint's Coulomb torque beyond which a constant torque is told: links that are a little off leave less."""

_UNEXPLAINED = 0.1
"""Part of a joint's friction that is left from which on it is said that something is missing: where nothing is, a
hundredth is left in made arms, and up to a twenty-fifth where joints reverse so fast that a reversal is missed."""

_LATER = "the recorded torque is later than those of the other joints"
_EARLIER = "the recorded torque is earlier than those of the other joints, as a command is that acts after its stamp"

_REFRAME = "To do: give these joints one zero, direction and unit in log and simulation, and run this again."
_SEEK = (
    "To do: look for what else moves or pulls the arm there, record it or hold it still, and run this again. What "
    "joints/NAME/friction.json holds is sure only as far as that is small."
)
_LOG = "To do: log the torque that acts in these joints, and run this again."
_REPEAT = "To do: record again, all joints moving at once by their own drives; until then keep the simulation."


def write_summary(record: ArmRecord, opening: str) -> tuple[str, ...]:
    """Sentences in which a newcomer reads what is wrong, what to do, and what each part is.

    Args:
        record: Everything else.
        opening: The answer in a sentence.
    """
    named = [(joint.name, effect) for joint in record.joints for effect in joint.effects]
    off = [link for link in record.links if link.state == "off"]
    doubts, unexplained, mistimed = list_doubts(record), say_unexplained(record), say_mistimed(record.joints)
    framed = bool(record.better_frames or record.torque_scales)
    stated = list_off_stated(record.joints)
    normal = _say_what_to_do(named=bool(named), off=bool(off or stated))
    if doubts:
        few = ", ".join(joint.name for joint in list_few_worse(record.joints))
        normal = f"{normal} Record {few} again with more motion before you use what is told of it." if few else _REPEAT
    to_do = _REFRAME if framed else _SEEK if opening in unexplained else _LOG if opening in mistimed else normal
    lines = [opening, *(one for one in (*doubts, *unexplained) if one != opening), *say_corrections(record), to_do]
    lines += [*(one for one in mistimed if one != opening), *say_shared_causes(record.joints)]
    kinds = dict.fromkeys((effect.name, say_what(effect)) for _, effect in named)
    lines += [_say_effect([one for one in named if (one[1].name, say_what(one[1])) == kind]) for kind in kinds]
    lines += say_scaled(record.joints)
    lines += [*say_offsets(record.joints), *say_unnamed(record.joints), *say_creep(record.joints)]
    lines += say_lone_link(record.lone_link)
    lines += [f"Links that are off: {', '.join(map(name_link, off))}."] if off and not record.lone_link else []
    lines += [f"The base is not level: {say_tilt(record.tilt)}."] if record.tilt is not None else []
    lines += [*say_stated(record.joints), *say_odd_delay(record)]
    unknown = [link.name for link in record.links if link.state == "not_determined"]
    lines += [f"Not shown by this motion: the mass of {', '.join(unknown)}."] if unknown else []
    return (*lines, *say_other_joints(record))


def list_doubts(record: ArmRecord) -> tuple[str, ...]:
    """Why nothing of an answer holds, where something speaks against it.

    Joints seem to have another unit, zero or direction than in the simulation: all else would follow from that.
    """
    lines = [_say_scales(record.torque_scales)] if record.torque_scales else []
    lines += [_say_frames(record.better_frames)] if record.better_frames else []
    return tuple(lines) or say_doubts(record.joints)


def say_doubts(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """Why a recording does not hold what is told of it.

    Half of its joints do not rub, or a joint's torque is told worse than by the simulation on parts that were left out.
    """
    lines = []
    loose = [one.name for one in joints if _is_loose(one)]
    if len(loose) >= max(2, _SHARE * len(joints)):
        lines.append(
            f"The torques show no friction in {', '.join(loose)}: something else than the drives moved the arm, such "
            "as a hand, and then nothing of this holds; or they are of sensors behind the gears, or have friction "
            "taken off."
        )
    worse, few = [joint for joint in joints if _is_worse(joint)], list_few_worse(joints)
    if worse:
        errors = "; ".join(
            f"{one.name} {one.error_model:.3g} {one.unit}, by the simulation {one.error_simulation:.3g}"
            for one in worse
        )
        of, why = "", "the parts show too little of each joint, as where one moves at a time"
        if few:
            of = f" of {', '.join(joint.name for joint in few)}"
            why = "it moves too little there, or sticks for most of the time"
        lines.append(f"What is told{of} does not hold on parts of the recording that were left out ({errors}): {why}.")
    return tuple(lines)


def list_few_worse(joints: Sequence[JointRecord]) -> list[JointRecord]:
    """Joints that are told worse than by the simulation, where they are less than half of all; else none.

    What is told of the others holds: a joint that hardly moves says little of its own torque, and nothing of theirs.
    """
    worse = [joint for joint in joints if _is_worse(joint)]
    loose = sum(map(_is_loose, joints)) >= max(2, _SHARE * len(joints))
    return [] if loose or len(worse) >= _SHARE * len(joints) else worse


def _is_worse(joint: JointRecord) -> bool:
    """Whether a joint's torque is told worse than by its simulation, by more than nobody would notice."""
    level = joint.friction.get("coulomb")
    least = LEAST_MATTER * level.value if level is not None else 0.0
    return joint.error_model > _WORSE * joint.error_simulation + least


def say_unexplained(record: ArmRecord) -> tuple[str, ...]:
    """In which joints something is left that is neither noise nor what was looked for, and what it may be."""
    left = [joint for joint in record.joints if is_unexplained(joint)]
    if not left or list_doubts(record):
        return ()
    joints = ", ".join(f"{one.name} ({one.unexplained:.0%} of its friction)" for one in left)
    held = f" joints that moved and were not recorded ({', '.join(record.held_joints)})," if record.held_joints else ""
    return (
        f"Something is left that neither links nor any effect that was tried explain, in {joints}: such as{held} a "
        "base that moves or gives way, cables, a hand or another contact, or a load that changes.",
    )


def is_unexplained(joint: JointRecord) -> bool:
    """Whether much is left of a joint in which nothing is named."""
    return not joint.effects and joint.unexplained > _UNEXPLAINED


def _say_scales(scales: Mapping[str, float]) -> str:
    factors = ", ".join(f"{name} {factor:.3g} times" for name, factor in scales.items())
    return (
        f"Torques seem to be in another unit than N·m at the joint: {factors} what the links ask for, as before "
        "a gear, in A or in mN·m. Nothing else is sure until that is mended."
    )


def _say_frames(frames: Sequence[JointFrame]) -> str:
    changes = "; ".join(map(name_frame, frames))
    return (
        "The simulation explains the torques less than half as well as it would with other zeros or directions of "
        f"joints: {changes}. Then links are fitted to what is none of theirs: bring log and simulation into one frame "
        "(sign and offset of a mapping's channels, or the axis and the origin of the joint in the file)."
    )


def _is_loose(joint: JointRecord) -> bool:
    """Whether a joint has no Coulomb friction, and no other term that would have it in its place."""
    terms = {name.partition(".")[0] for name in joint.friction if "." in name} - {"stribeck"}
    level = joint.friction.get("coulomb")
    return level is not None and level.value <= 0.0 and not terms and not joint.effects


def say_shared_causes(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """One sentence on each effect that half of the joints show, with their names and what they may share."""
    lines = []
    for name in sorted({effect.name for joint in joints for effect in joint.effects}):
        shown = [joint.name for joint in joints if any(effect.name == name for effect in joint.effects)]
        if len(shown) >= max(_LEAST, _SHARE * len(joints)):
            cause = _CAUSES.get(name, "one cause")
            lines.append(
                f"{name} shows in {len(shown)} of {len(joints)} joints ({', '.join(shown)}). What they share "
                f"comes first: {cause}."
            )
    return tuple(lines)


def say_offsets(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """Which joints have a constant torque that is surely more than a part of their Coulomb friction, if any."""
    shown = [f"{joint.name} {show_quantity(joint.friction['offset'])}" for joint in joints if _has_offset(joint)]
    if not shown:
        return ()
    return (
        f"A constant torque acts beside gravity in {', '.join(shown)}: such as the zero of a torque sensor, friction "
        "that is higher in one direction, or something that pulls. The friction files hold it.",
    )


def _has_offset(joint: JointRecord) -> bool:
    if any(one.name == "spring_torque" for one in joint.effects):  # where the spring rests
        return False
    level, offset = (joint.friction.get(name) for name in ("coulomb", "offset"))
    if level is None or offset is None or offset.ci95[0] <= 0.0 <= offset.ci95[1]:
        return False
    return min(map(abs, offset.ci95)) > _OFFSET * level.value


def say_unnamed(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """What the models of joints hold without a name, if anything."""
    held = [f"{joint.name} {name} ({show_share(fall)})" for joint in joints for name, fall in joint.unnamed.items()]
    if not held:
        return ()
    return (
        "In the model and its files without a name, since it lowers the held-out error of its joint by too little, or "
        f"is not surely that: {', '.join(held)}.",
    )


def say_creep(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """Which joints have friction that never holds, if any."""
    shown = [
        f"{one.name} ({one.creep_velocity:.2g} {'rad' if one.unit == 'N·m' else 'm'}/s)"
        for one in joints
        if one.creep_velocity is not None
    ]
    if not shown:
        return ()
    return (
        "Friction creeps below a speed, as that of simulators does (MuJoCo's by its default solref, others' as a "
        "hyperbolic tangent of the velocity), and is viscous there, in "
        f"{', '.join(shown)}: its Coulomb level is that above. Joints of a robot stick; some look so that stick for a "
        "moment at each reversal.",
    )


def say_what(effect: JointEffect) -> str:
    """What an effect is; a delay is that of one joint beside the others."""
    if effect.name != "torque_delay":
        return EFFECTS[effect.name].says
    return _LATER if effect.parameters["delay"].value > 0.0 else _EARLIER


def _say_what_to_do(*, named: bool, off: bool) -> str:
    if not named and not off:
        return "To do: nothing of single links; arm.xml holds all as found, joints/NAME/friction.json the friction."
    friction = "compensate with joints/NAME/friction.json"
    return f"To do: simulate with arm.xml, which holds these links and frictions; {friction}."


def _say_effect(shown: list[tuple[str, JointEffect]]) -> str:
    """One effect, with its numbers in each joint that shows it."""
    first = shown[0][1]
    joints = "; ".join(f"{joint} {_list_numbers(effect)}" for joint, effect in shown)
    return f"{first.name}: {say_what(first)} [{first.equation}]; {joints}."


def _list_numbers(effect: JointEffect) -> str:
    alike = f"(or {' or '.join(effect.indistinguishable_from)}) " if effect.indistinguishable_from else ""
    return alike + ", ".join(
        f"{name.replace('_', ' ')} {one.value:.3g}{'' if one.unit == '1' else f' {one.unit}'}"
        f"{f' ({AT_BOUND})' if one.at_bound else ''}"
        for name, one in effect.parameters.items()
    )


def say_possible_spring(joint: JointRecord) -> str:
    """A spring that links stand for as well; nothing where there is none."""
    return (
        f"{joint.name}: a spring or cable of {show_quantity(joint.possible_spring)} explains this recording as well as "
        f"links that weigh what is said here; a motion over a wider range of {joint.name} tells them apart."
        if joint.possible_spring is not None
        else ""
    )
