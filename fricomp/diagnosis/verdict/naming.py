"""The effects that were chosen, as they are named: numbers, shares, and where they act."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from msgspec.structs import replace as with_fields

from ..effects import EFFECTS
from ..effects.spring import describe_spring
from ..evidence.alias import aliases
from ..evidence.answer import Answer
from ..evidence.location import locate
from ..evidence.refitted import Refitted
from ..inputs.track import FloatArray
from ..record.result import Location, NamedEffect, RowSeries
from ..search.effect_energy import compute_effect_energy
from ..search.explanation import Explanation
from ..search.tone import Tone
from .overtone import explained_by_overtone, overtones

__all__ = ["each_once", "name_effects", "where_unknown"]

_GAIN = "torque_gain_error"


def name_effects(
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
            describe_spring(
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


def each_once(named: Sequence[NamedEffect], compared: Sequence[NamedEffect]) -> list[NamedEffect]:
    """What was chosen, with what the comparison says under the same name, and the rest of the comparison.

    So it is with a load that differs between the recordings, and in the first of them from the simulation's. Beside an
    effect that scales the torque by a factor of its own no gain is named: how the two share it is a matter of form.
    """
    scaled = any(EFFECTS[one.name].scales_torque for one in named)
    rest = {one.name: one for one in compared if not (scaled and one.name == _GAIN)}
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


def _energy(answer: Answer, chosen: Explanation, names: Collection[str]) -> list[FloatArray]:
    return compute_effect_energy(answer.prepared, chosen.structure, chosen.fit.theta, names)


def _located(answer: Answer, series: tuple[RowSeries, ...], energy: Sequence[FloatArray]) -> Location:
    """Where effects add most, of whose torque the energy of every sample is known."""
    prepared = answer.prepared
    rows = [one[grid.centres] for one, grid in zip(energy, prepared.problem.grids, strict=True)]
    return locate(series, rows, samples=(prepared.structure.contexts[0].time, energy[0]))


def where_unknown(series: tuple[RowSeries, ...], tone: Tone | None) -> Location:
    """Where most of what exceeds the noise sits, and the frequency of a vibration."""
    location = locate(series, [np.maximum((one.before / one.spread) ** 2 - 1.0, 0.0) for one in series], rows=5)
    if tone is not None:
        location["frequency"] = [(tone.frequency - tone.width, tone.frequency + tone.width)]
    return location
