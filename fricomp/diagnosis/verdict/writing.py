"""The last stage: the diagnosis, written once from the evidence, the verdict and what was simulated with it."""

from __future__ import annotations

from collections.abc import Sequence

from ..delivery.models import Delivery
from ..evidence.findings import Findings
from ..evidence.location import map_excess
from ..evidence.undetermined import list_undetermined
from ..inputs.given import Given
from ..joint.base import BASE_NAMES
from ..record.result import (
    DIAGNOSIS_SCHEMA,
    Diagnosis,
    DiagnosisRecord,
    Evidence,
    Forward,
    NamedEffect,
    NextExperiment,
)
from ..record.sentence import (
    FOREIGN_CURVE,
    LAWLESS,
    LITTLE_LEFT,
    NO_MOTION,
    NOTHING_BUT_SHARED,
    WITHOUT_SIMULATION,
    Notes,
    describe_detent,
    describe_rest,
    describe_trace,
    write_record,
)
from .experiment import Proposal
from .judging import Verdict, choose_verdict
from .probability import compute_probability, list_probabilities


def write_diagnosis(
    findings: Findings,
    verdict: Verdict,
    delivery: Delivery | None,
    proposal: Proposal | None = None,
    forward: Forward | None = None,
    remarks: Sequence[str] = (),
) -> Diagnosis:
    """Write the record with its sentences, and beside it the curves and models.

    Args:
        findings: Evidence from the rows.
        verdict: What was judged of it.
        delivery: The models that are handed over with it; None where there are none.
        proposal: The motion that would tell rivals apart; None where none is proposed.
        forward: Errors of a forward simulation; None where there was none.
        remarks: What the checks of the data noticed.
    """
    case, sample = findings.case, verdict.sample
    lawless = sample is not None and sample.lawless
    looked = () if delivery is None else delivery.remarks
    fields = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=verdict.word,
        effects=verdict.effects,
        errors=None if delivery is None else delivery.errors,
        heldout=verdict.held,
        forward=forward,
        location=verdict.location,
        next_experiment=None if proposal is None else _describe_experiment(proposal, case.unit),
        noise_ratio=verdict.noise_ratio,
        coverage=verdict.coverage,
        base={} if lawless else findings.base,
        undetermined=() if lawless else list_undetermined(findings.refitted, (case.unit, case.position_unit)),
        changes=verdict.changes,
        rivals=verdict.rivals,
        probability=list_probabilities(findings, verdict.effects, sample, verdict.read_off),
        distinguishability=findings.told_apart,
        recordings=tuple(rows.name for rows in findings.series),
        joint=case.recordings[0].metadata.joint,
    )
    record = write_record(fields, _collect_notes(findings, verdict, proposal, (*remarks, *looked)))
    covariance = findings.refitted.covariance[: len(BASE_NAMES), : len(BASE_NAMES)]
    return Diagnosis(
        record=record,
        evidence=_collect_evidence(findings, verdict, delivery),
        base_model=None if delivery is None else delivery.base,
        extended_model=None if delivery is None else delivery.extended,
        motion=None if proposal is None else proposal.motion,
        detent_order=findings.detent_order if sample is None else None,
        covariance=covariance if sample is None else None,
        folds=() if delivery is None else delivery.folds,
        fold_times=() if delivery is None else delivery.times,
        recorded=None if delivery is None else delivery.motion,
    )


def _collect_evidence(findings: Findings, verdict: Verdict, delivery: Delivery | None) -> Evidence:
    """What the pictures are drawn from: of the samples, where they gave the answer, else of the rows."""
    sample, files = verdict.sample, () if delivery is None else delivery.series
    if sample is None:
        return Evidence(findings.series, findings.maps, findings.orders, findings.change_points, files)
    return Evidence(sample.series, map_excess(sample.series, findings.case.bands), sample.orders, files=files)


def write_refusal(given: Given, reasons: Sequence[str], remarks: Sequence[str] = ()) -> Diagnosis:
    """Write why data cannot be diagnosed.

    Args:
        given: The data.
        reasons: What speaks against them, in sentences.
        remarks: What else is to be told.
    """
    fields = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict="bad_data",
        recordings=given.names,
        joint=given.recordings[0].metadata.joint,
    )
    return Diagnosis(write_record(fields, Notes(facts=tuple(reasons), remarks=tuple(remarks))))


def write_read_off(
    given: Given, effects: Sequence[NamedEffect], facts: Sequence[str], remarks: Sequence[str] = ()
) -> Diagnosis:
    """Write what two channels show of each other, where the motion allows no joint model.

    Args:
        given: The data.
        effects: What the channels show.
        facts: Why there is no joint model, in sentences.
        remarks: What else is to be told.
    """
    fields = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=choose_verdict({one.kind for one in effects}),
        effects=tuple(effects),
        probability={one.name: compute_probability(1.0) for one in effects},
        recordings=given.names,
        joint=given.recordings[0].metadata.joint,
    )
    return Diagnosis(
        write_record(fields, Notes(facts=tuple(f"Careful: {one}" for one in facts), remarks=tuple(remarks)))
    )


def _describe_experiment(proposal: Proposal, unit: str) -> NextExperiment:
    why = f"{proposal.title}, where the explanations differ by {proposal.difference:.3g} {unit} and more"
    return NextExperiment(motion="motion.csv", separates=proposal.separates, why=why)


def _collect_notes(findings: Findings, verdict: Verdict, proposal: Proposal | None, remarks: Sequence[str]) -> Notes:
    """What the sentences say that no field of the record holds."""
    opening, lead, facts = "", [], []
    if verdict.word == "consistent" and verdict.shared.all_shared:
        opening = NOTHING_BUT_SHARED
    elif verdict.sample is not None and verdict.sample.lawless:
        opening = LAWLESS
    elif findings.case.rigid is None and findings.case.friction is None:
        opening = WITHOUT_SIMULATION.get(verdict.word, "")
    if verdict.undecided and proposal is None:
        facts.append(NO_MOTION)
    if verdict.sample is None or verdict.sample.waves:
        facts += [f"{name} is not named: {why}." for name, why in findings.trial.objections.items()]
    if verdict.sample is not None and verdict.sample.waves and findings.unknown:
        facts.append(describe_rest(findings.noise_ratio))
    if verdict.sample is None and findings.left_aside is not None:
        opening = opening or (LITTLE_LEFT if verdict.word == "consistent" else "")
        lead.append(describe_trace(*findings.left_aside, findings.case.unit))
    if verdict.sample is None and findings.foreign_curve:
        facts.append(f"{FOREIGN_CURVE[0].upper()}{FOREIGN_CURVE[1:]}.")
    if verdict.sample is None and findings.detent_order is not None:
        facts.append(describe_detent(findings.detent_order, findings.case.position_unit))
    return Notes(opening=opening, lead=tuple(lead), facts=tuple(facts), remarks=(*remarks, *verdict.shared.told))
