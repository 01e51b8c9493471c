"""The verdict: what is named, what is not, and how it is said."""

from __future__ import annotations

from dataclasses import replace

from msgspec.structs import replace as with_fields

from ..effects.spring import compare_spring
from ..evidence.agreement import agreeing, hold
from ..evidence.alias import distinguishability, told
from ..evidence.answer import Answer, compare_given, fit_given, moved_parameters
from ..evidence.comparison import AGREES, PLAIN, UNEXPLAINED, Doubt, beside
from ..evidence.confirmation import Confirmation, confirm
from ..evidence.gates import put_to_trial, stands_out, vibration
from ..evidence.in_place import beside_moved, in_place
from ..evidence.location import change_points, excess_maps, row_series
from ..evidence.refitted import Refitted
from ..inputs.track import FloatArray
from ..joint.base import BASE_NAMES
from ..joint.solver import Fit
from ..record.result import (
    DIAGNOSIS_SCHEMA,
    Diagnosis,
    DiagnosisRecord,
    Evidence,
    HeldOut,
    Location,
    NamedEffect,
    NextExperiment,
    Rival,
    RowSeries,
    verdict_of,
)
from ..record.sentence import FOREIGN_CURVE, NO_MOTION, detent_sentence, sentences
from ..search.explanation import Explanation
from ..search.order import compute_order_spectrum
from ..search.preparation import Baseline
from ..search.search import SearchResult
from .experiment import propose
from .extension import base_model, extended_model
from .naming import each_once, name_effects, where_unknown
from .velocity_lag import velocity_lag

__all__ = ["agreed", "conclude"]

_MOST_RIVALS = 3  # that a motion is looked for


def agreed(answer: Answer) -> Answer:
    """The answer with a best explanation that agrees with the simulation, where one fits as well."""

    def differs(one: Explanation, doubt: Doubt) -> bool:
        return bool(compare_given(answer, Refitted.of(answer.prepared, one), doubt).effects)

    return in_place(replace(answer, found=agreeing(answer.prepared, answer.found, answer.rigid, differs)))


def conclude(answer: Answer) -> Diagnosis:
    """Draw the verdict from an agreed answer and collect what supports it."""
    prepared, found = answer.prepared, answer.found
    best = found.best
    chosen, failed, held = put_to_trial(prepared, found, answer.seed)
    tone = vibration(prepared) if chosen is None else None
    unknown = chosen is None and (tone is not None or stands_out(found, prepared))
    refitted = Refitted.of(prepared, chosen)
    doubt = UNEXPLAINED if unknown else PLAIN
    if chosen is not None and held is not None:
        doubt = beside(_loudness(prepared, held, chosen))
    compared = compare_given(answer, refitted, doubt)
    given = None if unknown or chosen is not None else fit_given(answer, compared.effects)
    before = given or prepared.fit if chosen is None or chosen.before is None else chosen.before
    if held is None:
        held = confirm(prepared, prepared.structure, prepared.fit, answer.seed, given=given)
    series = _series(prepared, before, refitted)
    named: list[NamedEffect] = []
    # What is unknown bends the parameters of the joint with it, so that none of them is known to be off.
    effects, location = [] if unknown else list(beside_moved(answer, compared.effects)), Location()
    if chosen is not None:
        named, location = name_effects(answer, chosen, refitted, held.explained, series)
        effects = each_once(named, effects)
    elif unknown:
        location = where_unknown(series, tone)
    elif given is not None:
        effects, location = moved_parameters(answer, effects, held.explained, series)
    effects = sorted([*effects, *velocity_lag(answer.recordings)], key=lambda effect: -effect.share)
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=verdict_of({effect.kind for effect in effects}, unknown=unknown),
        effects=tuple(effects),
        sentences=(),
        heldout=HeldOut(
            rmse_before=held.rmse_before,
            rmse_after=held.rmse_after,
            noise_floor=held.noise_floor,
            unit=answer.unit,
            ci95_reduction=held.ci95_reduction,
            explained=held.explained,
            before="refitted" if given is None else "given",
        ),
        location=location,
        noise_ratio=_loudness(prepared, held, chosen),
        coverage=best.coverage if best is not None else None,
        base=refitted.base(answer.unit, answer.position_unit),
        changes=(*compared.changes, *compare_spring(named, answer.spring)),
        rivals=_rivals(found, chosen, failed),
        distinguishability=distinguishability(prepared, found.first),
        recordings=tuple(track.name for track in prepared.problem.tracks),
        joint=answer.recordings[0].metadata.joint,
    )
    proposal = _propose(answer, chosen, refitted)
    if proposal is not None:
        record = with_fields(record, next_experiment=proposal[0])
    detent = best.common_order if unknown and best is not None else None
    said = sentences(record)
    if proposal is None and any(effect.indistinguishable_from for effect in named):
        said = (*said, NO_MOTION)
    if unknown and best is not None and best.foreign_curve:
        said = (*said, f"{FOREIGN_CURVE[0].upper()}{FOREIGN_CURVE[1:]}.")
    if detent is not None:
        said = (*said, detent_sentence(detent, answer.position_unit))
    record = with_fields(record, sentences=said)
    return Diagnosis(
        record=record,
        evidence=_evidence(answer, series),
        base_model=base_model(answer.recordings, prepared),
        extended_model=extended_model(answer.recordings, prepared, chosen, answer.spring),
        motion=proposal[1] if proposal is not None else None,
        detent_order=detent,
        covariance=refitted.covariance[: len(BASE_NAMES), : len(BASE_NAMES)],
    )


