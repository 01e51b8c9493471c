"""Effects that a simulation has itself: not missing in it, but perhaps of another size, or not in the recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from msgspec.structs import replace

from ..record.result import Kind, NamedEffect, Quantity
from .settings import SHARING

_WAVES = ("sine", "cosine")  # a phase has no size, and two encoders start at different angles


@dataclass(frozen=True)
class SimulationEffects:
    """Effects that the simulation's own recording shows.

    Attributes:
        effects: The effects.
        sure: Whether they explain all of it. Where they do not, their sizes say little, and what the recording does not
            show may stand for something else.
        remarks: What else is to be told about the simulation, in sentences.
    """

    effects: tuple[NamedEffect, ...] = ()
    sure: bool = True
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class SharedEffects:
    """What of the named effects the simulation lacks.

    Attributes:
        effects: Those that it lacks, and those that it has in another size, which are its parameters.
        told: Sentences on those that it has itself.
        all_shared: Whether it lacks nothing, and has some effect.
        too_much: Whether it has one that the recording does not show.
    """

    effects: tuple[NamedEffect, ...]
    told: tuple[str, ...] = ()
    all_shared: bool = False
    too_much: bool = False

    @property
    def kinds(self) -> set[Kind]:
        """Kinds that the verdict depends on; a simulation that has too much has a wrong parameter."""
        kinds: set[Kind] = {effect.kind for effect in self.effects}
        return kinds | {"parameter"} if self.too_much else kinds


def share_effects(named: tuple[NamedEffect, ...], simulated: SimulationEffects | None) -> SharedEffects:
    """Set apart the effects that the simulation has itself.

    Args:
        named: Effects that the recording shows.
        simulated: Effects that the simulation has; None where nobody looked for them.
    """
    if simulated is None:
        return SharedEffects(named)
    missing, told, seen = [], [], set()
    for effect in named:
        own = next((one for one in simulated.effects if _is_same(effect, one)), None)
        if own is None:
            missing.append(effect)
            continue
        seen.add(own.name)
        apart = _list_differences(effect, own) if simulated.sure else []
        if apart:
            missing.append(_name_resized(effect, own, apart))
        else:
            told.append(f"The simulation shows {own.name} as well, so this is not missing in it.")
    alone = [one for one in simulated.effects if one.name not in seen] if simulated.sure else []
    too_much = "which the recording does not: it is too much in it."
    told += [f"The simulation shows {one.name} ({_format_sizes(_list_sizes(one))}), {too_much}" for one in alone]
    all_shared = bool(named) and not missing and not alone
    return SharedEffects(tuple(missing), (*told, *simulated.remarks), all_shared, bool(alone))


def _is_same(effect: NamedEffect, own: NamedEffect) -> bool:
    """Whether two recordings show one effect, as far as each can tell it from others."""
    return own.name in (effect.name, *effect.indistinguishable_from) or effect.name in own.indistinguishable_from


def _list_differences(effect: NamedEffect, own: NamedEffect) -> list[str]:
    """Numbers of an effect that differ for sure; none of two effects that only pass for one another."""
    ours, theirs = _list_sizes(effect), _list_sizes(own)
    if effect.name != own.name:
        return []
    return [name for name in ours if name in theirs and _differ(ours[name], theirs[name])]


def _differ(one: Quantity, other: Quantity) -> bool:
    ours, theirs = (0.5 * (q.ci95[1] - q.ci95[0]) for q in (one, other))
    largest = max(abs(one.value), abs(other.value))
    return abs(one.value - other.value) > max(SHARING.for_sure * float(np.hypot(ours, theirs)), SHARING.much * largest)


def _list_sizes(effect: NamedEffect) -> dict[str, Quantity]:
    """Numbers of an effect; of a ripple its amplitude in place of sine and cosine."""
    numbers = {name: one for name, one in effect.parameters.items() if not name.startswith(_WAVES)}
    if not set(_WAVES) <= set(effect.parameters):
        return numbers
    sine, cosine = (effect.parameters[name] for name in _WAVES)
    size = float(np.hypot(sine.value, cosine.value))
    half = max(0.5 * (wave.ci95[1] - wave.ci95[0]) for wave in (sine, cosine))
    return {"amplitude": Quantity(size, sine.unit, (max(size - half, 0.0), size + half)), **numbers}


def _name_resized(effect: NamedEffect, own: NamedEffect, apart: Sequence[str]) -> NamedEffect:
    """The effect as a parameter of the simulation, which has other numbers there."""
    ours, theirs = _list_sizes(effect), _list_sizes(own)
    has = _format_sizes({name: theirs[name] for name in apart})
    here = ", ".join(f"{ours[name].value:.3g}" for name in apart)
    sentence = f"{effect.sentence}; the simulation has it with {has} in place of {here}"
    return replace(effect, kind="parameter", sentence=sentence)


def _format_sizes(sizes: Mapping[str, Quantity]) -> str:
    return ", ".join(
        f"{name.replace('_', ' ')} {one.value:.3g} {'' if one.unit == '1' else one.unit}".strip()
        for name, one in sizes.items()
    )
