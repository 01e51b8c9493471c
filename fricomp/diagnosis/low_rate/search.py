"""Which effects the torque in the band shows: one at a time, as long as each lowers the error on data left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.evaluation import RecordedMotion
from fricomp.model import FrictionModel

from ..inputs.rigid import RigidJoint
from ..record.result import Rival
from .held_out import Fitted, compute_fall, fit_held_out, is_better, measure_level, read_number
from .models import (
    Candidate,
    add_drag,
    add_spring,
    bend_curve,
    leave_out,
    list_candidates,
    replace_delay,
    replace_gravity,
)
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


def _refine_delay(
    model: FrictionModel, motion: RecordedMotion, period: float, about: float = 0.0, held: tuple[str, ...] = ()
) -> Fitted:
    """The fit with the delay that leaves the least on data left out, within half a period of `about` [s]."""
    fit = _fit_delays(model, motion, [about + period * one for one in LOW_RATE.usual_delays], held)
    for step in LOW_RATE.delay_steps:
        own = read_number(fit.model, "torque_delay")
        near = np.clip([own - step * period, own, own + step * period], about - 0.5 * period, about + 0.5 * period)
        fit = _fit_delays(fit.model, motion, near.tolist(), held)
    return fit


def _fit_delays(model: FrictionModel, motion: RecordedMotion, delays: Sequence[float], held: tuple[str, ...]) -> Fitted:
    """The fit with the delay that leaves the least on data left out."""
    return min((fit_held_out(replace_delay(model, one), motion, held) for one in delays), key=lambda fit: fit.rms)


def fit_plain_joint(plain: FrictionModel, motion: RecordedMotion, period: float) -> Fitted:
    """The joint that effects are looked for beside; its friction falls from rest where that lowers the error on data
    left out enough.

    Args:
        plain: Coulomb and viscous friction, inertia and gravity, to start from.
        motion: What is fitted.
        period: Of the samples [s].
    """
    base = _refine_delay(plain, motion, period)
    bent = _refine_delay(bend_curve(base.model), motion, period, held=("symmetric_stribeck.stribeck_exponent",))
    curve = Candidate("", bent.model, (), LOW_RATE.matters)
    if not _is_worth(curve, (base, bent), 0.0):
        return base
    # A drag bends the curve with one number where this one needs two.
    drag = fit_held_out(add_drag(base, motion).model, motion)
    return base if drag.rms**2 <= (1.0 + LOW_RATE.alike) * bent.rms**2 else bent


def choose_effects(
    base: Fitted, motion: RecordedMotion, period: float, repeats: float, given: RigidJoint | None
) -> Found:
    """Add the effect that lowers the held-out error most, as long as one does enough.

    Args:
        base: The plain joint.
        motion: What was recorded, in its band.
        period: Of the rows [s].
        repeats: Part of the rows in motion whose position is that of the one before.
        given: The simulation; None where there is none.
    """
    level = measure_level(base, motion)
    sprung = None if given is None else _find_spring(base, motion, given, level)
    fits, named = ([base], []) if sprung is None else ([sprung[0], sprung[2]], [sprung[1]])
    rivals: list[Rival] = []
    about = 0.0
    while True:
        late = all(one.name != "torque_delay" for one in named)
        good = []
        for one in list_candidates(fits[-1], motion, period, may_be_late=late):
            fit = fit_held_out(one.model, motion, one.held)
            fall, _, _ = compute_fall(fits[-1], fit)
            worth = _is_worth(one, (fits[-1], fit), level)
            rivals.append(Rival(effects=(one.name,), gain=fall, refused="" if worth else _SMALL))
            good += [(fall, one, fit)] if worth else []
        if not good:
            return Found(repeats, tuple(fits), tuple(named), _keep_best_of_each(rivals))
        best, fit = _choose_simplest(good)
        named.append(best)
        about = read_number(fit.model, "torque_delay") if best.name == "torque_delay" else about
        fits.append(_refine_delay(fit.model, motion, period, about, fit.held))
        fits, named = _leave_out_needless(fits, named, motion, level)


def _choose_simplest(good: Sequence[tuple[float, Candidate, Fitted]]) -> tuple[Candidate, Fitted]:
    """Of the effects that leave about as little as the best, that of the fewest numbers, with the others' names.

    Args:
        good: Part of the held-out energy that each takes, the effect, and its fit.
    """
    most = (1.0 + LOW_RATE.alike) * min(1.0 - fall for fall, _, _ in good)
    near = [one for one in good if 1.0 - one[0] <= most]
    _, best, fit = min(near, key=lambda one: (len(one[1].numbers), -one[0]))
    others = dict.fromkeys(one.name for _, one, _ in near if one.name != best.name)
    return replace(best, alike=tuple(others)), fit


def _leave_out_needless(
    fits: list[Fitted], named: list[Candidate], motion: RecordedMotion, level: float
) -> tuple[list[Fitted], list[Candidate]]:
    """The fits and what each adds, without an earlier one that stood in for the last: beside it, it takes nothing."""
    for k, one in enumerate(named[:-1]):
        less = fit_held_out(leave_out(fits[-1].model, one.name), motion, fits[-1].held)
        if not _is_worth(one, (less, fits[-1]), level):
            rest, steps = named[:k] + named[k + 1 :], [less]
            for later in reversed(rest[k + 1 :]):
                steps.insert(0, fit_held_out(leave_out(steps[0].model, later.name), motion, less.held))
            return fits[: k + 1] + steps, rest
    return fits, named


def _find_spring(
    base: Fitted, motion: RecordedMotion, given: RigidJoint, level: float
) -> tuple[Fitted, Candidate, Fitted] | None:
    """A spring beside the simulation's gravity, the fit without it and that with it, where it leaves no more than
    another gravity does: over a short range the two bend alike, and a simulation is not departed from without need."""
    held = (*base.held, "gravity_cosine", "gravity_sine")
    own = fit_held_out(replace_gravity(base.model, given), motion, held)
    spring = add_spring(own, motion)
    fit = fit_held_out(spring.model, motion, spring.held)
    if fit.rms > base.rms or not _is_worth(spring, (own, fit), level):
        return None
    as_well = base.rms**2 <= (1.0 + LOW_RATE.alike) * fit.rms**2
    return own, replace(spring, alike=("payload_error",) if as_well else ()), fit


def _is_worth(one: Candidate, fits: tuple[Fitted, Fitted], level: float) -> bool:
    """Whether an effect lowers the error enough, nearly everywhere, and is none that fits make of nothing.

    Args:
        one: The effect.
        fits: Without it and with it.
        level: Of the sliding friction [N·m].
    """
    before, after = fits
    size = float(np.sqrt(max(before.rms**2 - after.rms**2, 0.0)))
    own = [name for name in one.numbers if name in after.model.law.parameters() and not name.endswith("order")]
    sizes = [abs(read_number(after.model, name)) for name in own]
    strays = [LOW_RATE.certain * after.deviation(name) for name in own]
    known = not own or float(np.hypot.reduce(sizes)) > float(np.hypot.reduce(strays))
    return is_better(before, after, one.matters) and known and size >= LOW_RATE.of_friction * one.shown * level


def _keep_best_of_each(rivals: Sequence[Rival]) -> tuple[Rival, ...]:
    """The best try of each effect, best first."""
    best: dict[tuple[str, ...], Rival] = {}
    for one in sorted(rivals, key=lambda rival: -rival.gain):
        best.setdefault(one.effects, one)
    return tuple(best.values())
