"""Effects that a simulation has itself: not missing in it, but perhaps of another size, or not in the recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from msgspec.structs import replace as with_fields

from ..record.result import Diagnosis, NamedEffect, Quantity, verdict_of
from ..record.sentence import NO_MOTION, sentences

__all__ = ["remove_known"]

_WAVES = ("sine", "cosine")  # a phase has no size, and two encoders start at different angles
_FOR_SURE = 2.0  # of both intervals together, that two numbers of one effect must be apart
_MUCH = 0.1  # of the larger of them besides: no simulation is better than that

_NOTHING = (
    "Nothing is missing: what this recording shows beyond a rigid joint with friction, the simulation shows as well."
)


def remove_known(diagnosis: Diagnosis, known: Sequence[NamedEffect], *, sure: bool = True) -> Diagnosis:
    """The diagnosis without the effects that the simulation has itself, and what these are in it.

    An effect that both have in another size is one of the simulation's parameters; one that the recording does not
    show is told.

    Args:
        diagnosis: Of the recording.
        known: Effects that the simulation's own recording shows.
        sure: Whether they explain all of it. Where they do not, their sizes say little, and what the recording does not
            show may stand for something else.
    """
    if not known:
        return diagnosis
    effects, told, seen = [], [], set()
    for effect in diagnosis.effects:
        own = next((one for one in known if _is_same(effect, one)), None)
        if own is None:
            effects.append(effect)
            continue
        seen.add(own.name)
        apart = _list_differing(effect, own) if sure else []
        if apart:
            effects.append(_resize(effect, own, apart))
        else:
            told.append(f"The simulation shows {own.name} as well, so this is not missing in it.")
    alone = [one for one in known if one.name not in seen] if sure else []
    too_much = "which the recording does not: it is too much in it."
    told += [f"The simulation shows {one.name} ({_write_numbers(_list_sizes(one))}), {too_much}" for one in alone]
    return _rewrite(diagnosis, tuple(effects), told, alone=bool(alone))


def _rewrite(diagnosis: Diagnosis, effects: tuple[NamedEffect, ...], told: Sequence[str], *, alone: bool) -> Diagnosis:
    """The diagnosis with these effects; where the simulation has one `alone`, it does not agree."""
    record = diagnosis.record
    verdict = record.verdict
    if verdict not in ("unknown_physics", "bad_data"):
        kinds = [effect.kind for effect in effects]
        verdict = verdict_of([*kinds, "parameter"] if alone else kinds)
    said = record.sentences
    if effects != record.effects or verdict != record.verdict:
        before = sentences(record)
        further = [one for one in record.sentences if one not in before]
        if not any(effect.indistinguishable_from for effect in effects):
            further = [one for one in further if one != NO_MOTION]
        opening, *others = sentences(with_fields(record, effects=effects, verdict=verdict))
        said = (_NOTHING if verdict == "consistent" else opening, *others, *further)
    return replace(diagnosis, record=with_fields(record, effects=effects, verdict=verdict, sentences=(*said, *told)))


def _is_same(effect: NamedEffect, own: NamedEffect) -> bool:
    """Whether two recordings show one effect, as far as each can tell it from others."""
    return own.name in (effect.name, *effect.indistinguishable_from) or effect.name in own.indistinguishable_from


def _list_differing(effect: NamedEffect, own: NamedEffect) -> list[str]:
    """Numbers of an effect that differ for sure; none of two effects that only pass for one another."""
    ours, theirs = _list_sizes(effect), _list_sizes(own)
    if effect.name != own.name:
        return []
    return [name for name in ours if name in theirs and _differ(ours[name], theirs[name])]


def _differ(one: Quantity, other: Quantity) -> bool:
    ours, theirs = (0.5 * (q.ci95[1] - q.ci95[0]) for q in (one, other))
    largest = max(abs(one.value), abs(other.value))
    return abs(one.value - other.value) > max(_FOR_SURE * float(np.hypot(ours, theirs)), _MUCH * largest)


def _list_sizes(effect: NamedEffect) -> dict[str, Quantity]:
    """Numbers of an effect; of a ripple its amplitude in place of sine and cosine."""
    numbers = {name: one for name, one in effect.parameters.items() if not name.startswith(_WAVES)}
    if not set(_WAVES) <= set(effect.parameters):
        return numbers
    sine, cosine = (effect.parameters[name] for name in _WAVES)
    size = float(np.hypot(sine.value, cosine.value))
    half = max(0.5 * (wave.ci95[1] - wave.ci95[0]) for wave in (sine, cosine))
    return {"amplitude": Quantity(size, sine.unit, (max(size - half, 0.0), size + half)), **numbers}


def _resize(effect: NamedEffect, own: NamedEffect, apart: Sequence[str]) -> NamedEffect:
    """The effect as a parameter of the simulation, which has other numbers there."""
    ours, theirs = _list_sizes(effect), _list_sizes(own)
    has = _write_numbers({name: theirs[name] for name in apart})
    here = ", ".join(f"{ours[name].value:.3g}" for name in apart)
    sentence = f"{effect.sentence}; the simulation has it with {has} in place of {here}"
    return with_fields(effect, kind="parameter", sentence=sentence)


def _write_numbers(sizes: Mapping[str, Quantity]) -> str:
    return ", ".join(
        f"{name.replace('_', ' ')} {one.value:.3g} {'' if one.unit == '1' else one.unit}".strip()
        for name, one in sizes.items()
    )
