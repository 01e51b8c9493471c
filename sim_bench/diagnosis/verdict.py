"""The verdict: what is named, what is not, and how it is said."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from msgspec.structs import replace as with_fields

from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .agreement import agreeing, hold
from .alias import aliases, distinguishability, told
from .as_given import fit_as_given
from .base import BASE_NAMES
from .comparison import (
    NAMED,
    PLAIN,
    UNEXPLAINED,
    Comparison,
    Doubt,
    GivenFriction,
    compare_friction,
    compare_rigid,
    friction_changes,
)
from .confirmation import confirm
from .effect_energy import effect_energy
from .experiment import propose
from .explanation import Explanation
from .extension import base_model, extended_model
from .gates import put_to_trial, stands_out, vibration
from .location import change_points, excess_maps, locate, row_series
from .order import order_spectrum
from .overtone import explained_by_overtone, overtones
from .preparation import Prepared
from .refitted import Refitted
from .result import (
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
)
from .rigid import RigidJoint, Spring
from .search import Found
from .sentence import NO_MOTION, detent_sentence, sentences
from .solver import Fit
from .spring import as_it_shows, spring_change
from .tone import Tone
from .track import FloatArray
from .velocity_lag import velocity_lag

__all__ = ["Answer", "conclude"]

_MOST_RIVALS = 3  # that a motion is looked for
_BODY_AND_CURVES = BASE_NAMES.index("log_breakaway")  # parameters before it are inertia, gravity, offset and curves


@dataclass(frozen=True)
class Answer:
    """Everything a verdict is drawn from."""

    recordings: tuple[Recording, ...]
    prepared: Prepared
    found: Found
    rigid: RigidJoint | None
    friction: FrictionModel | None
    seed: int

    @property
    def unit(self) -> str:
        """Unit of torque."""
        return self.recordings[0].metadata.torque_unit

    @property
    def spring(self) -> Spring | None:
        """Of the simulation."""
        return None if self.rigid is None else self.rigid.spring

    @property
    def position_unit(self) -> str:
        """Unit of position."""
        return self.recordings[0].metadata.position_unit


def conclude(answer: Answer) -> Diagnosis:
    """Draw the verdict and collect what supports it."""

    def differs(one: Explanation) -> bool:
        return bool(_compare(answer, Refitted.of(answer.prepared, one), PLAIN).effects)

    answer = replace(answer, found=agreeing(answer.prepared, answer.found, answer.rigid, differs))
    prepared, found = answer.prepared, answer.found
    best = found.best
    chosen, failed, held = put_to_trial(prepared, found, answer.seed)
    tone = vibration(prepared) if chosen is None else None
    unknown = chosen is None and (tone is not None or stands_out(found, prepared))
    refitted = Refitted.of(prepared, chosen)
    compared = _compare(answer, refitted, UNEXPLAINED if unknown else PLAIN if chosen is None else NAMED)
    given = None if unknown or chosen is not None else _as_given(answer, compared.effects)
    if held is None:
        held = confirm(prepared, prepared.structure, prepared.fit, answer.seed, given=given)
    series = _series(prepared, given or prepared.fit, refitted)
    named: list[NamedEffect] = []
    effects, location = list(compared.effects), Location()
    if chosen is not None:
        named, location = _explained(answer, chosen, refitted, held.explained, series)
        effects = _each_once(named, effects)
    elif unknown:
        location = _where_unknown(series, tone)
    elif given is not None:
        effects, location = _moved(answer, compared.effects, held.explained, series)
    effects = sorted([*effects, *velocity_lag(answer.recordings)], key=lambda effect: -effect.share)
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=_verdict(effects, unknown),  # type: ignore[arg-type]
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
        noise_ratio=prepared.noise_ratio,
        coverage=best.coverage if best is not None else None,
        base=refitted.base(answer.unit, answer.position_unit),
        changes=(*compared.changes, *spring_change(named, answer.spring)),
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
    if answer.rigid is not None and answer.rigid.rotary and not _compare(answer, refitted, PLAIN).effects:
        box = hold(box, answer.rigid)  # beside one that agrees, rivals are held to the simulation too
    proposal = propose(answer.prepared, chosen, list(rivals.values())[:_MOST_RIVALS], box)
    if proposal is None:
        return None
    why = f"{proposal.title}, where the explanations differ by {proposal.difference:.3g} {answer.unit} and more"
    return NextExperiment(motion="motion.csv", separates=proposal.separates, why=why), proposal.motion


def _series(prepared: Prepared, before: Fit, after: Refitted) -> tuple[RowSeries, ...]:
    """Rows of the base, as given or refitted, and of the joint that the verdict is about."""
    problem, weights = prepared.problem, prepared.nulls.weights
    runs = [problem.rows(prepared.structure.observe(problem, before.theta))]
    same = after.fit is before
    runs.append(runs[0] if same else problem.rows(after.structure.observe(problem, after.fit.theta)))
    corrected = [[r - m for r, m in zip(rows, weights.mean, strict=True)] for rows in runs]
    return row_series(prepared, corrected[0], corrected[1])


def _explained(
    answer: Answer, chosen: Explanation, refitted: Refitted, explained: float, series: tuple[RowSeries, ...]
) -> tuple[list[NamedEffect], Location]:
    """The effects that were chosen, and where they add most together."""
    energies = {name: _energy(answer, chosen, {name}) for name in chosen.names}
    whole = energies[chosen.names[0]] if len(energies) == 1 else _energy(answer, chosen, chosen.names)
    sums = {name: float(np.sum(np.concatenate(energy))) for name, energy in energies.items()}
    span = max(float(np.ptp(context.position)) for context in chosen.structure.contexts)

    def as_well(name: str, other: str, order: float) -> bool:
        return explained_by_overtone(answer.prepared, answer.found.explanations, chosen, name, other, order)

    forms = overtones(chosen, sums, span, as_well)
    effects = []
    for candidate in chosen.structure.candidates:
        effect = candidate.effect
        if effect.name in forms:
            continue
        tones = [order for other, order in forms.values() if other == effect.name]
        # Which of two laws draws a ripple and which its overtone is a matter of the fit.
        drawn = [name for name, (other, _) in forms.items() if other == effect.name]
        own = sums[effect.name] + sum(sums[name] for name in drawn)
        effects.append(
            as_it_shows(
                NamedEffect(
                    name=effect.name,
                    kind=effect.kind,
                    parameters=refitted.parameters(effect.name, answer.unit, answer.position_unit),
                    indistinguishable_from=tuple(dict.fromkeys([*aliases(answer.found, effect.name), *drawn])),
                    location=_located(answer, series, energies[effect.name]),
                    share=explained * own / max(sum(sums.values()), 1e-30),
                    equation=effect.equation,
                    sentence=effect.says + "".join(f"; its form shows at the order {tone:.4g} too" for tone in tones),
                    citation=effect.citation,
                ),
                answer.spring,
            )
        )
    return effects, _located(answer, series, whole)


def _each_once(named: Sequence[NamedEffect], compared: Sequence[NamedEffect]) -> list[NamedEffect]:
    """What was chosen, with what the comparison says under the same name, and the rest of the comparison.

    So it is with a load that differs between the recordings, and in the first of them from the simulation's.
    """
    rest = {one.name: one for one in compared}
    same = {one.name: rest.pop(one.name) for one in named if one.name in rest}
    joined = [
        with_fields(
            one,
            parameters=one.parameters | same[one.name].parameters,
            sentence=f"{one.sentence}; {same[one.name].sentence}",
        )
        if one.name in same
        else one
        for one in named
    ]
    return [*joined, *rest.values()]


def _compare(answer: Answer, refitted: Refitted, doubt: Doubt) -> Comparison:
    """What the refit moved of the given simulation and friction."""
    cov, plant = refitted.covariance[:_BODY_AND_CURVES, :_BODY_AND_CURVES], refitted.plant
    result = Comparison()
    rigid = answer.rigid if answer.rigid is not None and answer.rigid.rotary else None
    if rigid is not None and rigid.covariance is not None:
        cov = cov + rigid.covariance
    acceleration = float(np.sqrt(np.mean(np.concatenate([c.acceleration for c in refitted.structure.contexts]) ** 2)))
    if rigid is not None:
        result = compare_rigid(plant, cov[:3, :3], rigid, answer.unit, doubt, acceleration)
    if answer.friction is not None:
        held, offset = None if result.effects else rigid, 0.0 if answer.rigid is None else answer.rigid.offset
        given = GivenFriction(answer.friction, offset, held)
        more = compare_friction(plant, cov, given, answer.unit, doubt, acceleration)
        return Comparison(result.effects + more.effects, result.changes + more.changes)
    if answer.rigid is not None:
        units = (answer.unit, answer.position_unit)
        return replace(result, changes=result.changes + friction_changes(plant, cov, answer.rigid, units, doubt))
    return result


def _as_given(answer: Answer, effects: Sequence[NamedEffect]) -> Fit | None:
    return fit_as_given(answer.prepared, [one.name for one in effects], answer.rigid, answer.friction)


def _moved(
    answer: Answer, effects: Sequence[NamedEffect], explained: float, series: tuple[RowSeries, ...]
) -> tuple[list[NamedEffect], Location]:
    """Parameters that are off, with their shares of what putting them right explains, and where it shows."""
    energy = [np.maximum(one.before**2 - one.after**2, 0.0) / one.spread**2 for one in series]
    location = locate(series, energy, rows=5)
    parts = [1.0]
    if len(effects) > 1:
        alone = [_as_given(answer, [one]) for one in effects]
        parts = [1e-30 if one is None else max(one.cost - answer.prepared.fit.cost, 1e-30) for one in alone]
    return [
        with_fields(one, share=explained * part / sum(parts), location=location)
        for one, part in zip(effects, parts, strict=True)
    ], location


def _energy(answer: Answer, chosen: Explanation, names: Collection[str]) -> list[FloatArray]:
    return effect_energy(answer.prepared, chosen.structure, chosen.fit.theta, names)


def _located(answer: Answer, series: tuple[RowSeries, ...], energy: Sequence[FloatArray]) -> Location:
    """Where effects add most, of whose torque the energy of every sample is known."""
    prepared = answer.prepared
    rows = [one[grid.centres] for one, grid in zip(energy, prepared.problem.grids, strict=True)]
    return locate(series, rows, samples=(prepared.structure.contexts[0].time, energy[0]))


def _where_unknown(series: tuple[RowSeries, ...], tone: Tone | None) -> Location:
    """Where most of what exceeds the noise sits, and the frequency of a vibration."""
    location = locate(series, [np.maximum((one.before / one.spread) ** 2 - 1.0, 0.0) for one in series], rows=5)
    if tone is not None:
        location["frequency"] = [(tone.frequency - tone.width, tone.frequency + tone.width)]
    return location


def _verdict(effects: list[NamedEffect], unknown: bool) -> str:
    kinds = {effect.kind for effect in effects}
    if "physics" in kinds:
        return "missing_physics"
    if unknown:
        return "unknown_physics"
    if "measurement" in kinds:
        return "measurement"
    return "parameters" if kinds else "consistent"


def _rivals(found: Found, chosen: Explanation | None, failed: Explanation | None) -> tuple[Rival, ...]:
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
    spectrum = order_spectrum(prepared.problem, prepared.structure.contexts, prepared.fit.residual, prepared.basis)
    return Evidence(
        series=series,
        maps=excess_maps(series, answer.seed),
        orders={"order": spectrum.order, "energy": spectrum.energy},
        change_points=change_points(series),
    )