def _loudness(prepared: Baseline, held: Confirmation, chosen: Explanation | None) -> float:
    """Residual of the base over its noise; what was named may have been taken for a part of that."""
    ratio = prepared.noise_ratio
    return ratio if chosen is None else max(ratio, held.rmse_before / held.noise_floor)


def _propose(
    answer: Answer, chosen: Explanation | None, refitted: Refitted
) -> tuple[NextExperiment, dict[str, FloatArray]] | None:
    """The motion that tells what was named from what fits as well."""
    rivals: dict[tuple[str, ...], Explanation] = {}
    for rival in told(answer.found):  # best first, one of each set of effects
        rivals.setdefault(rival.names, rival)
    if chosen is None or not rivals:
        return None
    box = answer.prepared.box
    if answer.rigid is not None and answer.rigid.rotary and not compare_given(answer, refitted, AGREES).effects:
        box = hold(box, answer.rigid)  # beside one that agrees, rivals are held to the simulation too
    proposal = propose(answer.prepared, chosen, list(rivals.values())[:_MOST_RIVALS], box)
    if proposal is None:
        return None
    why = f"{proposal.title}, where the explanations differ by {proposal.difference:.3g} {answer.unit} and more"
    return NextExperiment(motion="motion.csv", separates=proposal.separates, why=why), proposal.motion


def _series(prepared: Baseline, before: Fit, after: Refitted) -> tuple[RowSeries, ...]:
    """Rows of the base, as given or refitted, and of the joint that the verdict is about."""
    problem, weights = prepared.problem, prepared.nulls.weights
    runs = [problem.compute_rows(prepared.structure.observe(problem, before.theta))]
    same = after.fit is before
    runs.append(runs[0] if same else problem.compute_rows(after.structure.observe(problem, after.fit.theta)))
    corrected = [[r - m for r, m in zip(rows, weights.mean, strict=True)] for rows in runs]
    return row_series(prepared, corrected[0], corrected[1])


def _rivals(found: SearchResult, chosen: Explanation | None, failed: Explanation | None) -> tuple[Rival, ...]:
    rivals = []
    listed = found.explanations[:12]
    if chosen is not None and chosen not in listed:
        listed = (*listed, chosen)
    for explanation in listed:
        why = explanation.refused
        if not why and explanation.certain <= found.threshold:
            why = "does not exceed what a recording with nothing missing gives"
        elif not why and explanation.common_order is not None:
            why = "ripple of torque and of friction at one order come from one part, such as a detent"
        elif not why and explanation.foreign_curve:
            why = FOREIGN_CURVE
        elif not why and explanation is failed:
            why = "does not make the held-out error fall for sure"
        elif not why and chosen is not None and explanation is not chosen:
            why = "another explanation is better or simpler"
        elif not why and chosen is None:
            why = "leaves too much unexplained"
        rivals.append(
            Rival(effects=explanation.names, gain=explanation.gain, coverage=explanation.coverage, refused=why)
        )
    return tuple(rivals)


def _evidence(answer: Answer, series: tuple[RowSeries, ...]) -> Evidence:
    prepared = answer.prepared
    spectrum = compute_order_spectrum(
        prepared.problem, prepared.structure.contexts, prepared.fit.residual, prepared.basis
    )
    return Evidence(
        series=series,
        maps=excess_maps(series, answer.seed),
        orders={"order": spectrum.order, "energy": spectrum.energy},
        change_points=change_points(series),
    )
