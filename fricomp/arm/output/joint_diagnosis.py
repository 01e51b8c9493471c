"""The answer on one joint of an arm as the diagnosis of a single joint has it, for the same record and the same page.

The base model of a joint is that of the whole arm without what is named in this joint, fitted again: links and the
friction of all joints take over what they can. Rows are those of the arm's equations, each left out of its fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.evidence.location import locate, map_excess
from fricomp.diagnosis.evidence.settings import LOCATION
from fricomp.diagnosis.record.file_errors import FileErrors, ModelErrors
from fricomp.diagnosis.record.result import (
    DIAGNOSIS_SCHEMA,
    Change,
    Diagnosis,
    DiagnosisRecord,
    Evidence,
    HeldOut,
    Location,
    NamedEffect,
    Quantity,
    Rival,
    RowSeries,
    VerdictName,
)
from fricomp.diagnosis.record.sentence import Notes, write_record
from fricomp.diagnosis.samples.sample_finding import compute_held_out
from fricomp.diagnosis.search.generic import measure_time_since_reversal
from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from ..answer import ArmAnswer
from ..arm_recording import find_start_temperature
from ..confirmation import ConfirmedData
from ..examination import ArmExamination
from ..friction import TERMS
from ..friction_model import build_friction_model
from ..record import ArmRecord, JointEffect, JointRecord, LinkRecord
from ..rigid.inertia import N_INERTIA
from ..words.brief import is_unexplained, say_what
from .choice import WrittenFiles

_SEED = 0
"""Of bootstraps: bands of the maps, and the interval of the fall of an error."""


@dataclass(frozen=True)
class _LeftOut:
    """What two models leave of held-out rows in which the joint moves. Shapes (n,)."""

    before: FloatArray
    after: FloatArray
    noise: float


def diagnose_joints(examination: ArmExamination, written: WrittenFiles) -> list[Diagnosis]:
    """The diagnosis of each joint.

    Args:
        examination: The answer on the arm.
        written: The files, with what they are worth.
    """
    answer = examination.answer
    found = answer.identification
    data = ConfirmedData(found.fit.arm, found.equations, found.prior, found.rows)
    after = data.leave_out(found.fit.model, found.fit)
    return [_diagnose(examination, written, j, data, after) for j in range(len(found.fit.arm.joints))]


def _diagnose(
    examination: ArmExamination, written: WrittenFiles, joint: int, data: ConfirmedData, after: FloatArray
) -> Diagnosis:
    answer, record = examination.answer, examination.record.joints[joint]
    found = answer.identification
    names = answer.list_named(joint)
    less = data.leave_out(found.fit.model.without_terms(joint, *names), found.fit) if names else after
    used, noise = found.equations.moving[:, joint], float(found.equations.weights.noise[joint])
    left = _LeftOut(less[used, joint], after[used, joint], noise)
    series = _collect_rows(answer, joint, left)
    off = _list_links(examination.record, answer, joint)
    verdict = _judge(record, bool(off))
    held = _measure_held_out(left, record.unit, named=bool(names))
    fields = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=verdict,
        effects=_list_effects(answer, joint, record, series, held),
        errors=_list_errors(written, record.name),
        heldout=held,
        location=_locate(series, left.before**2 - left.after**2, noise) if names else {},
        noise_ratio=held.rmse_before / held.noise_floor if names else None,
        base=_list_base(record),
        changes=_list_changes(record, answer, joint, off),
        rivals=_list_rivals(answer, joint, record),
        probability={name: one.recurrence for (j, name), one in answer.evidence.items() if j == joint},
        recordings=(record.name,),
        joint=record.name,
    )
    model = build_friction_model(written.answer.identification, joint)
    return Diagnosis(
        write_record(fields, _write_notes(examination.record, record, verdict)),
        Evidence(series=(series,), maps=map_excess((series,), _SEED)),
        base_model=None if names else model,
        extended_model=model if names else None,
    )


def _judge(record: JointRecord, off: bool) -> VerdictName:
    kinds = {EFFECTS[one.name].kind for one in record.effects}
    if kinds:
        return "measurement" if kinds == {"measurement"} else "missing_physics"
    if is_unexplained(record):
        return "unknown_physics"
    return "parameters" if off else "consistent"


def _collect_rows(answer: ArmAnswer, joint: int, left: _LeftOut) -> RowSeries:
    """Rows in which the joint moves, with its state."""
    found = answer.identification
    rows, used = found.rows, found.equations.moving[:, joint]
    q, v, a = (rows.compare(lambda *motion, k=k: motion[k])[used, joint] for k in range(3))
    since = [
        measure_time_since_reversal(one[:, joint], part.period)
        for (_, one, _), part in zip(rows.motion, found.recording.parts, strict=True)
    ]
    times = np.concatenate([part.time for part in found.recording.parts])
    at = np.searchsorted(times, rows.time[used])
    recording = found.recording.recordings[joint]
    warm = None
    if recording.temperature is not None:
        warm = find_start_temperature(recording) + rows.compare_samples(rows.warmth)[used, joint]
    return RowSeries(
        name=recording.metadata.joint,
        time=rows.time[used],
        position=q,
        velocity=v,
        acceleration=a,
        load_torque=found.fit.compute_load(rows)[used, joint],
        time_since_reversal=np.concatenate(since)[np.minimum(at, len(times) - 1)],
        temperature=warm,
        before=left.before,
        after=left.after,
        spread=np.full(int(np.sum(used)), left.noise),
    )


def _locate(series: RowSeries, energy: FloatArray, noise: float) -> Location:
    """Where what is named shows."""
    return locate([series], [np.maximum(energy, 0.0) / noise**2], rows=LOCATION.neighbours)


def _measure_held_out(left: _LeftOut, unit: str, *, named: bool) -> HeldOut:
    """Errors without and with what is named; the noise is that of most rows, as the fit has it."""
    if named:
        return compute_held_out(left.before, left.after, left.noise, (unit, _SEED))
    error = compute_rms(left.after)
    return HeldOut(
        rmse_before=error,
        rmse_after=error,
        noise_floor=min(left.noise, error),
        unit=unit,
        ci95_reduction=(0.0, 0.0),
        explained=0.0,
    )


def _list_effects(
    answer: ArmAnswer, joint: int, record: JointRecord, series: RowSeries, held: HeldOut
) -> tuple[NamedEffect, ...]:
    energies = {one.name: _compute_energy(answer, joint, one.name) for one in record.effects}
    total = sum(float(np.sum(one)) for one in energies.values())
    return tuple(
        NamedEffect(
            name=one.name,
            kind=EFFECTS[one.name].kind,
            parameters=one.parameters,
            indistinguishable_from=one.indistinguishable_from,
            location=_locate(series, energies[one.name], float(series.spread[0])),
            share=float(np.clip(held.explained, 0.0, 1.0)) * float(np.sum(energies[one.name])) / max(total, 1e-300),
            equation=one.equation,
            sentence=say_what(one),
            citation=EFFECTS[one.name].citation,
        )
        for one in record.effects
    )


def _compute_energy(answer: ArmAnswer, joint: int, term: str) -> FloatArray:
    """Square of the torque of a term [(N·m)²], rows in which its joint moves. Shape (n,)."""
    fit, equations = answer.identification.fit, answer.identification.equations
    form, (place, names) = fit.model.forms[joint], fit.find_friction(joint)
    own = [name for name in names if name in TERMS[term].names(dict(form.terms)[term])]
    torque = equations.friction_of(joint, own) @ fit.x[[place.start + names.index(name) for name in own]]
    return np.asarray(torque[equations.moving[:, joint]] ** 2)


def _list_errors(written: WrittenFiles, name: str) -> FileErrors | None:
    """Errors of the files, before and after what is named; None where the recording was too short for them."""
    if written.held_out is None or written.whole is None:
        return None
    files = written.held_out.joint(name)
    before = written.without.get(name)
    own = ModelErrors(torque=files.torque, position=files.position)
    return FileErrors(
        before=own if before is None else ModelErrors(torque=before.torque, position=before.position),
        after=None if before is None else own,
        file=ModelErrors(torque=written.whole.joint(name).torque),
        folds=1,
    )


def _list_base(record: JointRecord) -> dict[str, Quantity]:
    """Rotor and friction beside what is named; a variant of a term is no part of its name."""
    friction = {name.rsplit(".", 1)[0] if "." in name else name: one for name, one in record.friction.items()}
    return {"rotor_inertia": record.rotor_inertia, **friction}


def _list_links(record: ArmRecord, answer: ArmAnswer, joint: int) -> list[LinkRecord]:
    """Links that are off and that the joint moves."""
    links = answer.identification.rows.links[:, joint]
    moved = [bool(np.any(links[:, N_INERTIA * i : N_INERTIA * (i + 1)])) for i in range(len(record.links))]
    return [one for one, seen in zip(record.links, moved, strict=True) if seen and one.state == "off"]


def _list_changes(record: JointRecord, answer: ArmAnswer, joint: int, off: Sequence[LinkRecord]) -> tuple[Change, ...]:
    """Rotor and links that this joint feels, where their intervals do not hold what the simulation has."""
    given = float(answer.identification.fit.arm.armature[joint])
    low, high = record.rotor_inertia.ci95
    rotor = [] if low <= given <= high else [Change(name="rotor_inertia", given=given, refitted=record.rotor_inertia)]
    links = [Change(name=f"mass of {one.name}", given=one.simulated_mass, refitted=one.mass) for one in off]
    return (*rotor, *(one for one in links if not one.refitted.ci95[0] <= one.given <= one.refitted.ci95[1]))


def _list_rivals(answer: ArmAnswer, joint: int, record: JointRecord) -> tuple[Rival, ...]:
    """What was tried in the joint, with why it is not named; twice the logarithm of a Bayes factor is its gain."""
    named = {one.name: one for one in record.effects}
    head = f"{record.name}: "
    tried = {
        name.removeprefix(head): gain
        for name, gain in answer.identification.trials.items()
        if name.startswith(head) and name.removeprefix(head) in EFFECTS
    }
    rivals = [
        Rival(effects=(name,), gain=2.0 * gain, refused=_say_why_not(answer, joint, name, named))
        for name, gain in tried.items()
    ]
    return tuple(sorted(rivals, key=lambda one: (bool(one.refused), -one.gain)))


def _say_why_not(answer: ArmAnswer, joint: int, name: str, named: dict[str, JointEffect]) -> str:
    """Why something that was tried is not named; empty for what is."""
    if name in named:
        return ""
    if (joint, name) not in answer.evidence:
        return (
            "it makes the recording hardly more probable than the model without it, or is not found in enough of its "
            "halves"
        )
    head = answer.identification.fit.model.forms[joint].find_head(name)
    return f"stays in the model, and {f'mends the form of {head}' if head != name else answer.find_lack(joint, name)}"


def _write_notes(arm: ArmRecord, record: JointRecord, verdict: VerdictName) -> Notes:
    """What is said of a joint of an arm in other words than of a joint alone."""
    openings = {
        "consistent": "Nothing is missing in this joint: links, rotor and plain friction explain its torque.",
        "parameters": "No physics is missing in this joint; links that it moves weigh something else than simulated.",
    }
    whole = f"One of {len(arm.joints)} joints that were fitted together; links stand in the report of the arm."
    files = tuple(one for one in arm.sentences if one.startswith(f"{record.name}: the files"))
    return Notes(opening=openings.get(verdict, ""), remarks=(whole, *files))
