"""The answer on an arm as a record, and in words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.record.result import Quantity

from .answer import ArmAnswer, TermEvidence
from .comparison.delays import list_apart, list_mistimed
from .comparison.elasticity import measure_stiffness
from .comparison.links import describe_link, measure_link_change
from .comparison.lone_link import find_lone_link
from .comparison.stated import list_stated
from .comparison.torque_scale import find_own_scale, scale_quantities, scale_quantity
from .fit import Z95, ArmFit
from .friction import CREEP, GEARS, TERMS, JointForm
from .friction_model import find_creep_velocity
from .identification import ArmIdentification
from .record import ARM_SCHEMA, ArmRecord, JointEffect, JointRecord
from .rigid.inertia import N_INERTIA
from .search.frames import find_better_frames, find_torque_scales
from .search.gear import GearSearch
from .search.gear_motion import GearMotion
from .uncertainty.alternatives import SPRING, Alternatives, find_alternatives, list_links_instead
from .uncertainty.averaging import average_friction, average_links
from .words.brief import (
    list_doubts,
    say_creep,
    say_offsets,
    say_possible_spring,
    say_shared_causes,
    say_unexplained,
    say_unnamed,
    say_what,
    write_summary,
)
from .words.corrections import say_corrections, say_scaled
from .words.links import say_link, say_lone_link
from .words.opening import write_opening
from .words.quantity import show_quantity
from .words.signal import say_mistimed, say_signal
from .words.stated import say_stated

_UNEVEN = (
    "The stamps are not the instants at which rows were sampled: how far the joints came, over their velocities, says "
    "that states of even periods were read, some twice and some never; rows count where they were sampled."
)


def write_record(answer: ArmAnswer) -> ArmRecord:
    """Everything that is said of an arm, in one value."""
    found, arm = answer.identification, answer.identification.fit.arm
    averages = average_friction(found.equations, found.fit, found.prior)
    others = find_alternatives(found.equations, found.fit, found.prior)
    mistimed = {arm.joints[j]: _quantity(*time, "s") for j, time in list_mistimed(found).items()}
    joints = tuple(
        replace(one, link_delay=mistimed.get(one.name))
        for one in (_describe_joint(answer, j, averages[j], others) for j in range(len(arm.joints)))
    )
    intervals = average_links(found.fit, others)
    links = tuple(describe_link(found, i, intervals[i], others.list_instead(i)) for i in range(len(arm.links)))
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
        period=found.recording.period,
        held_joints=tuple(name for name in arm.held if name not in found.recording.still),
        still_joints=found.recording.still,
        unknown_joints=found.recording.strangers,
        one_way=found.recording.one_way,
        in_order=arm.in_order,
        turned_torques=found.recording.turned,
        degrees=found.recording.degrees,
        unwrapped=found.recording.unwrapped,
        better_frames=() if arm.remounted else find_better_frames(arm, found.recording),
        frames_instead=found.recording.frames_instead,
        torque_scales=find_torque_scales(arm, found.recording, found.fit.inertia),
        guided=found.recording.guided_from_start,
        lone_link=find_lone_link(found),
    )
    held = found.recording.held
    rate = f"Most rows of {', '.join(held)} repeat the one before; they were left out." if held else ""
    stamps = _UNEVEN if found.recording.placed else ""
    apart = _say_apart(list_apart(found), arm.joints)
    sentences = (*_write_sentences(record), *(one for one in (rate, stamps, apart) if one))
    return replace(record, summary=write_summary(record, sentences[0]), sentences=sentences)


def _say_apart(delays: Mapping[int, float], joints: Sequence[str]) -> str:
    """That the torques of joints are not late by the same time, where they are not."""
    if not delays:
        return ""
    first, last = (pick(delays, key=delays.__getitem__) for pick in (min, max))
    ends = (f"{1e3 * delays[j]:.3g} ms by {joints[j]}" for j in (first, last))
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
    values = scale_quantities(fit, joint, values)
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
        rotor_inertia=scale_quantity(_quantity(float(fit.armature[joint]), rotor, inertia), find_own_scale(fit, joint)),
        error_simulation=float(answer.errors.simulation[joint]),
        error_plain=float(answer.errors.plain[joint]),
        error_model=float(answer.errors.model[joint]),
        unexplained=answer.measure_unexplained(joint),
        stiffness=measure_stiffness(found, joint),
        creep_velocity=find_creep_velocity(found, joint) if _creeps(form, values) else None,
        possible_spring=None if spring is None else _quantity(*spring, f"{torque}/{position}"),
        link_change=measure_link_change(found, joint),
        stated=list_stated(fit.arm, joint),
        unnamed=answer.list_unnamed(joint),
    )


def _creeps(form: JointForm, values: Mapping[str, Quantity]) -> bool:
    """Whether all dry friction of a joint creeps. Where a part of it seems to, its joint sticks for a moment at
    reversals."""
    if CREEP not in form.names:
        return False
    low, high = values[TERMS[CREEP].names(dict(form.terms)[CREEP])[0]].ci95
    return low <= values["coulomb"].value <= high


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
        search, of_joint = GearSearch(GearMotion(found.rows, found.fit), filled), (found.equations, found.fit, joint)
        low, high = search.bound(*of_joint)
        if filled == "gap":
            parameters = {"gap": Quantity(width, position, (low, high))}
        else:
            value, ends = stiffness, (low, high)
            if not search.is_told_by_swing(*of_joint):  # a stiffer gear with a larger factor would do the same
                share = parameters["share"]
                least, most = (max(end, 1e-9) for end in share.ci95)
                value = stiffness / share.value
                ends = min(low, stiffness / most, value), max(high, stiffness / least, value)
            parameters = {"stiffness": Quantity(value, f"{torque}/{position}", ends)}
    if term == SPRING:
        parameters["rest_position"] = _find_rest(found, joint, parameters["stiffness"], values["offset"])
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


def _find_rest(found: ArmIdentification, joint: int, stiffness: Quantity, offset: Quantity) -> Quantity:
    """Where a spring pulls nothing: its column is that from the middle of the motion, and the rest is a constant."""
    middle = float(np.mean(np.concatenate([q[:, joint] for q, _, _ in found.rows.motion])))
    away = offset.value / stiffness.value
    parts = [(one.ci95[1] - one.ci95[0]) / (2.0 * one.value) for one in (offset, stiffness)]
    spread = abs(away) * math.hypot(*parts)
    unit = found.recording.metadata[joint].position_unit
    return Quantity(middle - away, unit, (middle - away - spread, middle - away + spread))


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
    opening = write_opening(record)
    return (
        opening,
        *(one for one in (*list_doubts(record), *say_unexplained(record)) if one != opening),
        *say_corrections(record),
        *(one for one in say_mistimed(record.joints) if one != opening),
        *say_shared_causes(record.joints),
        *say_offsets(record.joints),
        *say_unnamed(record.joints),
        *say_creep(record.joints),
        *(_say_effect(joint.name, effect) for joint in record.joints for effect in joint.effects),
        *say_scaled(record.joints),
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
        *say_signal(record),
    )


def _say_effect(joint: str, effect: JointEffect) -> str:
    numbers = ", ".join(f"{name.replace('_', ' ')} {show_quantity(one)}" for name, one in effect.parameters.items())
    names = (*effect.indistinguishable_from, *(f"{link} weighing something else" for link in effect.links_instead))
    alike = f", or {' or '.join(names)}" if names else ""
    return (
        f"{joint}, {effect.name}{alike}: {say_what(effect)} [{effect.equation}]; {numbers}; it lowers the error by "
        f"{effect.fall:.0%} and comes again in {effect.recurrence:.0%} of the halves of the recording."
    )


def _say_undetermined(record: ArmRecord) -> tuple[str, ...]:
    names = [link.name for link in record.links if link.state == "not_determined"]
    if not names:
        return ()
    return (f"This motion does not determine the mass of {', '.join(names)}: the simulation's values are kept.",)
