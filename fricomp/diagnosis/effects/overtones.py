"""A wave over the position that is no sine: overtones of a ripple, as further numbers of the same effect."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from fricomp.laws import Term

from ..inputs.track import FloatArray
from .effect import EffectParameter

MULTIPLES = (2, 3)
"""Multiples of its order at which a ripple may have overtones. Those above are finer than rows tell."""


def list_overtones(names: Mapping[str, float]) -> tuple[int, ...]:
    """List the multiples of its order that a ripple with these numbers has beside the wave itself."""
    return tuple(times for times in MULTIPLES if f"sine{_end(times)}" in names)


def list_multiples(values: Mapping[str, float]) -> tuple[int, ...]:
    """List the multiples of its order at which a ripple with these numbers waves, its own first."""
    return (1, *list_overtones(values))


def start_overtone(times: int) -> dict[str, float]:
    """Numbers of a ripple's overtone from which a fit starts."""
    return {f"{part}{_end(times)}": 0.0 for part in ("sine", "cosine")}


def is_amplitude(name: str) -> bool:
    """Whether a number of a ripple is a part of its size, in whatever recording and at whatever multiple."""
    return name.startswith(("sine", "cosine"))


def list_overtone_parameters(own: Sequence[EffectParameter], times: int) -> tuple[EffectParameter, ...]:
    """List the numbers of an overtone: those of the wave, in each recording."""
    waves = [parameter for parameter in own if is_amplitude(parameter.name)]
    return tuple(replace(parameter, name=f"{parameter.name}{_end(times)}") for parameter in waves)


def compute_wave(values: Mapping[str, float], position: FloatArray, recording: str = "") -> FloatArray:
    """Compute a ripple with its overtones. Shape (n,).

    Args:
        values: Numbers of the ripple.
        position: Shape (n,).
        recording: End of the names of one recording's numbers, where each has a phase of its own.
    """
    angle, wave = values["order"] * position, np.zeros_like(position)
    for times in list_multiples(values):
        sine, cosine = get_overtone(values, times, recording)
        wave += sine * np.sin(times * angle) + cosine * np.cos(times * angle)
    return wave


def get_overtone(values: Mapping[str, float], times: int, recording: str = "") -> tuple[float, float]:
    """Sine and cosine of a ripple at this multiple of its order."""
    end = recording + (_end(times) if times > 1 else "")
    return values[f"sine{end}"], values[f"cosine{end}"]


def build_ripple_terms(
    kinds: Sequence[Callable[..., Term]], values: Mapping[str, float], *further: float
) -> tuple[Term, ...]:
    """Build a ripple as terms of a law, one for each order; `further` numbers are the same in all of them."""
    return tuple(
        kind(*get_overtone(values, times), times * values["order"], *further)
        for kind, times in zip(kinds, list_multiples(values), strict=False)
    )


def _end(times: int) -> str:
    return f"_overtone_{times}"
