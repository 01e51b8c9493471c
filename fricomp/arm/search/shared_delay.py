"""The time by which the torques of all joints are late, as far as the joints agree on one.

A gear that gives way, or friction that is not taken in yet, moves the delay that its joint asks for, and a mean over
all joints with it: three of six joints whose motion an elastic gear bends made it 8 ms in place of none.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from fricomp.laws import FloatArray

from ..coordinates import ArmModel
from ..equations import ArmEquations
from ..fit import ArmFit
from ..glance import Glance
from ..prior import ArmPrior

_OWN = "torque_delay"
"""The term by which a joint has a delay of its own."""

_SHOWN = 0.5
"""Of the prior deviation, below which a joint says something of its delay."""

_CHANCE = 0.05
"""Probability by which joints that have one delay differ by too much to be taken to agree."""

_LEAST_SEEN = 1.0 / 3.0
"""Part of a delay that a look at it sees at least: by a smaller one a step would be mostly noise."""

_FEW, _FAR = 3, 10.0
"""Joints of which two that agree are no majority by themselves, and standard deviations by which the third has to be
apart: that of a gear that gives way was so by 5, of a joint that sticks by 60."""

_SURE, _SURE_APART = 2.0, 3.5
"""Standard deviations that a delay must have to be allowed for, where joints agree, and where they do not: then as many
as anything that is taken in, odds of e⁶."""

_NORMAL, _MEDIAN = 1.4826, 1.2533
"""Standard deviation of a normal distribution over its median absolute deviation; of a median over that of a mean."""


class SharedDelay(NamedTuple):
    """What all joints say together.

    Attributes:
        value: By how much the torques are late [s].
        deviation: Its standard deviation [s].
        apart: Delay that each joint asks for by its number [s], where they do not agree.
        spread: Largest standard deviation of these [s].
        is_torn: Whether they differ as surely as anything that is taken in.
    """

    value: float
    deviation: float
    apart: dict[int, float]
    spread: float = 0.0
    is_torn: bool = False

    @property
    def is_sure(self) -> bool:
        """Whether it is allowed for."""
        return abs(self.value) >= (_SURE_APART if self.apart else _SURE) * self.deviation

    def move(self, before: float, more: float) -> SharedDelay:
        """The same, of which `more` is taken off beside what was taken off before [s]."""
        apart = {joint: before + one for joint, one in self.apart.items()}
        return self._replace(value=before + more, apart=apart)

    def take_least(self) -> SharedDelay:
        """The time by which every joint is late at least, where all of them surely are; else none.

        Joints that differ leave their median unsure, and one that is late beside the others makes few of them differ by
        much: none at all would be further from each. Torques that look early seldom are.
        """
        least = min(self.apart.values(), default=0.0)
        return self._replace(value=least if least > _SURE_APART * self.spread else 0.0)


def measure_delay(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> SharedDelay:
    """By how much the torques are later than the rows allow for.

    That of the fit where the joints agree on it; else the median of those that they ask for, each by itself: of most
    joints where most agree, since one that sticks, or is late by itself, says nothing of the others.
    """
    glance = Glance(equations, fit, prior)
    joints, delays, spread = _ask_joints(fit, glance)
    shown = spread < _SHOWN * prior.delay
    delays, spread = delays[shown], spread[shown]
    if agree(delays, spread):
        return SharedDelay(*glance.solve(replace(fit.model, prompt=False)).delay, {})
    apart = dict(zip(joints[shown].tolist(), delays.tolist(), strict=True))
    torn = not agree(delays, spread, 2.0 * float(norm.sf(_SURE_APART)))
    kept = find_agreeing(delays, spread)
    return SharedDelay(*take_median(delays[kept], spread[kept]), apart, float(np.max(spread)), torn)


def agree(values: FloatArray, spread: FloatArray, chance: float = _CHANCE) -> bool:
    """Whether values with these standard deviations may all be of one thing [dersimonian1986].

    Args:
        values: Shape (n,).
        spread: Shape (n,).
        chance: Probability by which such values differ by more than may be.
    """
    if values.size < 2:
        return True
    weights = spread**-2.0
    away = values - weights @ values / np.sum(weights)
    return bool(weights @ away**2 < chi2.isf(chance, values.size - 1))


def find_agreeing(values: FloatArray, spread: FloatArray) -> NDArray[np.intp]:
    """Places of most values where most may be of one thing, without those that are furthest from the rest; else of all.
    Two of three agree by chance, and count where the third is far away.

    Args:
        values: Shape (n,).
        spread: Their standard deviations. Shape (n,).
    """
    kept = np.arange(values.size)
    while 2 * kept.size > values.size:
        own, weights = values[kept], spread[kept] ** -2.0
        if agree(own, spread[kept]):
            return kept
        others = np.sum(weights) - weights
        away = np.abs(own - (weights @ own - weights * own) / others) / np.sqrt(1.0 / weights + 1.0 / others)
        if kept.size <= _FEW and np.max(away) < _FAR:
            break
        kept = np.delete(kept, np.argmax(away))
    return np.arange(values.size)


def is_before_most(glance: Glance, fit: ArmFit, joint: int) -> bool:
    """Whether a joint asks for a delay that is surely less than what most joints ask for."""
    joints, delays, spread = _ask_joints(replace(fit, model=fit.model.without_terms(joint, _OWN)), glance)
    middle = float(np.median(delays))
    return float(delays[joints == joint][0]) < middle - _SURE_APART * _measure_width(delays, spread)


def are_others_early(glance: Glance, fit: ArmFit, joint: int) -> bool:
    """Whether all joints but this one surely ask for torques that are early; then nobody knows what they have in
    common, since they are taken to be prompt, and this one may be as late as all of them."""
    joints, delays, spread = _ask_joints(fit, glance)
    others = joints != joint
    return bool(np.any(others)) and bool(np.all(delays[others] < -_SURE_APART * spread[others]))


def share_delays(model: ArmModel) -> ArmModel:
    """The model without delays of single joints where most joints have one: then it is one of all."""
    own = [j for j, form in enumerate(model.forms) if _OWN in form.names]
    for j in own if 2 * len(own) > len(model.forms) else ():
        model = model.without_terms(j, _OWN)
    return model


def measure_seen(more: float, before: float, moved: float) -> float:
    """Part of a delay that a look at it sees, since there is noise in the rate of the torque; by a secant.

    Args:
        more: What it still asks for [s].
        before: What it asked for until it was moved [s].
        moved: By how much it was [s]; 0 where it was not yet.
    """
    fall = (before - more) / moved if moved else 1.0
    return min(max(fall, _LEAST_SEEN), 1.0)


def take_median(values: FloatArray, spread: FloatArray) -> tuple[float, float]:
    """Their median, and its standard deviation: by what they differ, and by what each is known to at least."""
    return float(np.median(values)), _MEDIAN * _measure_width(values, spread) / float(np.sqrt(values.size))


def _measure_width(values: FloatArray, spread: FloatArray) -> float:
    """Standard deviation of most values, whatever the others are, and that of one of them at least."""
    return max(_NORMAL * float(np.median(np.abs(values - np.median(values)))), float(np.median(spread)))


def _ask_joints(fit: ArmFit, glance: Glance) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Numbers of joints without a delay of their own, the delay that each asks for, and its deviation [s]."""
    forms = fit.model.forms
    joints = [j for j, form in enumerate(forms) if _OWN not in form.names]
    wider = tuple(form.with_term(_OWN, 0) if j in joints else form for j, form in enumerate(forms))
    each = glance.solve(replace(fit.model, forms=wider))
    pick = np.zeros((len(joints), each.x.size))
    pick[:, -2] = 1.0  # of the delay of all
    for row, j in zip(pick, joints, strict=True):
        place, names = each.find_friction(j)
        row[place.start + names.index(f"{_OWN}.delay.0")] = 1.0
    return np.array(joints), pick @ each.x, np.sqrt(np.diag(pick @ each.covariance @ pick.T))
