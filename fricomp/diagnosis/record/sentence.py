"""The answer in plain words, made once from what the record holds and the few facts that it has no field for."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from msgspec.structs import replace

from fricomp.overview import AT_BOUND

from .brief import write_summary
from .file_errors import FileErrors, ModelErrors
from .result import DiagnosisRecord, Forward, HeldOut, NamedEffect, Quantity
from .whereabouts import describe_whereabouts, list_whereabouts

NO_MOTION = (
    "No motion of those that were tried would tell them apart within the range and speed of this recording: another "
    "load, a wider range or a sensor of the load would have to."
)
"""Where effects cannot be told apart and nothing is proposed."""

FOREIGN_CURVE = "what is missing follows the speed in a curve that is neither a power law nor drag, as a brake's does"
"""Where a power law takes the place of all viscous friction and still does not fit."""

LAWLESS = (
    "The drive follows its command late. The joint pushes against something unknown: no law of its own motion explains "
    "its torque, so its friction cannot be judged here."
)
"""Opening where a late drive is all that can be said."""

WITHOUT_SIMULATION = {
    "parameters": "A rigid joint with friction moves as recorded; its loads differ between the recordings.",
    "missing_physics": "This recording shows physics that a rigid joint with friction leaves out.",
    "measurement": "A rigid joint with friction moves as recorded; the recorded signals are off.",
}
"""Openings where no simulation was given."""

LITTLE_LEFT = "Nothing is missing that matters."
"""Opening where something small is left that no effect explains."""

NOTHING_BUT_SHARED = (
    "Nothing is missing: what this recording shows beyond a rigid joint with friction, the simulation shows as well."
)
"""Opening where the simulation has every effect that the recording shows."""

_OF_RECORDING, _OF_OVERTONE = re.compile(r"^(sine|cosine|amplitude)_(\d+)"), re.compile(r"_overtone_(\d+)$")

_OPENING = {
    "bad_data": "The data cannot be diagnosed.",
    "consistent": "Nothing is missing: the residual is what the sensors' noise leaves.",
    "parameters": "Only parameters of the simulation are off; no physics is missing.",
    "measurement": "The joint is as simulated; the recorded signals are off.",
    "missing_physics": "The simulation leaves out physics that this recording shows.",
    "unknown_physics": "Something is missing that no effect of the catalogue explains.",
}


@dataclass(frozen=True)
class Notes:
    """What the sentences say that no field of the record holds.

    Attributes:
        opening: First sentence in place of the usual one of the verdict; empty for that one.
        lead: Sentences behind the opening.
        facts: Sentences behind the effects.
        remarks: Sentences at the end: what the checks noticed, and what the simulation has itself.
    """

    opening: str = ""
    lead: tuple[str, ...] = ()
    facts: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


def write_record(fields: DiagnosisRecord, notes: Notes) -> DiagnosisRecord:
    """The record with its sentences, all of them and the few of the summary: the only place where they are made.

    Args:
        fields: Everything but the sentences.
        notes: What they say besides.
    """
    gain = "" if fields.errors is None else f"{_describe_torque(fields.errors, fields.heldout)}."
    careful = [] if fields.errors is None else _describe_missing(fields.errors, fields.heldout)
    facts = tuple(one for one in (_describe_undetermined(fields), *careful, *notes.facts, *notes.remarks) if one)
    summary = write_summary(fields, notes.opening or _OPENING[fields.verdict], notes.lead, _locate(fields), gain, facts)
    return replace(fields, summary=summary, sentences=write_sentences(fields, notes))


def write_sentences(record: DiagnosisRecord, notes: Notes = Notes()) -> tuple[str, ...]:
    """The verdict, how large the mismatch is, where it sits, what it is, what that explains, and what else is known."""
    lines = [notes.opening or _OPENING[record.verdict], *notes.lead]
    if record.noise_ratio is not None:
        lines.append(_describe_loudness(record.noise_ratio, record.heldout))
    lines.append(_describe_where(record))
    lines += [_describe_effect(effect, record.undetermined) for effect in record.effects]
    lines.append(_describe_undetermined(record))
    lines += [] if record.errors is None else describe_errors(record.errors, record.heldout)
    if record.heldout is not None and record.effects and record.heldout.explained > 0.0:
        lines.append(f"{_describe_improvement(record.heldout)} {_describe_share(record.heldout, record.effects)}")
    lines += notes.facts
    lines += [] if record.forward is None else [describe_forward(record.forward)]
    return tuple(line for line in (*lines, *notes.remarks) if line)


def _describe_loudness(noise_ratio: float, held: HeldOut | None) -> str:
    """How large the mismatch is against the noise; of parameters that are off, as they were given too."""
    text = f"The residual of the refitted base model is {noise_ratio:.2f} times its noise floor"
    if held is None or held.before != "given" or held.noise_floor <= 0.0:
        return f"{text}."
    return f"{text}; with the parameters as given, it is {held.rmse_before / held.noise_floor:.3g} times."


def describe_forward(forward: Forward) -> str:
    """What a forward simulation showed."""
    low, high = forward.interval
    before, after = f"{forward.rmse_before:.3g}", f"{forward.rmse_after:.3g}"
    way = "falls" if forward.rmse_after < forward.rmse_before else "rises"
    errors = f"is {after} {forward.unit}" if before == after else f"{way} from {before} to {after} {forward.unit}"
    return (
        f"Simulated forward in MuJoCo from {low:.3g} to {high:.3g} s, which the fit did not see, the position error "
        f"{errors}; {forward.controller}."
    )


def describe_errors(errors: FileErrors, held: HeldOut | None = None) -> list[str]:
    """What the written models are worth on held-out data, in the units of the recording; what they do not hold."""
    motion = _describe_motion(errors.before, errors.written, moved=errors.after is not None)
    return [f"{_describe_torque(errors, held)}{motion}.", *_describe_missing(errors, held)]


def _describe_torque(errors: FileErrors, held: HeldOut | None) -> str:
    first, last = errors.before.torque, errors.written.torque
    whole = f"{errors.file.torque.rms:.3g} {last.unit} by friction.json over all data"
    band = f"in the band up to {last.band:g} Hz, while the joint moves; {whole}"
    if errors.after is None:
        return f"On held-out data the refitted model misses {last.rms:.3g} {last.unit} of the torque ({band})"
    given = " with the parameters as given" if held is not None and held.before == "given" else ""
    way = "falls" if last.rms < first.rms else "rises"
    return f"On held-out data the torque error{given} {way} from {first.rms:.3g} to {last.rms:.3g} {last.unit} ({band})"


def _describe_missing(errors: FileErrors, held: HeldOut | None) -> list[str]:
    """What the written model has no term for."""
    if not errors.missing:
        return []
    left = errors.file.torque
    found = f", and what was found leaves {held.rmse_after:.3g} {held.unit} (whitened)" if held is not None else ""
    return [
        f"Careful: friction.json has no term for {', '.join(errors.missing)}: what it leaves of the torque is "
        f"{left.rms:.3g} {left.unit}{found}."
    ]


def _describe_motion(before: ModelErrors, after: ModelErrors, *, moved: bool) -> str:
    """The position error of open-loop simulations at the first time that both have."""
    if not before.position or not after.position:
        return ""
    first, last = before.position[0], after.position[0]
    was = f", before by {first.median:.3g} {first.unit}" if moved else ""
    return (
        f"; simulated from measured states under the recorded torque, the position is off after {last.after:g} s by "
        f"{last.median:.3g} {last.unit}{was} (median)"
    )


def describe_rest(noise_ratio: float) -> str:
    """What a ripple of the samples leaves to something unknown."""
    return (
        f"Without it the rows leave {noise_ratio:.2f} times their noise: more is missing that no effect of the "
        "catalogue explains."
    )


def describe_trace(left: float, share: float, unit: str) -> str:
    """What is left that no effect explains and that is too small to be looked for."""
    of_friction = f", {share:.1%} of the Coulomb torque" if math.isfinite(share) else ""
    return (
        f"Beside the noise {left:.2g} {unit} is left that no effect explains{of_friction}: as the steps of an encoder "
        "leave it, or a log that is slower than its loop."
    )


def describe_detent(order: float, unit: str) -> str:
    """What a torque and a friction in one rhythm over the position are."""
    return (
        f"Torque and friction follow the position together, by like amounts, at the order {order:.4g} 1/{unit}: "
        "one part makes both, such as a detent."
    )


def describe_parameter(name: str) -> str:
    """The name of a parameter in words: `sine_2` is the sine of the second recording, whose encoder starts anew."""
    told = _OF_OVERTONE.sub(r", overtone \1", _OF_RECORDING.sub(r"\1 of recording \2", name))
    return told.replace("_", " ")


def _describe_improvement(held: HeldOut) -> str:
    low, high = held.ci95_reduction
    refitted = " with these parameters refitted" if held.before == "given" else ""
    return (
        f"The whitened residual falls on held-out data from {held.rmse_before:.3g} to {held.rmse_after:.3g} {held.unit}"
        f"{refitted} (by {100 * low:.0f} to {100 * high:.0f} %); its noise floor is {held.noise_floor:.3g} {held.unit}."
    )


def _describe_share(held: HeldOut, effects: Sequence[NamedEffect]) -> str:
    """How much of what lies above the noise that is, in all and by effect."""
    parts = [f"{one.name} {_format_percent(one.share)}" for one in effects if one.share > 0.0]
    each = f" ({', '.join(parts)})" if len(parts) > 1 else ""
    return f"That is {_format_percent(held.explained)} of what lies above the noise floor and can be explained{each}."


def _format_percent(share: float) -> str:
    # Below one in a hundred the digits would be noise.
    return "less than 1 %" if share < 0.01 else f"{100.0 * share:.0f} %"


def _describe_undetermined(record: DiagnosisRecord) -> str:
    """Numbers of the joint that are none, though the files have to hold some; empty where all are known."""
    names = [describe_base(name) for name in record.undetermined if name in record.base]
    if not names:
        return ""
    return f"Careful: not determined by this recording: {', '.join(names)}; the files hold one of many values that fit."


def describe_base(name: str) -> str:
    """The name of a number of the base in words: `forward.coulomb_torque` is `coulomb torque forward`."""
    return " ".join(describe_parameter(part) for part in reversed(name.split(".")))


def _describe_effect(effect: NamedEffect, undetermined: Collection[str] = ()) -> str:
    numbers = ", ".join(
        f"{describe_parameter(name)} "
        + (
            f"not determined{_format_interval(q)}"
            if f"{effect.name}.{name}" in undetermined
            else f"{q.value:.4g}{_format_unit(q.unit)}{_format_interval(q)}"
        )
        for name, q in effect.parameters.items()
    )
    text = f"{effect.name}: {effect.sentence}"
    text += f" [{effect.equation}]" if effect.equation else ""
    text += f"; {numbers}." if numbers else "."
    if effect.indistinguishable_from:
        text += f" This recording cannot tell it from {' or '.join(effect.indistinguishable_from)}."
    return text


def _format_interval(quantity: Quantity) -> str:
    """In brackets; nothing for a number that was chosen among a few, such as the order of a filter."""
    low, high = quantity.ci95
    told = [] if low == high else [f"{low:.4g} to {high:.4g}"]
    told += [AT_BOUND] if quantity.at_bound else []
    return f" ({', '.join(told)})" if told else ""


def _format_unit(unit: str) -> str:
    """Behind a number; nothing for a plain one."""
    return "" if unit in ("", "1") else f" {unit}"


def _describe_where(record: DiagnosisRecord) -> str:
    """Where the mismatch sits; empty where nothing is missing, or nobody looked."""
    if record.verdict != "unknown_physics" and not record.effects:
        return ""
    return _describe_vibration(record) or describe_whereabouts(record)


def _locate(record: DiagnosisRecord) -> str:
    """The same in one sentence: of several effects, where each of them shows."""
    return _describe_vibration(record) or list_whereabouts(record)[-1] if _describe_where(record) else ""


def _describe_vibration(record: DiagnosisRecord) -> str:
    tones = [0.5 * (low + high) for low, high in record.location.get("frequency", ())]
    return "".join(f"Something vibrates at {tone:.4g} Hz, whatever the joint does." for tone in tones)
