"""Ripples in the rhythm of a stronger one: the form of that one, which is no sine, not effects of their own."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .explanation import Explanation

__all__ = ["overtones"]

_RIPPLES = ("cogging", "encoder_eccentricity", "kinematic_error", "position_coulomb")
# Part of an order, and of a wave over the recorded range, by which an overtone may miss a multiple: short ranges tell
# orders no better. Part of the energy of the other, from which a ripple counts.
_RHYTHM, _WAVE, _OF_ITS_OWN = 0.01, 0.25, 0.5


def overtones(chosen: Explanation, energy: Mapping[str, float], span: float) -> dict[str, tuple[str, float]]:
    """Effects that complete the form of a stronger one, by the name of that one, and their order.

    Args:
        chosen: What was found.
        energy: That each of its effects explains.
        span: Range of the recorded position [rad] or [m].
    """
    resolution = _WAVE * 2.0 * np.pi / span
    found: dict[str, tuple[str, float]] = {}
    values = {name: chosen.values[name] for name in chosen.names if name in _RIPPLES} if len(chosen.names) > 1 else {}
    for name, own in values.items():
        for other, tone in values.items():
            weaker = energy[name] < _OF_ITS_OWN * energy[other]
            if other != name and weaker and _in_rhythm(own["order"], tone["order"], resolution):
                found[name] = (other, own["order"])
    return found


def _in_rhythm(order: float, tone: float, resolution: float) -> bool:
    times = round(order / tone)
    return times >= 1 and abs(order - times * tone) < max(_RHYTHM * order, resolution)
