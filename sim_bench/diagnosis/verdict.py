"""The verdict: what is named, what is not, and how it is said."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from msgspec.structs import replace as with_fields

from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .agreement import agreeing
from .alias import aliases, distinguishability
from .base import BASE_NAMES
from .comparison import NAMED, PLAIN, SPLIT, UNEXPLAINED, Comparison, Doubt, compare_friction, compare_rigid
from .confirmation import Confirmation, confirm, covariance
from .effect_energy import effect_energy
from .experiment import propose
from .explanation import Explanation
from .extension import base_model, extended_model
from .gates import confirmed, covers, stands_out, vibration
from .location import change_points, excess_maps, locate, row_series
from .order import order_spectrum
from .overtone import overtones
from .preparation import Prepared
from .result import (
    DIAGNOSIS_SCHEMA,
    Diagnosis,
    DiagnosisRecord,
    Evidence,
    HeldOut,
    Location,
    NamedEffect,
    NextExperiment,
    Quantity,
    Rival,
    RowSeries,
)
from .rigid import RigidJoint
from .search import Found
from .sentence import detent_sentence, sentences
from .structure import N_BASE
from .track import FloatArray
from .velocity_lag import velocity_lag

__all__ = ["Answer", "conclude"]

_SPLIT_BY_PRESLIDING = ("offset", "forward.coulomb_torque", "reverse.coulomb_torque")


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
    def position_unit(self) -> str:
        """Unit of position."""
        return self.recordings[0].metadata.position_unit


def conclude(answer: Answer) -> Diagnosis:
    """Draw the verdict and collect what supports it."""
    agreed = agreeing(
        answer.prepared, answer.found, answer.rigid, lambda one: bool(_compare(answer, one, PLAIN).effects)
    )
    answer = replace(answer, found=agreed)
    prepared, found = answer.prepared, answer.found
    best = found.best
    chosen = best if best is not None and covers(best, found, prepared) and best.common_order is None else None
    held, failed = _confirm(answer, chosen), None
    if chosen is not None and not confirmed(held, chosen, found.threshold):
        failed, chosen = chosen, None
        held = _confirm(answer, None)
    tone = vibration(prepared) if chosen is None else None
    unknown = chosen is None and (tone is not None or stands_out(found, prepared))
    series = _series(answer, chosen)
    effects = _effects(answer, chosen, held, series)
    compared = _compare(answer, chosen, UNEXPLAINED if unknown else PLAIN if chosen is None else NAMED)
    effects = [*effects, *compared.effects, *velocity_lag(answer.recordings)]
    effects.sort(key=lambda effect: -effect.share)
    verdict = _verdict(effects, unknown)
    location = _location(answer, series, chosen, unknown)
    if tone is not None:
        location = {**location, "frequency": [(tone.frequency - tone.width, tone.frequency + tone.width)]}
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=verdict,  # type: ignore[arg-type]
        effects=tuple(effects),
        sentences=(),
        heldout=HeldOut(
            rmse_before=held.rmse_before,
            rmse_after=held.rmse_after,
            noise_floor=held.noise_floor,
            unit=answer.unit,
            ci95_reduction=held.ci95_reduction,
            explained=held.explained,
        ),
        location=location,
        noise_ratio=prepared.noise_ratio,
        coverage=best.coverage if best is not None else None,
        base=_base(answer, chosen),
        changes=compared.changes,
        rivals=_rivals(found, chosen, failed),
        distinguishability=distinguishability(prepared, found.first),
        recordings=tuple(track.name for track in prepared.problem.tracks),
        joint=answer.recordings[0].metadata.joint,
    )
    proposal = _propose(answer, chosen)
    if proposal is not None:
        record = with_fields(record, next_experiment=proposal[0])
    detent = best.common_order if unknown and best is not None else None
    said = sentences(record)
    if detent is not None:
        said = (*said, detent_sentence(detent, answer.position_unit))
    record = with_fields(record, sentences=said)
    return Diagnosis(
        record=record,
        evidence=_evidence(answer, series),
        base_model=base_model(answer.recordings, prepared),
        extended_model=extended_model(answer.recordings, prepared, chosen),
        motion=proposal[1] if proposal is not None else None,
        detent_order=detent,
    )


def _propose(answer: Answer, chosen: Explanation | None) -> tuple[NextExperiment, dict[str, FloatArray]] | None:
    """The motion that tells the strongest named effect from the alias that fits best."""
    if chosen is None:
        return None
    for explanation in answer.found.explanations:
        swapped = set(explanation.names) ^ set(chosen.names)
        known = {alias for name in chosen.names for alias in aliases(answer.found, name)}
        if explanation is chosen or len(explanation.names) != len(chosen.names) or not swapped & known:
            continue
        proposal = propose(answer.prepared, chosen, explanation)
        if proposal is None:
            return None
        why = f"{proposal.title}, where the two explanations differ by {proposal.difference:.3g} {answer.unit}"
        names = tuple(sorted(swapped))
        return NextExperiment(motion="motion.csv", separates=names, why=why), proposal.motion
    return None


def _confirm(answer: Answer, chosen: Explanation | None) -> Confirmation:
    prepared = answer.prepared
    if chosen is None:
        return confirm(prepared, prepared.structure, prepared.fit.theta, prepared.fit.jacobian, answer.seed)
    return confirm(prepared, chosen.structure, chosen.fit.theta, chosen.fit.jacobian, answer.seed)


def _series(answer: Answer, chosen: Explanation | None) -> tuple[RowSeries, ...]:
    prepared = answer.prepared
    problem, weights = prepared.problem, prepared.nulls.weights
    before = problem.rows(prepared.structure.observe(problem, prepared.fit.theta))
    after = before if chosen is None else problem.rows(chosen.structure.observe(problem, chosen.fit.theta))
    corrected = [[r - m for r, m in zip(rows, weights.mean, strict=True)] for rows in (before, after)]
    return row_series(prepared, corrected[0], corrected[1])


def _effects(
    answer: Answer, chosen: Explanation | None, held: Confirmation, series: tuple[RowSeries, ...]
) -> list[NamedEffect]:
    if chosen is None:
        return []
    box = answer.prepared.box.joined(chosen.structure.box())
    deviations = np.sqrt(np.maximum(np.diag(covariance(chosen.fit, box)), 0.0))[N_BASE:]
    energies = {name: _energy(answer, chosen, {name}) for name in chosen.names}
    sums = {name: float(np.sum(np.concatenate(energy))) for name, energy in energies.items()}
    span = max(float(np.ptp(context.position)) for context in chosen.structure.contexts)
    forms = overtones(chosen, sums, span)
    effects = []
    for candidate in chosen.structure.candidates:
        effect, energy = candidate.effect, energies[candidate.name]
        if effect.name in forms:
            continue
        tones = [order for other, order in forms.values() if other == effect.name]
        own = sums[effect.name] + sum(sums[name] for name, (other, _) in forms.items() if other == effect.name)
        share = held.explained * own / max(sum(sums.values()), 1e-30)
        effects.append(
            NamedEffect(
                name=effect.name,
                kind=effect.kind,
                parameters=_quantities(answer, chosen, candidate.name, deviations),
                indistinguishable_from=aliases(answer.found, effect.name),
                location=locate(series, energy),
                share=share,
                equation=effect.equation,
                sentence=effect.says + "".join(f"; its form shows at the order {tone:.4g} too" for tone in tones),
                citation=effect.citation,
            )
        )
    return effects


def _quantities(answer: Answer, chosen: Explanation, name: str, deviations: FloatArray) -> dict[str, Quantity]:
    result = {}
    vector = chosen.fit.theta[N_BASE:]
    for (owner, parameter), value, deviation in zip(chosen.structure.parameters(), vector, deviations, strict=True):
        if owner != name:
            continue
        unit = parameter.unit.replace("{torque}", answer.unit).replace("{position}", answer.position_unit)
        half = 1.96 * float(np.hypot(deviation, parameter.deviation_of_form(float(value))))
        half = half if parameter.scale > 0.0 else 0.0
        low, mid, high = float(value) - half, float(value), float(value) + half
        if parameter.logarithmic:
            low, mid, high = (float(np.exp(x)) for x in (low, mid, high))
        result[parameter.name] = Quantity(mid, unit, (low, high))
    return result


def _compare(answer: Answer, chosen: Explanation | None, doubt: Doubt) -> Comparison:
    """What the refit moved of the given simulation and friction."""
    fit = answer.prepared.fit if chosen is None else chosen.fit
    structure = answer.prepared.structure if chosen is None else chosen.structure
    box = answer.prepared.box.joined(structure.box())
    cov = covariance(fit, box)
    plant = structure.plant(fit.theta)
    result = Comparison()
    if answer.rigid is not None and answer.rigid.rotary:
        result = compare_rigid(plant, cov[:3, :3], answer.rigid, answer.unit, doubt)
    if answer.friction is not None:
        at = [BASE_NAMES.index(name) for name in _SPLIT_BY_PRESLIDING]
        more = compare_friction(plant, cov[np.ix_(at, at)], answer.friction, answer.unit, doubt)
        result = Comparison(result.effects + more.effects, result.changes + more.changes)
    return result


def _energy(answer: Answer, chosen: Explanation, names: Collection[str]) -> list[FloatArray]:
    return effect_energy(answer.prepared, chosen.structure, chosen.fit.theta, names)


def _location(answer: Answer, series: tuple[RowSeries, ...], chosen: Explanation | None, unknown: bool) -> Location:
    """Where the mismatch sits: what the named effects add, free of noise; else all that exceeds the noise."""
    if chosen is not None:
        return locate(series, _energy(answer, chosen, chosen.names))
    if unknown:
        return locate(series, [np.maximum((one.before / one.spread) ** 2 - 1.0, 0.0) for one in series], rows=5)
    return {}


def _verdict(effects: list[NamedEffect], unknown: bool) -> str:
    kinds = {effect.kind for effect in effects}
    if "physics" in kinds:
        return "missing_physics"
    if unknown:
        return "unknown_physics"
    if "measurement" in kinds:
        return "measurement"
    return "parameters" if kinds else "consistent"


def _base(answer: Answer, chosen: Explanation | None) -> dict[str, Quantity]:
    fit = answer.prepared.fit if chosen is None else chosen.fit
    structure = answer.prepared.structure if chosen is None else chosen.structure
    deviation = np.sqrt(np.maximum(np.diag(covariance(fit, answer.prepared.box.joined(structure.box()))), 0.0))
    result = {}
    inertia = {"N·m": "kg·m²", "N": "kg"}.get(answer.unit, f"{answer.unit}·s²/{answer.position_unit}")
    units = {
        "inertia": inertia,
        "delay": "s",
        "damping_time": "s",
        "viscous_coefficient": f"{answer.unit}·s/{answer.position_unit}",
    }
    units |= {"sharpness": "1", "spread": "1", "breakaway": answer.position_unit}
    units |= {"stribeck_velocity": f"{answer.position_unit}/s"}
    split = [BASE_NAMES.index(name) for name in _SPLIT_BY_PRESLIDING]
    deviation[split] = np.hypot(deviation[split], SPLIT * structure.plant(fit.theta).level)
    for name, value, wide in zip(BASE_NAMES, fit.theta, 1.96 * deviation, strict=False):
        low, mid, high = float(value - wide), float(value), float(value + wide)
        if "log_" in name:
            low, mid, high = (float(np.exp(min(x, 700.0))) for x in (low, mid, high))
        plain = name.replace("log_", "")
        result[plain] = Quantity(mid, units.get(plain.split(".")[-1], answer.unit), (low, high))
    return result


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
