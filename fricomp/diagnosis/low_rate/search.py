"""Which effects the torque in the band shows: one at a time, as long as each lowers the error on data left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.evaluation import RecordedMotion
from fricomp.model import FrictionModel
from fricomp.root_mean_square import compute_rms

from ..record.result import Rival
from .held_out import Fitted, compute_fall, fit_held_out, read_number
from .models import Candidate, list_candidates, replace_delay
from .settings import LOW_RATE

_SMALL = "it lowers the error on data left out by too little, or not in most blocks of time"


@dataclass(frozen=True)
class Found:
    """The fits from the plain joint to the answer, and what was weighed.

    Attributes:
        repeats: Part of the rows in motion whose position is that of the one before.
        fits: The first is of the plain joint; each further one has one effect more.
        named: The effect that each further fit has.
        rivals: What was tried.
    """

    repeats: float
    fits: tuple[Fitted, ...]
    named: tuple[Candidate, ...] = ()
    rivals: tuple[Rival, ...] = ()

    @property
    def base(self) -> Fitted:
        """The plain joint."""
        return self.fits[0]

    @property
    def last(self) -> Fitted:
        """The answer."""
        return self.fits[-1]

    @property
    def is_held(self) -> bool:
        """Whether readings come more slowly than the rows: what they are late by looks like physics."""
        return self.repeats > LOW_RATE.repeated

    @property
    def steps(self) -> list[tuple[Candidate, Fitted, Fitted]]:
        """Each effect that was named, with the fit without it and the one with it."""
        return list(zip(self.named, self.fits[:-1], self.fits[1:], strict=True))


def refine_delay(model: FrictionModel, motion: RecordedMotion, period: float, about: float = 0.0) -> Fitted:
    """The fit with the delay that leaves the least on data left out, within half a period of `about` [s]."""
    fit = _fit_delays(model, motion, [about + period * one for one in LOW_RATE.usual_delays])
    for step in LOW_RATE.delay_steps:
        own = read_number(fit.model, "torque_delay")
        near = np.clip([own - step * period, own, own + step * period], about - 0.5 * period, about + 0.5 * period)
        fit = _fit_delays(fit.model, motion, near.tolist())
    return fit


def _fit_delays(model: FrictionModel, motion: RecordedMotion, delays: Sequence[float]) -> Fitted:
    """The fit with the delay that leaves the least on data left out."""
    return min((fit_held_out(replace_delay(model, one), motion) for one in delays), key=lambda fit: fit.rms)


def choose_effects(base: Fitted, motion: RecordedMotion, period: float, repeats: float) -> Found:
    """Add the effect that lowers the held-out error most, as long as one does enough.

    Args:
        base: The plain joint.
        motion: What was recorded, in its band.
        period: Of the rows [s].
        repeats: Part of the rows in motion whose position is that of the one before.
    """
    fits: list[Fitted] = [base]
    named: list[Candidate] = []
    rivals: list[Rival] = []
    about, level = 0.0, _measure_level(base, motion)
    while True:
        late = all(one.name != "torque_delay" for one in named)
        good = []
        for one in list_candidates(fits[-1], motion, period, may_be_late=late):
            fit = fit_held_out(one.model, motion)
            fall, _, _ = compute_fall(fits[-1], fit)
            worth = _is_worth(one, (fits[-1], fit), level)
            rivals.append(Rival(effects=(one.name,), gain=fall, refused="" if worth else _SMALL))
            good += [(fall, one, fit)] if worth else []
        if not good:
            return Found(repeats, tuple(fits), tuple(named), _keep_best_of_each(rivals))
        _, best, fit = max(good, key=lambda one: one[0])
        named.append(best)
        about = read_number(fit.model, "torque_delay") if best.name == "torque_delay" else about
        fits.append(refine_delay(fit.model, motion, period, about))


def _is_worth(one: Candidate, fits: tuple[Fitted, Fitted], level: float) -> bool:
    """Whether an effect lowers the error enough, nearly everywhere, and is none that fits make of nothing.

    Args:
        one: The effect.
        fits: Without it and with it.
        level: Of the sliding friction [N·m].
    """
    before, after = fits
    fall, agreed, ends = compute_fall(before, after)
    size = float(np.sqrt(max(before.rms**2 - after.rms**2, 0.0)))
    sure = fall >= one.matters and agreed >= LOW_RATE.agreeing and ends[0] > 0.0
    own = [name for name in one.numbers if name in after.model.law.parameters() and not name.endswith("order")]
    sizes = [abs(read_number(after.model, name)) for name in own]
    strays = [LOW_RATE.certain * after.deviation(name) for name in own]
    known = not own or float(np.hypot.reduce(sizes)) > float(np.hypot.reduce(strays))
    return sure and known and size >= LOW_RATE.of_friction * level


def _measure_level(base: Fitted, motion: RecordedMotion) -> float:
    """Size of the sliding friction over the motion [N·m]."""
    speed = np.concatenate([part.smooth_velocity[part.moves] for part in motion.parts])
    return compute_rms(np.asarray(base.model.torque(speed)))


def _keep_best_of_each(rivals: Sequence[Rival]) -> tuple[Rival, ...]:
    """The best try of each effect, best first."""
    best: dict[tuple[str, ...], Rival] = {}
    for one in sorted(rivals, key=lambda rival: -rival.gain):
        best.setdefault(one.effects, one)
    return tuple(best.values())
