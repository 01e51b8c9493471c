"""The answer on an arm as a record, and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.record.result import Quantity

from .answer import ArmAnswer, TermEvidence
from .comparison.links import describe_link, measure_link_change
from .comparison.lone_link import find_lone_link
from .comparison.stated import list_stated, say_stated
from .elasticity import measure_stiffness
from .fit import Z95, ArmFit
from .friction import CREEP, GEARS, TERMS
from .friction_model import find_creep_velocity
from .record import ARM_SCHEMA, ArmRecord, JointEffect, JointRecord
from .rigid.inertia import N_INERTIA
from .search.frames import find_better_frames, find_torque_scales
from .search.gear import GearSearch
from .search.shared_delay import SharedDelay
from .uncertainty.alternatives import SPRING, Alternatives, find_alternatives, list_links_instead
from .uncertainty.averaging import average_friction, average_links
from .words.brief import (
    list_doubts,
    say_creep,
    say_links,
    say_nothing_missing,
    say_offsets,
    say_possible_spring,
    say_shared_causes,
    say_tilt,
    say_unexplained,
    say_unnamed,
    say_what,
    write_summary,
)
from .words.corrections import say_corrections
from .words.links import say_link, say_lone_link
from .words.quantity import show_quantity

_UNEVEN = (
    "The stamps are not the instants at which rows were sampled: how far the joints came, over their velocities, says "
    "that states of even periods were read, some twice and some never; rows count where they were sampled."
)


def write_record(answer: ArmAnswer) -> ArmRecord:
    """Everything that is said of an arm, in one value."""
    found, arm = answer.identification, answer.identification.fit.arm
    averages = average_friction(found.equations, found.fit, found.prior)
    others = find_alternatives(found.equations, found.fit, found.prior)
    joints = tuple(_describe_joint(answer, j, averages[j], others) for j in range(len(arm.joints)))
    intervals = average_links(found.fit, others)
    links = tuple(describe_link(found, i, intervals[i]) for i in range(len(arm.links)))
    delay = found.delay
    gain, gain_spread = found.fit.gain
    record = ArmRecord(
        schema=ARM_SCHEMA,
        sentences=(),
        joints=joints,
        links=links,
        delay=_quantity(delay.value, delay.deviation, "s"),
        gain=_quantity(gain, gain_spread, "1") if found.fit.model.gain else None,
        tilt=_describe_tilt(found.fit) if found.fit.model.tilted else None,
        gravity=arm.other_gravity,
        cutoff=found.rows.cutoff,
        duration=found.recording.duration,
        left_out=found.recording.left_out,
        held_joints=tuple(name for name in arm.held if name not in found.recording.still),
        still_joints=found.recording.still,
        unknown_joints=found.recording.strangers,
        one_way=found.recording.one_way,
        turned_torques=found.recording.turned,
        degrees=found.recording.degrees,
        better_frames=() if arm.remounted else find_better_frames(arm, found.recording),
        frames_instead=found.recording.frames_instead,
        torque_scales=find_torque_scales(arm, found.recording, found.fit.inertia),
        guided=found.recording.guided_from_start,
        lone_link=find_lone_link(found),
    )
    held = found.recording.held
    rate = f"Most rows of {', '.join(held)} repeat the one before; they were left out." if held else ""
    stamps = _UNEVEN if found.recording.placed else ""
    apart = _say_apart(delay, arm.joints)
    sentences = (*_write_sentences(record), *(one for one in (rate, stamps, apart) if one))
    return replace(record, summary=write_summary(record, sentences[0]), sentences=sentences)


def _say_apart(delay: SharedDelay, joints: Sequence[str]) -> str:
    """That the torques of joints are not late by the same time, where they are not."""
    if not delay.apart:
        return ""
    first, last = (pick(delay.apart, key=delay.apart.__getitem__) for pick in (min, max))
    ends = (f"{1e3 * delay.apart[j]:.2g} ms by {joints[j]}" for j in (first, last))
    return (
        f"Joints do not agree on how late their torques are, from {' to '.join(ends)}: something else moves that in "
        "some of them, such as a gear that gives way. Only a time that most of them ask for is taken off."
    )


def _describe_tilt(fit: ArmFit) -> dict[str, Quantity]:
    pairs = zip(fit.arm.level_axes, *fit.lean, strict=True)
    return {name: _quantity(value, deviation, "rad") for name, value, deviation in pairs}


def _quantity(value: float, deviation: float, unit: str) -> Quantity:
    return Quantity(float(value), unit, (float(value - Z95 * deviation), float(value + Z95 * deviation)))


def _describe_joint(
    answer: ArmAnswer, joint: int, averages: Mapping[str, tuple[float, float]], others: Alternatives
) -> JointRecord:
    found = answer.identification
    fit, metadata = found.fit, found.recording.metadata[joint]
    torque, position = metadata.torque_unit, metadata.position_unit
    form = fit.model.forms[joint]
    place, names = fit.find_friction(joint)
    spread = np.sqrt(np.diag(fit.covariance)[place])
    values = {
        name: _quantity(value, one, _unit_of(name, torque, position))
        for name, value, one in zip(names, fit.x[place], spread, strict=True)
    }
    for name, (low, high) in averages.items():
        value = 0.0 if (joint, name) in fit.model.pinned else min(max(values[name].value, low), high)
        values[name] = Quantity(value, values[name].unit, (low, high))
    effects = [
        _describe_effect(answer, joint, term, variant, values, others)
        for term, variant in form.terms
        if answer.is_named(joint, term)
    ]
    named, spring = {one.name for one in effects}, others.find_spring(joint)
    own = {name for term, k in form.terms if form.find_head(term) in named for name in TERMS[term].names(k)}
    first = N_INERTIA * len(fit.arm.links) + joint
    rotor = float(np.sqrt(fit.covariance[first, first]))
    inertia = f"{torque}·s²/{position}" if metadata.motion == "linear" else "kg·m²"
    return JointRecord(
        name=fit.arm.joints[joint],
        unit=torque,
        friction={name: value for name, value in values.items() if name not in own},
        effects=tuple(sorted(effects, key=lambda one: -one.fall)),
        rotor_inertia=_quantity(float(fit.armature[joint]), rotor, inertia),
        error_simulation=float(answer.errors.simulation[joint]),
        error_plain=float(answer.errors.plain[joint]),
        error_model=float(answer.errors.model[joint]),
        unexplained=answer.measure_unexplained(joint),
        stiffness=measure_stiffness(found, joint),
        creep_velocity=find_creep_velocity(found, joint) if CREEP in form.names else None,
        possible_spring=None if spring is None else _quantity(*spring, f"{torque}/{position}"),
        link_change=measure_link_change(found, joint),
        stated=list_stated(fit.arm, joint),
        unnamed=answer.list_unnamed(joint),
    )


def _describe_effect(
    answer: ArmAnswer, joint: int, term: str, variant: int, values: dict[str, Quantity], others: Alternatives
) -> JointEffect:
    evidence: TermEvidence = answer.evidence[joint, term]
    found = answer.identification
    name = f"{found.fit.arm.joints[joint]}: {term}"
    columns = zip(TERMS[term].columns, TERMS[term].names(variant), strict=True)
    parameters = {short: values[long] for short, long in columns}
    for other, k in found.fit.model.forms[joint].terms:
        if other != term and found.fit.model.forms[joint].find_head(other) == term:
            pairs = zip(TERMS[other].columns, TERMS[other].names(k), strict=True)
            parameters |= {f"{other}_{short}": values[long] for short, long in pairs}
    metadata, rotary = found.recording.metadata[joint], found.fit.arm.rotary[joint]
    torque, position = metadata.torque_unit, metadata.position_unit
    if values_tried := TERMS[term].list_values(rotary=rotary):
        unit = {"breakaway_distance": position, "order": f"1/{position}"}.get(TERMS[term].label, "1")
        around, at_end = TERMS[term].bound_variant(variant, rotary=rotary), TERMS[term].is_at_end(variant)
        parameters[TERMS[term].label] = Quantity(values_tried[variant], unit, around, at_bound=at_end)
    if (filled := TERMS[term].filled) in GEARS:  # the factor on it is one
        width, stiffness, _ = found.equations.gears[filled][joint].tolist()
        low, high = GearSearch(found.rows, found.fit, filled).bound(found.equations, found.fit, joint)
        if filled == "gap":
            parameters = {"gap": Quantity(width, position, (low, high))}
        else:  # below its swing a stiffer gear with a larger factor would do the same
            least, most = (max(end, 1e-9) for end in parameters["share"].ci95)
            ends = min(low, stiffness / most), max(high, stiffness / least)
            parameters = {"stiffness": Quantity(stiffness, f"{torque}/{position}", ends)}
    if TERMS[term].filled == "delay":
        parameters = {"delay": _quantity(*answer.own_delays[joint], "s")}
    if TERMS[term].filled == "ripple":
        order = float(found.equations.ripple[joint])
        reach = float(np.ptp(np.concatenate([q[:, joint] for q, _, _ in found.rows.motion])))
        parameters["order"] = Quantity(order, f"1/{position}", (order - np.pi / reach, order + np.pi / reach))
    return JointEffect(
        name=term,
        parameters=parameters,
        recurrence=evidence.recurrence,
        log_bayes_factor=evidence.log_bayes_factor,
        fall=evidence.fall,
        equation=EFFECTS[term].equation,
        indistinguishable_from=(*(one.split(": ")[1] for one in found.rivals.get(name, ())), *TERMS[term].alike),
        links_instead=list_links_instead(found.equations, others.own, found.prior, joint) if term == SPRING else (),
    )


def _unit_of(name: str, torque: str, position: str) -> str:
    if name.startswith("viscous"):
        return f"{torque}·s/{position}"
    if name.startswith("quadratic_drag"):
        return f"{torque}·s²/{position}²"
    if name.startswith("spring_torque"):
        return f"{torque}/{position}"
    if name.startswith("thermal_friction"):
        return f"{torque}·s/{position}/K" if ".viscous" in name else f"{torque}/K"
    if name.startswith("torque_delay"):
        return "s"
    if name.startswith(("backlash", "joint_elasticity", "load_coulomb", "torque_gain_error")):
        return "1"
    return f"1/{torque}" if name.startswith("load_quadratic") else torque


def _write_sentences(record: ArmRecord) -> tuple[str, ...]:
    named = [(joint.name, effect) for joint in record.joints for effect in joint.effects]
    off = [link for link in record.links if link.state == "off"]
    doubts = (*list_doubts(record), *say_unexplained(record))
    opening = (
        "The simulation leaves out physics in " + ", ".join(f"{joint} ({effect.name})" for joint, effect in named) + "."
        if named
        else doubts[0]
        if doubts
        else say_links(record.joints)
        if off
        else say_nothing_missing(record.joints)
    )
    return (
        opening,
        *(one for one in doubts if one != opening),
        *say_corrections(record),
        *say_shared_causes(record.joints),
        *say_offsets(record.joints),
        *say_unnamed(record.joints),
        *say_creep(record.joints),
        *(_say_joint(joint) for joint in record.joints),
        *say_lone_link(record.lone_link),
        *(say_link(link) for link in record.links if link.state == "off"),
        *say_stated(record.joints),
        *_say_undetermined(record),
        *(
            f"The gear of {joint.name} gives way by {show_quantity(joint.stiffness)}, as its two encoders show."
            for joint in record.joints
            if joint.stiffness is not None
        ),
        *(say_possible_spring(joint) for joint in record.joints if joint.possible_spring is not None),
        *_say_signal(record),
    )


def _say_joint(joint: JointRecord) -> str:
    errors = (
        f"{joint.name}: held-out torque error {joint.error_simulation:.3g} {joint.unit} by the simulation with Coulomb "
        f"and viscous friction, {joint.error_model:.3g} {joint.unit} by this model"
    )
    effects = "; ".join(_say_effect(effect) for effect in joint.effects)
    return f"{errors}. There, {effects}." if effects else f"{errors}."


def _say_effect(effect: JointEffect) -> str:
    numbers = ", ".join(f"{name.replace('_', ' ')} {show_quantity(one)}" for name, one in effect.parameters.items())
    names = (*effect.indistinguishable_from, *(f"{link} weighing something else" for link in effect.links_instead))
    alike = f", or {' or '.join(names)}" if names else ""
    return (
        f"{effect.name}{alike}: {say_what(effect)} [{effect.equation}]; {numbers}; it lowers the error by "
        f"{effect.fall:.0%} and comes again in {effect.recurrence:.0%} of the halves of the recording"
    )


def _say_undetermined(record: ArmRecord) -> tuple[str, ...]:
    names = [link.name for link in record.links if link.state == "not_determined"]
    if not names:
        return ()
    return (f"This motion does not determine the mass of {', '.join(names)}: the simulation's values are kept.",)


def _say_signal(record: ArmRecord) -> tuple[str, ...]:
    lines = []
    low, high = record.delay.ci95
    if record.delay.value and (low > 0.0 or high < 0.0):
        way = "late behind" if record.delay.value > 0.0 else "ahead of"
        own = [joint.name for joint in record.joints if any(one.name == "torque_delay" for one in joint.effects)]
        whose = f"The torques of all joints but {', '.join(own)}" if own else "All torques"
        lines.append(
            f"{whose} are {1e3 * abs(record.delay.value):.3g} ms {way} the positions "
            f"({1e3 * low:.3g} to {1e3 * high:.3g} ms); this was taken off."
        )
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
    if record.held_joints:
        lines.append(
            f"Held where the simulation has them, since nothing was recorded: {', '.join(record.held_joints)}."
        )
    return tuple(lines)
