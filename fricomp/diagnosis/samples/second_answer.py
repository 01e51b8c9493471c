"""The answer of a second look: the diagnosis with what the samples themselves show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace as with_fields

from fricomp.laws import Cogging, FrictionLaw
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from ..effects import EFFECTS
from ..evidence.location import excess_maps
from ..inputs.track import FloatArray
from ..record.result import Diagnosis, DiagnosisRecord, Evidence, HeldOut, NamedEffect, Quantity, Rival, RowSeries
from ..record.sentence import sentences
from ..search.generic import measure_time_since_reversal
from .drive_path import DrivePath
from .fine_ripple import FineRipple, Harmonic
from .soft_presliding import SoftPresliding

__all__ = ["held_out", "searched", "with_drive_path", "with_presliding", "with_ripple"]

_ALIKE = 1.15  # ratio of held-out errors up to which two explanations of the drive are not told apart
_BOOTSTRAPS = 400
_LAWLESS = (
    "The drive follows its command late. The joint pushes against something unknown: no law of its own motion explains "
    "its torque, so its friction cannot be judged here."
)


def searched(diagnosis: Diagnosis) -> bool:
    """Whether an effect was named that changes the residual; late columns have no share, compared parameters one of
    what they take away from the base as given."""
    return not _as_given(diagnosis) and any(effect.share > 0.0 for effect in diagnosis.effects)


def _as_given(diagnosis: Diagnosis) -> bool:
    """Whether only parameters were off, so that the errors are of the base as given and refitted."""
    return diagnosis.heldout is not None and diagnosis.heldout.before == "given"


def with_ripple(
    recordings: Sequence[Recording], diagnosis: Diagnosis, ripples: Sequence[FineRipple], seed: int
) -> Diagnosis:
    """The diagnosis with a ripple that is finer than the rows."""
    unit, position = recordings[0].metadata.torque_unit, recordings[0].metadata.position_unit
    strongest = ripples[0].harmonics[0]
    name = "position_coulomb" if strongest.level else "cogging"
    known = EFFECTS[name]
    others = ", ".join(f"{h.order:.5g} ({h.amplitude:.3g} {unit})" for h in ripples[0].harmonics[1:6])
    more = f"; further orders {others}" if others else ""
    effect = NamedEffect(
        name=name,
        kind="physics",
        parameters=_parameters(strongest, unit, position),
        equation="tau = sum of A_k sin(n_k q + phi_k)" + (", times sgn(v)" if strongest.level else ""),
        sentence=f"{known.says}, finer than the rows of the residual{more}",
        citation=known.citation,
    )
    extended = _extended(diagnosis.base_model, ripples[0].harmonics)
    return _with_effect(diagnosis, effect, ripples, (unit, seed), extended=extended, orders=ripples[0].orders)


def with_presliding(
    recordings: Sequence[Recording], diagnosis: Diagnosis, soft: Sequence[SoftPresliding], seed: int
) -> Diagnosis:
    """The diagnosis with presliding that fills the motion."""
    unit, position = recordings[0].metadata.torque_unit, recordings[0].metadata.position_unit
    first, known = soft[0], EFFECTS["presliding_hysteresis"]
    wide, half = float(np.exp(1.96 * first.distance_error)), 1.96 * first.level_error
    stiffness = first.level / first.distance
    effect = NamedEffect(
        name=known.name,
        kind="physics",
        parameters={
            "breakaway_distance": Quantity(first.distance, position, (first.distance / wide, first.distance * wide)),
            "coulomb_torque": Quantity(first.level, unit, (first.level - half, first.level + half)),
            "sigma_0": Quantity(stiffness, f"{unit}/{position}", (stiffness / wide, stiffness * wide)),
        },
        equation=known.equation,
        sentence=f"{known.says}, which fills much of this motion; nothing without memory explains it",
        citation=known.citation,
    )
    extended = diagnosis.base_model.with_law(first.law) if diagnosis.base_model is not None else None
    return _with_effect(diagnosis, effect, soft, (unit, seed), extended=extended, orders={})


def _with_effect(
    diagnosis: Diagnosis,
    effect: NamedEffect,
    found: Sequence[FineRipple | SoftPresliding],
    how: tuple[str, int],
    *,
    extended: FrictionModel | None,
    orders: dict[str, FloatArray],
) -> Diagnosis:
    """The diagnosis with an effect that the samples of each recording show; its share is counted in them."""
    before, after = (np.concatenate([getattr(one, side) for one in found]) for side in ("before", "after"))
    held = held_out(before, after, _floor(found), how)
    effects = (with_fields(effect, share=held.explained), *_compared(diagnosis))
    series = tuple(
        _series(name, one.samples, (one.before, one.after))
        for name, one in zip(diagnosis.record.recordings, found, strict=False)
    )
    evidence = Evidence(series=series, maps=excess_maps(series, how[1]), orders=orders)
    record = _record(diagnosis, "missing_physics", effects, held)
    return Diagnosis(record, evidence, diagnosis.base_model, extended)


def _parameters(harmonic: Harmonic, unit: str, position: str) -> dict[str, Quantity]:
    wide = 1.96 * harmonic.order_error
    low, high = max(harmonic.order - wide, 1e-12), harmonic.order + wide
    half = 1.96 * harmonic.amplitude_error
    size = harmonic.amplitude
    return {
        "order": Quantity(harmonic.order, f"1/{position}", (low, high)),
        "period": Quantity(2.0 * np.pi / harmonic.order, position, (2.0 * np.pi / high, 2.0 * np.pi / low)),
        "amplitude": Quantity(size, unit, (max(size - half, 0.0), size + half)),
    }


def _extended(base: FrictionModel | None, harmonics: Sequence[Harmonic]) -> FrictionModel | None:
    """The base with the strongest harmonic; a law holds one term of each name."""
    waves = [harmonic for harmonic in harmonics if not harmonic.level]
    if base is None or not waves:
        return None
    term = Cogging(waves[0].sine, waves[0].cosine, waves[0].order)
    return base.with_law(FrictionLaw((*base.law.terms, term)))


def with_drive_path(recordings: Sequence[Recording], diagnosis: Diagnosis, path: DrivePath, seed: int) -> Diagnosis:
    """The diagnosis with a drive that follows its command late."""
    unit = recordings[0].metadata.torque_unit
    held = held_out(path.before, path.after, path.errors["history"], (unit, seed))
    other = {"drive_lag": "torque_delay", "torque_delay": "drive_lag"}[path.name]
    known, half = EFFECTS[path.name], 1.96 * path.deviation
    parameter = "delay" if path.name == "torque_delay" else "time_constant"
    effect = NamedEffect(
        name=path.name,
        kind="measurement",
        parameters={parameter: Quantity(path.value, "s", (max(path.value - half, 0.0), path.value + half))},
        indistinguishable_from=(other,) if path.errors[other] < _ALIKE * path.errors[path.name] else (),
        share=held.explained,
        equation=known.equation,
        sentence="the measured torque follows its command late, while what the joint pushes against is unknown",
        citation=known.citation,
    )
    weighed = (
        Rival(
            effects=(name,),
            gain=float(path.before.size * np.log(path.errors["law"] / error)),
            refused=""
            if name == path.name
            else f"held-out error {error:.3g} {unit} against {path.errors[path.name]:.3g}",
        )
        for name, error in path.errors.items()
        if name in (path.name, other, "coulomb")
    )
    rivals = tuple(sorted(weighed, key=lambda rival: -rival.gain))
    record = with_fields(_record(diagnosis, "measurement", (effect,), held), rivals=rivals, base={}, changes=())
    record = with_fields(record, sentences=(_LAWLESS, *record.sentences[1:]))
    one, t = recordings[0], np.asarray(recordings[0].time) - recordings[0].time[0]
    velocity = np.gradient(np.asarray(one.position), t) if one.velocity is None else np.asarray(one.velocity)
    samples = {"time": t, "position": np.asarray(one.position), "velocity": velocity}
    samples["acceleration"] = np.gradient(velocity, t)
    series = (_series(diagnosis.record.recordings[0], samples, (path.before, path.after)),)
    return Diagnosis(record, Evidence(series=series, maps=excess_maps(series, seed)))


def _record(diagnosis: Diagnosis, verdict: str, effects: tuple[NamedEffect, ...], held: HeldOut) -> DiagnosisRecord:
    """The record with another answer; what the search named before joins the refused rivals, but for the same name."""
    old, name = diagnosis.record, effects[0].name
    refused = [
        Rival(effects=(e.name,), gain=0.0, refused=f"covers {e.share:.0%} of the mismatch in the rows, less here")
        for e in old.effects
        if searched(diagnosis) and e.share > 0.0 and e.name != name
    ]
    same = [rival for rival in old.rivals if not rival.refused and rival.effects == (name,)]
    others = [_superseded(rival) for rival in old.rivals if rival not in same]
    named = same or [Rival(effects=tuple(e.name for e in effects), gain=0.0)]
    record = with_fields(
        old,
        verdict=verdict,
        effects=effects,
        heldout=held,
        location={},
        noise_ratio=held.rmse_before / max(held.noise_floor, 1e-30),
        coverage=held.explained,
        rivals=(*named, *refused, *others),
        next_experiment=None,
        sentences=(),
    )
    return with_fields(record, sentences=sentences(record))


def _compared(diagnosis: Diagnosis) -> tuple[NamedEffect, ...]:
    """What differs from the given simulation and friction, which a finding in the samples leaves as it is.

    Beside it the error is counted from the base refitted again, so that none of these has a share.
    """
    if _as_given(diagnosis):
        return tuple(with_fields(effect, share=0.0) for effect in diagnosis.effects)
    return tuple(effect for effect in diagnosis.effects if effect.share == 0.0)


def _superseded(rival: Rival) -> Rival:
    return rival if rival.refused else with_fields(rival, refused="covers too little of the mismatch in the samples")


def held_out(before: FloatArray, after: FloatArray, floor: float, how: tuple[str, int]) -> HeldOut:
    """Errors, with the interval of their fall from a bootstrap over blocks."""
    unit, seed = how
    blocks = np.array_split(np.arange(before.size), 40)
    energy = np.array([[float(one[b] @ one[b]) for b in blocks] for one in (before, after)])
    drawn = np.random.default_rng(seed).integers(0, 40, (_BOOTSTRAPS, 40))
    falls = 1.0 - np.sqrt(energy[1][drawn].sum(axis=1) / energy[0][drawn].sum(axis=1))
    first, last = (float(np.sqrt(np.mean(one**2))) for one in (before, after))
    low, high = np.quantile(falls, [0.025, 0.975])
    floor = min(floor, last)
    explained = (first**2 - last**2) / (first**2 - floor**2)
    return HeldOut(
        rmse_before=first,
        rmse_after=last,
        noise_floor=floor,
        unit=unit,
        ci95_reduction=(float(low), float(high)),
        explained=float(explained),
    )


def _floor(found: Sequence[FineRipple | SoftPresliding]) -> float:
    """Noise of single samples, from the differences of neighbours that nothing smooth explains [N·m]."""
    steps = np.concatenate([np.diff(one.after) for one in found])
    return float(np.median(np.abs(steps)) / (0.6745 * np.sqrt(2.0)))


def _series(name: str, samples: dict[str, FloatArray], sides: tuple[FloatArray, FloatArray]) -> RowSeries:
    time = samples["time"]
    dt = float(np.median(np.diff(time)))
    spread = np.full(time.size, max(float(np.median(np.abs(np.diff(sides[1])))) / 0.954, 1e-12))
    return RowSeries(
        name=name,
        time=time,
        position=samples["position"],
        velocity=samples["velocity"],
        acceleration=samples["acceleration"],
        load_torque=np.zeros(time.size),
        time_since_reversal=measure_time_since_reversal(samples["velocity"], dt),
        temperature=None,
        before=sides[0],
        after=sides[1],
        spread=spread,
    )
