"""The answer in plain words."""

from __future__ import annotations

from .result import DiagnosisRecord, Forward, HeldOut, NamedEffect, Quantity

__all__ = ["FOREIGN_CURVE", "NO_MOTION", "detent_sentence", "forward_sentence", "sentences"]

NO_MOTION = (
    "No motion of those that were tried would tell them apart within the range and speed of this recording: another "
    "load, a wider range or a sensor of the load would have to."
)
"""Where effects cannot be told apart and nothing is proposed."""

FOREIGN_CURVE = "what is missing follows the speed in a curve that is neither a power law nor drag, as a brake's does"
"""Where a power law takes the place of all viscous friction and still does not fit."""

_OPENING = {
    "consistent": "Nothing is missing: the residual is what the sensors' noise leaves.",
    "parameters": "Only parameters of the simulation are off; no physics is missing.",
    "measurement": "The joint is as simulated; the recorded signals are off.",
    "missing_physics": "The simulation leaves out physics that this recording shows.",
    "unknown_physics": "Something is missing that no effect of the catalogue explains.",
}


def sentences(record: DiagnosisRecord) -> tuple[str, ...]:
    """Plain sentences, most important first."""
    lines = [_OPENING[record.verdict]]
    if record.noise_ratio is not None:
        lines.append(f"The residual of the refitted base model is {record.noise_ratio:.2f} times its noise floor.")
    lines += [_effect(effect) for effect in record.effects]
    if record.heldout is not None and record.effects and record.heldout.explained > 0.0:
        lines.append(_improvement(record.heldout))
    if record.verdict == "unknown_physics":
        lines.append(_vibration(record) or _where(record))
    return tuple(line for line in lines if line)


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


def _improvement(held: HeldOut) -> str:
    low, high = held.ci95_reduction
    refitted = " with these parameters refitted" if held.before == "given" else ""
    return (
        f"On held-out data the error falls from {held.rmse_before:.3g} to {held.rmse_after:.3g} {held.unit}{refitted} "
        f"(by {100 * low:.0f} to {100 * high:.0f} %); the noise floor is {held.noise_floor:.3g} {held.unit}."
    )


def _effect(effect: NamedEffect) -> str:
    numbers = ", ".join(
        f"{name.replace('_', ' ')} {q.value:.4g}{_unit(q.unit)}{_interval(q)}" for name, q in effect.parameters.items()
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


def _where(record: DiagnosisRecord) -> str:
    parts = []
    speed = record.base["forward.stribeck_velocity"].unit if record.base else ""
    units = {"velocity": speed, "position": speed.removesuffix("/s"), "acceleration": f"{speed}²" if speed else ""}
    units |= {"time_since_reversal": "s", "temperature": "°C"}
    units |= {"load_torque": record.heldout.unit} if record.heldout is not None else {}
    for name, intervals in record.location.items():
        if name in ("time", "frequency") or not intervals:
            continue
        spans = ", ".join(f"{low:.3g} to {high:.3g}" for low, high in intervals[:3])
        parts.append(f"{name.replace('_', ' ')} {spans}{_unit(units.get(name, ''))}")
    return f"Most of it sits at {'; '.join(parts)}." if parts else "It is spread over the whole recording."
