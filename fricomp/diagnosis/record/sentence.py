"""The answer in plain words."""

from __future__ import annotations

import re
from collections.abc import Sequence

from .result import DiagnosisRecord, Forward, HeldOut, NamedEffect, Quantity
from .whereabouts import whereabouts

__all__ = ["FOREIGN_CURVE", "NO_MOTION", "detent_sentence", "forward_sentence", "parameter_words", "sentences"]

NO_MOTION = (
    "No motion of those that were tried would tell them apart within the range and speed of this recording: another "
    "load, a wider range or a sensor of the load would have to."
)
"""Where effects cannot be told apart and nothing is proposed."""

FOREIGN_CURVE = "what is missing follows the speed in a curve that is neither a power law nor drag, as a brake's does"
"""Where a power law takes the place of all viscous friction and still does not fit."""

_OF_RECORDING = re.compile(r"^(sine|cosine|amplitude)_(\d+)$")

_OPENING = {
    "consistent": "Nothing is missing: the residual is what the sensors' noise leaves.",
    "parameters": "Only parameters of the simulation are off; no physics is missing.",
    "measurement": "The joint is as simulated; the recorded signals are off.",
    "missing_physics": "The simulation leaves out physics that this recording shows.",
    "unknown_physics": "Something is missing that no effect of the catalogue explains.",
}


def sentences(record: DiagnosisRecord) -> tuple[str, ...]:
    """Plain sentences: the verdict, how large the mismatch is, where it sits, what it is, what that explains."""
    lines = [_OPENING[record.verdict]]
    if record.noise_ratio is not None:
        lines.append(_loudness(record.noise_ratio, record.heldout))
    if record.verdict == "unknown_physics" or record.effects:
        lines.append(_vibration(record) or whereabouts(record))
    lines += [_effect(effect) for effect in record.effects]
    if record.heldout is not None and record.effects and record.heldout.explained > 0.0:
        lines.append(f"{_improvement(record.heldout)} {_share(record.heldout, record.effects)}")
    return tuple(line for line in lines if line)


def _loudness(noise_ratio: float, held: HeldOut | None) -> str:
    """How large the mismatch is against the noise; of parameters that are off, as they were given too."""
    text = f"The residual of the refitted base model is {noise_ratio:.2f} times its noise floor"
    if held is None or held.before != "given" or held.noise_floor <= 0.0:
        return f"{text}."
    return f"{text}; with the parameters as given, it is {held.rmse_before / held.noise_floor:.3g} times."


def forward_sentence(forward: Forward) -> str:
    """What a forward simulation showed."""
    low, high = forward.interval
    before, after = f"{forward.rmse_before:.3g}", f"{forward.rmse_after:.3g}"
    way = "falls" if forward.rmse_after < forward.rmse_before else "rises"
    errors = f"is {after} {forward.unit}" if before == after else f"{way} from {before} to {after} {forward.unit}"
    return (
        f"Simulated forward in MuJoCo from {low:.3g} to {high:.3g} s, which took no part, the position error {errors}; "
        f"{forward.controller}."
    )


def detent_sentence(order: float, unit: str) -> str:
    """What a torque and a friction in one rhythm over the position are."""
    return (
        f"Torque and friction follow the position together, by like amounts, at the order {order:.4g} 1/{unit}: "
        "one part makes both, such as a detent."
    )


def parameter_words(name: str) -> str:
    """The name of a parameter in words: `sine_2` is the sine of the second recording, whose encoder starts anew."""
    return _OF_RECORDING.sub(r"\1 of recording \2", name).replace("_", " ")


def _improvement(held: HeldOut) -> str:
    low, high = held.ci95_reduction
    refitted = " with these parameters refitted" if held.before == "given" else ""
    return (
        f"On held-out data the error falls from {held.rmse_before:.3g} to {held.rmse_after:.3g} {held.unit}{refitted} "
        f"(by {100 * low:.0f} to {100 * high:.0f} %); the noise floor is {held.noise_floor:.3g} {held.unit}."
    )


def _share(held: HeldOut, effects: Sequence[NamedEffect]) -> str:
    """How much of what lies above the noise that is, in all and by effect."""
    parts = [f"{one.name} {_percent(one.share)}" for one in effects if one.share > 0.0]
    each = f" ({', '.join(parts)})" if len(parts) > 1 else ""
    return f"That is {_percent(held.explained)} of what lies above the noise floor and can be explained{each}."


def _percent(share: float) -> str:
    return "less than 1 %" if share < 0.01 else f"{100.0 * share:.0f} %"


def _effect(effect: NamedEffect) -> str:
    numbers = ", ".join(
        f"{parameter_words(name)} {q.value:.4g}{_unit(q.unit)}{_interval(q)}" for name, q in effect.parameters.items()
    )
    text = f"{effect.name}: {effect.sentence}"
    text += f" [{effect.equation}]" if effect.equation else ""
    text += f"; {numbers}." if numbers else "."
    if effect.indistinguishable_from:
        text += f" This recording cannot tell it from {' or '.join(effect.indistinguishable_from)}."
    return text


def _interval(quantity: Quantity) -> str:
    """In brackets; nothing for a number that was chosen among a few, such as the order of a filter."""
    low, high = quantity.ci95
    return "" if low == high else f" ({low:.4g} to {high:.4g})"


def _unit(unit: str) -> str:
    """Behind a number; nothing for a plain one."""
    return "" if unit in ("", "1") else f" {unit}"


def _vibration(record: DiagnosisRecord) -> str:
    tones = [0.5 * (low + high) for low, high in record.location.get("frequency", ())]
    return "".join(f"Something vibrates at {tone:.4g} Hz, whatever the joint does." for tone in tones)
