"""The diagnosis of a recording that is too slow for the rows of the residual: by the torque in its band."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.errors import DiagnosisError, ParameterError, RecordingError
from fricomp.evaluation import RecordedMotion, join_motions, read_motion
from fricomp.evaluation.motion import low_pass
from fricomp.model import FrictionModel
from fricomp.model.plausibility import find_impossible
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..delivery.models import deliver_models
from ..effects import EFFECTS
from ..evidence.needs import find_one_way
from ..inputs.given import Given
from ..inputs.signal import differentiate
from ..inputs.track import FloatArray, find_calm_samples, measure_torque_noise
from ..record.result import (
    DIAGNOSIS_SCHEMA,
    Change,
    Diagnosis,
    DiagnosisRecord,
    Evidence,
    HeldOut,
    NamedEffect,
    Quantity,
    Rival,
    RowSeries,
    VerdictName,
)
from ..record.sentence import WITHOUT_SIMULATION, Notes, write_record
from .held_out import Fitted, compute_fall, fit_held_out, read_number
from .models import Candidate, find_highest_order, list_candidates, replace_delay, write_plain_model
from .settings import LOW_RATE

__all__ = ["diagnose_low_rate", "is_low_rate"]

Progress = Callable[[str], None]
_BASE = {
    "coulomb.coulomb_torque": "coulomb_torque",
    "viscous.viscous_coefficient": "viscous_coefficient",
    "inertia": "inertia",
    "gravity_cosine": "gravity_cosine",
    "gravity_sine": "gravity_sine",
    "offset": "offset",
    "torque_delay": "torque_delay",
}


def is_low_rate(recordings: Sequence[Recording]) -> bool:
    """Whether a recording is too slow for the rows of the residual."""
    return any(recording.sample_period > LOW_RATE.longest_period for recording in recordings)


def diagnose_low_rate(given: Given, remarks: Sequence[str] = (), say: Progress | None = None) -> Diagnosis:
    """Compare a plain joint with one that has a load, a ripple or a delay, by their errors on data left out.

    Args:
        given: Checked recordings, one of them too slow for the rows of the residual.
        remarks: What is to be told besides.
        say: Called with a few words before each step.

    Raises:
        DiagnosisError: The recordings are too short, or hardly move.
    """
    tell = say or (lambda words: None)
    try:
        given, short = _leave_out_short(given)
        band = min(read_motion(one).band for one in given.recordings)
        motion = join_motions([read_motion(one, band=band) for one in given.recordings])
        period = max(one.sample_period for one in given.recordings)
        tell("fitting the plain joint")
        plain = write_plain_model(given.recordings, motion)
        base = _refine_delay(plain, motion, period)
        tell("trying what sliding shows at this rate")
        held = _measure_repeats(given.recordings) > LOW_RATE.repeated
        found = _Found((base,), (), ()) if held else _choose(base, motion, period)
    except (RecordingError, ParameterError, np.linalg.LinAlgError) as error:
        raise DiagnosisError(f"the recording cannot be explained by any joint model: {error}") from error
    return _write(given, motion, found, (*remarks, *short))


def _leave_out_short(given: Given) -> tuple[Given, tuple[str, ...]]:
    """The parts that are long enough for a band, and a sentence on the others; all where none is."""
    long = [k for k, one in enumerate(given.recordings) if _is_long(one)]
    if not long or len(long) == len(given.recordings):
        return given, ()
    rest = [one.duration for k, one in enumerate(given.recordings) if k not in long]
    kept = replace(
        given,
        recordings=tuple(given.recordings[k] for k in long),
        names=tuple(given.names[k] for k in long),
        loops=tuple(given.loops[k] for k in long),
    )
    return kept, (f"Left out: {len(rest)} part(s) too short for this rate, {sum(rest):.3g} s in all.",)


def _is_long(recording: Recording) -> bool:
    try:
        read_motion(recording)
    except RecordingError:
        return False
    return True


@dataclass(frozen=True)
class _Found:
    """The fits from the plain joint to the answer, and what was weighed.

    Attributes:
        fits: The first is of the plain joint; each further one has one effect more.
        named: The effect that each further fit has.
        rivals: What was tried.
    """

    fits: tuple[Fitted, ...]
    named: tuple[Candidate, ...]
    rivals: tuple[Rival, ...]


def _measure_repeats(recordings: Sequence[Recording]) -> float:
    """Part of the rows in motion whose position is that of the one before."""
    same = [np.zeros(0, dtype=bool)]
    for one in recordings:
        position = np.asarray(one.position)
        steps = np.abs(np.diff(position))
        usual = float(np.median(steps[steps > 0.0])) if steps.any() else np.inf
        near = LOW_RATE.neighbours
        moved = np.abs(position[2 * near :] - position[: -2 * near]) > usual
        same.append(steps[near - 1 : near - 1 + moved.size][moved] == 0.0)
    joined = np.concatenate(same)
    return float(np.mean(joined)) if joined.size else 0.0


def _refine_delay(model: FrictionModel, motion: RecordedMotion, period: float, about: float = 0.0) -> Fitted:
    """The fit with the delay that leaves the least on data left out, within half a period of `about` [s]."""
    fit = _fit_delays(model, motion, [about + period * one for one in LOW_RATE.usual_delays])
    for step in LOW_RATE.delay_steps:
        own = read_number(fit.model, "torque_delay")
        near = np.clip([own - step * period, own, own + step * period], about - 0.5 * period, about + 0.5 * period)
        fit = _fit_delays(fit.model, motion, near.tolist())
    return fit


def _fit_delays(model: FrictionModel, motion: RecordedMotion, delays: Sequence[float]) -> Fitted:
    """The fit with the delay that leaves the least on data left out."""
    return min((fit_held_out(replace_delay(model, one), motion) for one in delays), key=lambda fit: fit.rms)


def _choose(base: Fitted, motion: RecordedMotion, period: float) -> _Found:
    """Add the effect that lowers the held-out error most, as long as one does enough."""
    fits: list[Fitted] = [base]
    named: list[Candidate] = []
    rivals: list[Rival] = []
    about, level = 0.0, _measure_level(base, motion)
    while True:
        late = all(one.name != "torque_delay" for one in named)
        good = []
        for one in list_candidates(fits[-1], motion, period, may_be_late=late):
            fit = fit_held_out(one.model, motion)
            fall, _, _ = compute_fall(fits[-1], fit)
            worth = _is_worth(one, (fits[-1], fit), level)
            rivals.append(Rival(effects=(one.name,), gain=fall, refused="" if worth else _SMALL))
            good += [(fall, one, fit)] if worth else []
        if not good:
            return _Found(tuple(fits), tuple(named), _keep_best_of_each(rivals))
        _, best, fit = max(good, key=lambda one: one[0])
        named.append(best)
        about = read_number(fit.model, "torque_delay") if best.name == "torque_delay" else about
        fits.append(_refine_delay(fit.model, motion, period, about))


_SMALL = "it lowers the error on data left out by too little, or not in most blocks of time"


def _is_worth(one: Candidate, fits: tuple[Fitted, Fitted], level: float) -> bool:
    """Whether an effect lowers the error enough, nearly everywhere, and is none that fits make of nothing.

    Args:
        one: The effect.
        fits: Without it and with it.
        level: Of the sliding friction [N·m].
    """
    before, after = fits
    fall, agreed, ends = compute_fall(before, after)
    size = float(np.sqrt(max(before.rms**2 - after.rms**2, 0.0)))
    sure = fall >= one.matters and agreed >= LOW_RATE.agreeing and ends[0] > 0.0
    own = [name for name in one.numbers if name in after.model.law.parameters() and not name.endswith("order")]
    sizes = [abs(read_number(after.model, name)) for name in own]
    strays = [LOW_RATE.certain * after.deviation(name) for name in own]
    known = not own or float(np.hypot.reduce(sizes)) > float(np.hypot.reduce(strays))
    return sure and known and size >= LOW_RATE.of_friction * level


def _measure_level(base: Fitted, motion: RecordedMotion) -> float:
    """Size of the sliding friction over the motion [N·m]."""
    speed = np.concatenate([part.smooth_velocity[part.moves] for part in motion.parts])
    return compute_rms(np.asarray(base.model.torque(speed)))


def _keep_best_of_each(rivals: Sequence[Rival]) -> tuple[Rival, ...]:
    """The best try of each effect, best first."""
    best: dict[tuple[str, ...], Rival] = {}
    for one in sorted(rivals, key=lambda rival: -rival.gain):
        best.setdefault(one.effects, one)
    return tuple(best.values())


def _write(given: Given, motion: RecordedMotion, found: _Found, remarks: Sequence[str]) -> Diagnosis:
    base, last = found.fits[0], found.fits[-1]
    unit = motion.torque_unit
    noise = _measure_noise(given.recordings, motion)
    floor = min(noise, last.rms)
    torque = float(np.std(np.concatenate([part.torque[part.moves] for part in motion.parts])))
    slow = _measure_repeats(given.recordings) > LOW_RATE.repeated
    unknown = not slow and last.rms > LOW_RATE.noise_ratio * noise and last.rms > LOW_RATE.unexplained * torque
    against = find_one_way([one.name for one in found.named], [part.smooth_velocity for part in motion.parts])
    shown = [step for step in _join_fits(found) if step[0].name not in against]
    effects = tuple(_describe(one, (before, fit), found, motion) for one, before, fit in shown)
    changes = _list_changes(given, last)
    fall, _, ends = compute_fall(base, last)
    above = 1.0 - (floor / base.rms) ** 2
    physics = any(one.kind == "physics" for one in effects)
    word: VerdictName = (
        "missing_physics" if physics else "unknown_physics" if unknown
        else "measurement" if effects else "parameters" if changes else "consistent"
    )  # fmt: skip
    names = list(given.names)
    extended = last.model if physics else None
    missing = [one.name for one in effects if one.name not in {term.name for term in last.model.law.terms}]
    plain = (last if not physics else base).model
    delivery = deliver_models(
        given.recordings, _judge_model(plain, motion), None if extended is None else _judge_model(extended, motion),
        [name for name in missing if physics and name != "torque_delay"], names=names, whole=given.whole,
    )  # fmt: skip
    fields = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=word,
        effects=effects,
        errors=delivery.errors,
        heldout=HeldOut(
            rmse_before=base.rms, rmse_after=last.rms, noise_floor=floor, unit=unit, ci95_reduction=ends,
            explained=float(np.clip(fall / max(above, 1e-12), 0.0, 1.0)) if effects else 0.0,
        ),
        noise_ratio=base.rms / floor,
        coverage=float(np.clip(fall / max(above, 1e-12), 0.0, 1.0)) if effects else None,
        base=_list_base(base, motion),
        changes=changes,
        rivals=found.rivals,
        recordings=given.names,
        joint=given.recordings[0].metadata.joint,
    )  # fmt: skip
    notes = Notes(
        opening=_write_opening(word, motion, given),
        facts=(
            *(f"{name} is not named: {why}." for name, why in against.items()),
            *_list_facts(given, motion, last, torque),
        ),
        remarks=(*given.remarks, *remarks, *delivery.remarks),
    )
    return Diagnosis(
        record=write_record(fields, notes),
        evidence=Evidence(series=_list_series(given, motion, base, last, floor), files=delivery.series),
        base_model=delivery.base,
        extended_model=delivery.extended,
        folds=delivery.folds,
        fold_times=delivery.times,
        recorded=delivery.motion,
    )


def _join_fits(found: _Found) -> list[tuple[Candidate, Fitted, Fitted]]:
    return list(zip(found.named, found.fits[:-1], found.fits[1:], strict=True))


def _write_opening(word: VerdictName, motion: RecordedMotion, given: Given) -> str:
    """The first sentence, where the usual one would say more than such a rate shows or than was given."""
    if word != "consistent":
        return WITHOUT_SIMULATION.get(word, "") if given.rigid is None and given.friction is None else ""
    return f"Nothing is missing of what {1.0 / motion.dt:.3g} samples a second show."


def _list_facts(given: Given, motion: RecordedMotion, last: Fitted, torque: float) -> tuple[str, ...]:
    """What was looked for at this rate, and what it cannot show."""
    unit, share = motion.torque_unit, 100.0 * last.rms / max(torque, 1e-300)
    order = find_highest_order(motion)
    repeats = _measure_repeats(given.recordings)
    if repeats > LOW_RATE.repeated:
        return (
            f"What was found leaves {last.rms:.3g} {unit} on data left out, {share:.2g} % of the torque's deviation.",
            f"{100.0 * repeats:.0f} % of the rows in motion repeat the position of the one before: its readings come "
            "more slowly than the rows, and what they are late by looks like physics. Log the position as it is read, "
            "each reading with its own time.",
        )
    return (
        f"What was found leaves {last.rms:.3g} {unit} on data left out, {share:.2g} % of the torque's deviation, in "
        f"the band up to {motion.band:g} Hz.",
        f"At {1.0 / motion.dt:.3g} Hz breakaway, presliding, backlash and the course of a reversal fall between the "
        "samples: nothing is said of them. Looked for were friction that grows with the load, a ripple up to the order "
        f"{order:.3g} 1/{motion.position_unit}, and a delay of the torque; record at 300 Hz and more for the others.",
    )


def _describe(one: Candidate, step: tuple[Fitted, Fitted], found: _Found, motion: RecordedMotion) -> NamedEffect:
    """An effect by its numbers in the last fit, and by what it took when it came in."""
    effect, last = EFFECTS[one.name], found.fits[-1]
    units = {**last.model.law.units(motion.torque_unit, motion.position_unit), "torque_delay": "s"}
    least = {"torque_delay": 2.0 * LOW_RATE.delay_steps[-1] * motion.dt}
    least["cogging.order"] = 2.0 * np.pi * LOW_RATE.order_known / motion.range
    shown = {
        name.rsplit(".", 1)[-1]: _build_quantity(last, name, units[name], least.get(name, 0.0)) for name in one.numbers
    }
    fall, _, _ = compute_fall(*step)
    return NamedEffect(
        name=one.name,
        kind="measurement" if one.name == "torque_delay" else "physics",
        parameters=shown,
        share=float(np.clip(fall * (step[0].rms / found.fits[0].rms) ** 2, 0.0, 1.0)),
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
    units = {**base.model.dynamics.units(torque, position), "coulomb.coulomb_torque": torque}
    units["viscous.viscous_coefficient"] = f"{torque}·s/{position}"
    least = {"torque_delay": 0.5 * motion.dt}
    return {said: _build_quantity(base, name, units[name], least.get(name, 0.0)) for name, said in _BASE.items()}


def _list_changes(given: Given, last: Fitted) -> tuple[Change, ...]:
    """Inertia and gravity of the simulation that the recording moves by more than it leaves open."""
    if given.rigid is None:
        return ()
    cosine, sine = given.rigid.gravity
    told = {"inertia": (given.rigid.inertia, given.rigid.inertia)}
    size = float(np.hypot(cosine, sine))
    told |= {"gravity_cosine": (cosine, size), "gravity_sine": (sine, size)} if size > 0.0 else {}
    found = []
    for name, (value, scale) in told.items():
        quantity = _build_quantity(last, name, "kg·m²" if name == "inertia" else "N·m")
        low, high = quantity.ci95
        if abs(quantity.value - value) > LOW_RATE.matters_given * scale and not low <= value <= high:
            found.append(Change(name=name, given=value, refitted=quantity))
    return tuple(found)


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
    given: Given, motion: RecordedMotion, base: Fitted, last: Fitted, floor: float
) -> tuple[RowSeries, ...]:
    """What the plots show: torque that is left, where the joint moves; nothing of a part in which it does not."""
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
