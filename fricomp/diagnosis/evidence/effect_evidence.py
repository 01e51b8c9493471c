"""What speaks for each effect of the chosen explanation: its numbers, its energy, and where it acts."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from ..effects.effect import Effect
from ..inputs.track import FloatArray
from ..record.result import Location, Quantity, RowSeries
from ..search.effect_energy import compute_effect_energy
from ..search.explanation import Explanation
from .alias import list_aliases
from .case import Case
from .location import locate
from .overtone import Overtone, find_overtones, is_explained_by_overtone
from .refitted import RefittedJoint


@dataclass(frozen=True)
class EffectEvidence:
    """One effect of the chosen explanation.

    Attributes:
        effect: Of the catalogue.
        parameters: Its numbers with their intervals.
        energy: Energy of its torque that no refit of the base takes up, in units of the noise variance.
        location: Where that energy is.
        aliases: Effects that could stand in its place.
        overtone_of: The stronger ripple that this one only completes the form of; None where it stands for itself.
    """

    effect: Effect
    parameters: dict[str, Quantity]
    energy: float
    location: Location
    aliases: tuple[str, ...]
    overtone_of: Overtone | None = None


def measure_effects(
    case: Case, chosen: Explanation, refitted: RefittedJoint, series: tuple[RowSeries, ...]
) -> tuple[tuple[EffectEvidence, ...], Location]:
    """Measure each effect of an explanation, and where all of them act together.

    Args:
        case: Base and search.
        chosen: The explanation.
        refitted: The same with fresh derivatives.
        series: Rows before and after.
    """
    energies = {name: _measure_energy(case, chosen, {name}) for name in chosen.names}
    whole = energies[chosen.names[0]] if len(energies) == 1 else _measure_energy(case, chosen, chosen.names)
    sums = {name: float(np.sum(np.concatenate(energy))) for name, energy in energies.items()}
    span = max(float(np.ptp(context.position)) for context in chosen.structure.contexts)

    def does_as_well(name: str, other: str, order: float) -> bool:
        return is_explained_by_overtone(case.baseline, case.found.explanations, chosen, name, other, order)

    overtones = find_overtones(chosen, sums, span, does_as_well)
    measured = tuple(
        EffectEvidence(
            effect=candidate.effect,
            parameters=refitted.list_parameters(candidate.name, case.unit, case.position_unit),
            energy=sums[candidate.name],
            location=_locate_energy(case, series, energies[candidate.name]),
            aliases=list_aliases(case.found, candidate.name),
            overtone_of=overtones.get(candidate.name),
        )
        for candidate in chosen.structure.candidates
    )
    return measured, _locate_energy(case, series, whole)


def _measure_energy(case: Case, chosen: Explanation, names: Collection[str]) -> list[FloatArray]:
    return compute_effect_energy(case.baseline, chosen.structure, chosen.fit.theta, names)


def _locate_energy(case: Case, series: tuple[RowSeries, ...], energy: Sequence[FloatArray]) -> Location:
    """Where effects add most, of whose torque the energy of every sample is known."""
    baseline = case.baseline
    rows = [one[grid.centres] for one, grid in zip(energy, baseline.problem.grids, strict=True)]
    return locate(series, rows, samples=(baseline.structure.contexts[0].time, energy[0]))
