"""The answer of a slow recording, written once from the fits in its band."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fricomp.evaluation import RecordedMotion
from fricomp.evaluation.motion import low_pass
from fricomp.model import FrictionModel
from fricomp.model.plausibility import find_impossible
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..delivery.models import Delivery, deliver_models
from ..effects import EFFECTS
from ..evidence.comparison import Comparison
from ..evidence.in_place import BODY_SHIFTS
from ..evidence.needs import find_one_way
from ..inputs.given import Given
from ..inputs.signal import differentiate
from ..inputs.track import FloatArray, find_calm_samples, measure_torque_noise
from ..record.result import (
    DIAGNOSIS_SCHEMA,
    Diagnosis,
    DiagnosisRecord,
    Evidence,
    HeldOut,
    NamedEffect,
    Quantity,
    RowSeries,
    VerdictName,
)
from ..record.sentence import WITHOUT_SIMULATION, Notes, write_record
from .body import compare_body, fit_as_given, put_back
from .held_out import Fitted, compute_fall, measure_acceleration, measure_level, read_number
from .models import Candidate, find_highest_order
from .search import Found
from .settings import LOW_RATE

_LATE_FRICTION = ("frictional_lag", "presliding_hysteresis")
"""What turns friction over late after a reversal, which at such rates is all that is seen of a late torque."""
_BODY = ("inertia", "gravity_cosine", "gravity_sine", "offset", "torque_delay")


def write_answer(given: Given, motion: RecordedMotion, found: Found, remarks: Sequence[str]) -> Diagnosis:
    """Write the record with its sentences, and beside it the curves and models.

    Args:
        given: What is diagnosed.
        motion: The same in its band.
        found: The fits and what was named.
        remarks: What is to be told besides.
    """
    against = find_one_way([one.name for one in found.named], [part.smooth_velocity for part in motion.parts])
    effects = tuple(_describe(step, found, motion) for step in found.steps if step[0].name not in against)
    noise = _measure_noise(given.recordings, motion)
    floor = min(noise or np.inf, max(found.last.rms, 1e-300))  # the torque of a held row shows no noise
    is_unknown = _leaves_much(found, motion, noise)
    before, body = found.base, Comparison()
    if given.rigid is not None and not is_unknown:
        as_given = fit_as_given(given.rigid, found.last, motion)
        body = compare_body(given.rigid, as_given, found.last, motion)
        before = as_given if body.shifts and not effects else before  # its body is all that is off
    is_alone = before is not found.base
    fall, _, ends = compute_fall(before, found.last)
    explained = float(np.clip(fall / max(1.0 - (floor / before.rms) ** 2, 1e-12), 0.0, 1.0))
    effects += tuple(one.to_effect(explained if is_alone else 0.0) for one in body.shifts)
    word = _choose_word(effects, is_unknown=is_unknown)
    delivery = _deliver(given, motion, found, effects)
    fields = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=word,
        effects=effects,
        errors=delivery.errors,
        heldout=HeldOut(
            rmse_before=before.rms, rmse_after=found.last.rms, noise_floor=floor, unit=motion.torque_unit,
            ci95_reduction=ends, explained=explained if effects else 0.0,
            before="given" if is_alone else "refitted",
        ),
        noise_ratio=found.base.rms / floor,
        coverage=explained if effects else None,
        base=_list_base(found.base, motion),
        changes=body.changes,
        rivals=found.rivals,
        recordings=given.names,
        joint=given.recordings[0].metadata.joint,
    )  # fmt: skip
    notes = Notes(
        opening=_write_opening(word, motion, given),
        facts=(*(f"{name} is not named: {why}." for name, why in against.items()), *_list_facts(motion, found)),
        remarks=(*given.remarks, *remarks, *delivery.remarks),
    )
    return Diagnosis(
        record=write_record(fields, notes),
        evidence=Evidence(series=_list_series(given, motion, (before, found.last), floor), files=delivery.series),
        base_model=delivery.base,
        extended_model=delivery.extended,
        folds=delivery.folds,
        fold_times=delivery.times,
        recorded=delivery.motion,
    )


def _choose_word(effects: Sequence[NamedEffect], *, is_unknown: bool) -> VerdictName:
    kinds = {one.kind for one in effects}
    if "physics" in kinds:
        return "missing_physics"
    if is_unknown:
        return "unknown_physics"
    if "measurement" in kinds:
        return "measurement"
    return "parameters" if effects else "consistent"


def _leaves_much(found: Found, motion: RecordedMotion, noise: float) -> bool:
    """Whether the answer leaves more than the noise, and than a part of the torque."""
    much = max(LOW_RATE.noise_ratio * noise, LOW_RATE.unexplained * _measure_torque(motion))
    return not found.is_held and found.last.rms > much


def _measure_torque(motion: RecordedMotion) -> float:
    """Deviation of the torque where the joint moves [N·m]."""
    return float(np.std(np.concatenate([part.torque[part.moves] for part in motion.parts])))


def _deliver(given: Given, motion: RecordedMotion, found: Found, effects: Sequence[NamedEffect]) -> Delivery:
    """The models that are handed over with the answer; the extended one where physics is missing."""
    last, extended = found.last, None
    plain = last.model
    if any(one.kind == "physics" for one in effects):
        plain, extended = found.base.model, _judge_model(last.model, motion)
    off = given.rigid if {one.name for one in effects} & set(BODY_SHIFTS) else None
    as_given = None if off is None else put_back(off, last)
    judged, names = _judge_model(plain, motion), list(given.names)
    return deliver_models(given.recordings, judged, extended, names=names, whole=given.whole, given=as_given)


def _write_opening(word: VerdictName, motion: RecordedMotion, given: Given) -> str:
    """The first sentence, where the usual one would say more than such a rate shows or than was given."""
    if word != "consistent":
        return WITHOUT_SIMULATION.get(word, "") if given.rigid is None and given.friction is None else ""
    return f"Nothing is missing of what {1.0 / motion.dt:.3g} samples a second show."


def _list_facts(motion: RecordedMotion, found: Found) -> tuple[str, ...]:
    """What was looked for at this rate, and what it cannot show."""
    last, unit = found.last, motion.torque_unit
    share = 100.0 * last.rms / max(_measure_torque(motion), 1e-300)
    order = find_highest_order(motion)
    if found.is_held:
        return (
            f"What was found leaves {last.rms:.3g} {unit} on data left out, {share:.2g} % of the torque's deviation.",
            f"{100.0 * found.repeats:.0f} % of the rows in motion repeat the position of the one before: its readings "
            "come more slowly than the rows, and what they are late by looks like physics. Log the position as it is "
            "read, each reading with its own time.",
        )
    return (
        f"What was found leaves {last.rms:.3g} {unit} on data left out, {share:.2g} % of the torque's deviation, in "
        f"the band up to {motion.band:g} Hz.",
        f"At {1.0 / motion.dt:.3g} Hz breakaway, presliding, backlash and the course of a reversal fall between the "
        "samples: nothing is said of them. Looked for were friction that grows with the load, with the square of the "
        "speed, or over the angle, a spring, a stop, a ripple up to the order "
        f"{order:.3g} 1/{motion.position_unit}, and a delay of the torque; record at 300 Hz and more for the others.",
    )


def _describe(step: tuple[Candidate, Fitted, Fitted], found: Found, motion: RecordedMotion) -> NamedEffect:
    """An effect by its numbers in the last fit, and by what it took when it came in."""
    one, before, fit = step
    effect, last = EFFECTS[one.name], found.last
    units = {**last.model.law.units(motion.torque_unit, motion.position_unit), "torque_delay": "s"}
    least = {"torque_delay": 2.0 * LOW_RATE.delay_steps[-1] * motion.dt}
    wave = 2.0 * np.pi * LOW_RATE.order_known / motion.range
    least |= {"cogging.order": wave, "position_coulomb.order": wave}
    shown = {
        name.rsplit(".", 1)[-1]: _build_quantity(last, name, units[name], least.get(name, 0.0)) for name in one.numbers
    }
    fall, _, _ = compute_fall(before, fit)
    return NamedEffect(
        name=one.name,
        kind="measurement" if one.name == "torque_delay" else "physics",
        parameters=shown,
        indistinguishable_from=one.alike + (_LATE_FRICTION if one.name == "torque_delay" else ()),
        share=float(np.clip(fall * (before.rms / found.base.rms) ** 2, 0.0, 1.0)),
        equation=effect.equation,
        sentence=effect.says,
        citation=effect.citation,
    )


def _build_quantity(fit: Fitted, name: str, unit: str, least: float = 0.0) -> Quantity:
    """A number with its interval, which reaches at least `least` to either side."""
    value = read_number(fit.model, name)
    form = 0.0 if name.endswith(("order", "torque_delay")) else LOW_RATE.form * abs(value)
    half = max(LOW_RATE.certain * float(np.hypot(fit.deviation(name), form)), least)
    return Quantity(value=value, unit=unit, ci95=(value - half, value + half))


def _list_base(base: Fitted, motion: RecordedMotion) -> dict[str, Quantity]:
    assert base.model.dynamics is not None
    torque, position = motion.torque_unit, motion.position_unit
    units = {**base.model.dynamics.units(torque, position), **base.model.law.units(torque, position)}
    acceleration = measure_acceleration(motion)
    inertia = LOW_RATE.of_friction * measure_level(base, motion) / max(acceleration, 1e-12)
    least = {"torque_delay": 0.5 * motion.dt, "inertia": inertia}
    names = [name for name in units if name in _BODY or (name in base.model.law.parameters() and name not in base.held)]
    return {name.rsplit(".", 1)[-1]: _build_quantity(base, name, units[name], least.get(name, 0.0)) for name in names}


def _measure_noise(recordings: Sequence[Recording], motion: RecordedMotion) -> float:
    """Noise of the torque in the band, as its own samples show it [N·m]."""
    sizes, rng = [], np.random.default_rng(0)
    for one in recordings:
        velocity = differentiate(np.asarray(one.position), one.sample_period)
        calm = find_calm_samples(np.asarray(one.position), velocity, one.sample_period)
        noise = measure_torque_noise(np.asarray(one.torque), calm)
        size = max(len(one), 500)
        drawn = [low_pass(noise.draw(size, rng), motion.band, motion.dt) for _ in range(LOW_RATE.draws)]
        sizes.append(compute_rms(drawn))
    return compute_rms(sizes)


def _judge_model(model: FrictionModel, motion: RecordedMotion) -> FrictionModel:
    """The model, not usable where no joint can be like it."""
    speed = np.concatenate([part.smooth_velocity[part.moves] for part in motion.parts])
    reason = find_impossible(model, speed)
    if reason is None:
        return model
    return replace(model, provenance=replace(model.provenance, status="not_identifiable", message=reason))


def _list_series(
    given: Given, motion: RecordedMotion, fits: tuple[Fitted, Fitted], floor: float
) -> tuple[RowSeries, ...]:
    """What the plots show: torque that is left, where the joint moves; nothing of a part in which it does not."""
    base, last = fits
    series, start = [], 0
    assert last.model.dynamics is not None
    for k, part in enumerate(motion.parts):
        rows = slice(start, start + part.time.size)
        start += part.time.size
        known = np.isfinite(base.left[rows]) & np.isfinite(last.left[rows])
        if not np.any(known):
            continue
        load = last.model.dynamics.compute_load(part.position, part.acceleration)
        since = _measure_since_reversal(part.smooth_velocity, part.dt)
        series.append(
            RowSeries(
                name=given.names[k] if len(given.names) == len(motion.parts) else f"part {k + 1}",
                time=part.time[known],
                position=part.position[known],
                velocity=part.smooth_velocity[known],
                acceleration=part.acceleration[known],
                load_torque=load[known],
                time_since_reversal=since[known],
                temperature=None,
                before=base.left[rows][known],
                after=last.left[rows][known],
                spread=np.full(int(np.count_nonzero(known)), floor),
            )
        )
    return tuple(series)


def _measure_since_reversal(velocity: FloatArray, dt: float) -> FloatArray:
    """Time since the velocity last changed its sign [s]. Shape (n,)."""
    turns = np.concatenate([[True], np.diff(np.sign(velocity)) != 0.0])
    row = np.arange(velocity.size)
    return np.asarray((row - np.maximum.accumulate(np.where(turns, row, 0))) * dt)
