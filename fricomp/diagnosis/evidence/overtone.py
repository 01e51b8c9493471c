"""Ripples in the rhythm of a stronger one: they complete its form and are no effects of their own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..effects import EFFECTS
from ..effects.structure import Candidate
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from ..search.screening import screen
from .settings import OVERTONES


class Overtone(NamedTuple):
    """What completes the form of a stronger ripple.

    Attributes:
        name: Of the stronger ripple.
        order: Order at which its form shows [1/rad] or [1/m].
    """

    name: str
    order: float


def find_overtones(
    chosen: Explanation, energy: Mapping[str, float], span: float, does_as_well: Callable[[str, str, float], bool]
) -> dict[str, Overtone]:
    """Find the effects that only complete the form of a stronger one.

    Args:
        chosen: What was found.
        energy: That each of its effects explains.
        span: Range of the recorded position [rad] or [m].
        does_as_well: Whether, in place of the first effect, the second one's own wave at that order explains as much.
    """
    resolution = OVERTONES.wave * 2.0 * np.pi / span
    found: dict[str, Overtone] = {}
    ripples = [name for name in chosen.names if EFFECTS[name].ripple]
    values = {name: chosen.values[name] for name in ripples} if len(ripples) > 1 else {}
    for name, own in values.items():
        for other, tone in values.items():
            if other == name or energy[name] >= OVERTONES.of_its_own * energy[other]:
                continue
            times = round(own["order"] / tone["order"])
            if _is_in_rhythm(own["order"], tone["order"], resolution):
                found[name] = Overtone(other, own["order"])
            elif times > 1 and does_as_well(name, other, times * tone["order"]):
                found[name] = Overtone(other, times * tone["order"])
    return found


def is_explained_by_overtone(
    baseline: Baseline, tried: Sequence[Explanation], chosen: Explanation, name: str, other: str, order: float
) -> bool:
    """Whether a wave of `other` at `order`, which is no free parameter, explains as much as the effect `name` does.

    An effect that draws another one's overtone in a form of its own may miss its order by more than its interval.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        tried: Explanations that were refitted.
        chosen: The one that was found.
        name: Its effect in question.
        other: Its stronger ripple.
        order: A multiple of the order of that one [1/rad] or [1/m].
    """
    kept = tuple(sorted(set(chosen.names) - {name}))
    part = max((one for one in tried if one.names == kept), key=lambda one: one.gain, default=None)
    if part is None or other not in part.values:
        return False
    fit, wave = part.fit, Candidate(other, tuple(part.values[other].items())).at_order(order)
    waves = screen(baseline.problem, part.structure, fit.theta, fit.residual, fit.jacobian, [wave]).columns
    return bool(waves) and waves[0].energy >= fit.cost - chosen.fit.cost


def _is_in_rhythm(order: float, tone: float, resolution: float) -> bool:
    times = round(order / tone)
    return times >= 1 and abs(order - times * tone) < max(OVERTONES.rhythm * order, resolution)
