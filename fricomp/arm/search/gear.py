"""Gears of an arm that have a gap, or give way: how wide or how stiff one is, is read off what a fit leaves.

    M_jj s" = τ_l - G_jj s - K dz(s, gap) - c s',   torques of all joints change by -M_ij s" - G_ij s

where s is what the motor leads the link by, τ_l what the rigid gear would transmit, and G its gradient by the position
[nordin2002, spong1987]: the simulation of a single joint's gear, on what the arm's dynamics ask for. The position is
the motor's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from ..equations import ArmEquations
from ..fit import ArmFit
from ..friction import TERMS, Filled
from ..glance import Glance
from ..prior import ArmPrior
from .gear_motion import Gear, GearMotion
from .judge import JointJudge, JointJudges

YIELDING_GEAR = "joint_elasticity"
"""Name of the term of a gear that gives way."""

GAP = "backlash"
"""Name of the term of a gear with a gap."""

_WIDTHS = tuple(3e-4 * 2.0 ** (0.5 * k) for k in range(13))
"""[rad] or [m] that a search starts from, up to 19 mrad; between two of them the time to cross differs by an eighth."""

_RATES = (60.0, 120.0, 240.0, 480.0)
"""[1/s] at which the mean load swings on teeth that touch: from gears that are hardly stiffer than a loop that holds
an arm to those whose swings no row shows."""

_YIELDING = tuple(8.0 * 2.0 ** (0.25 * k) for k in range(21))
"""[1/s] of the same on a gear without a gap that gives way, up to 256: a stiffer one changes next to nothing. A load
that is hardly damped swings on for several periods after each stop, and with twice the steps between two of them none
was in time with it."""

_START_SPREAD = 0.3
"""Standard deviation of the factor on what a gear that gives way changes, about one, as long as it is one to start
from: a swing that is not quite in time explains a part of what it will."""

_DAMPING = 0.2
"""Damping ratio of that swing to start from."""

_ROUNDS, _FEWER = 5, 2
"""Of refining a gear, each with half of the steps of the one before; and those of one that the fit has already."""

_FIRST_STEPS = {"width": 2.0**0.5, "stiffness": 2.0, "damping": 2.0}
"""Ratios by which the width, the stiffness and the damping are first moved."""

_EVIDENCE = 6.0
"""By how much a gap must be more probable than teeth that always touch, and a gear that gives way than one that does
not: half a difference of weighted squares."""

_TURNS = 2
"""Least changes of sign of the transmitted torque: a gear that is always pulled one way does not show its gap."""

_HALF_CHI_SQUARE, _STEP, _WIDEST = 1.92, 1.02, 2.0
"""Half of the 95 % point of χ² of one number, the step in which its ends are looked for, and how far they are."""

_SWUNG = 0.1
"""Part of what a gear explains that is of a swing at least, where the swing tells its stiffness: what links have wrong
about gears on which nothing swings moves it by some hundredths."""

_MOST_SHARE = 2.0
"""Ratio by which a stiffness follows the factor on what its gear changes at once: further off, it is another gear."""

_TEETH_POWER = 0.5
"""Power of the first steps by which stiffness and damping follow a width on the way to its ends."""


@dataclass(frozen=True)
class _Kind:
    """What is looked for.

    Attributes:
        term: Its name.
        starts: Widths [rad], and rates at which the mean load swings [1/s], that a search starts from.
        refined: Numbers of a gear that are moved.
        told: The one that is told.
        turns: Least changes of sign of the transmitted torque.
        near: The same as `spread` of a gear to start from, which is only near the one that is looked for.
        spread: Standard deviation of the factor on what a gear changes about one, which the law has; any may stand in
            for a width that lies between two. Below its swing a gear gives way by its load over its stiffness, so that
            any factor would do for that; and what it changes is computed to some hundredths.
    """

    term: str
    starts: tuple[tuple[float, float], ...]
    refined: tuple[str, ...]
    told: str
    turns: int
    near: float
    spread: float


_KINDS: dict[Filled, _Kind] = {
    "gap": _Kind(GAP, tuple(product((0.0, *_WIDTHS), _RATES)), Gear._fields, "width", _TURNS, np.inf, np.inf),
    "spring": _Kind(
        YIELDING_GEAR,
        tuple((0.0, rate) for rate in _YIELDING),
        ("stiffness", "damping"),
        "stiffness",
        0,
        _START_SPREAD,
        0.03,
    ),
}


class _Tried(NamedTuple):
    """A gear, and how much it lowers half the weighted squares by its best factor."""

    gear: Gear
    gain: float


class GearSearch:
    """Looks for gears of one kind in what fits leave of the torques.

    Args:
        motion: Of all joints.
        filled: Whether gears with a gap are looked for, or those that give way.
    """

    def __init__(self, motion: GearMotion, filled: Filled) -> None:
        self._motion, self._filled, self._kind = motion, filled, _KINDS[filled]
        turns = np.sum(np.diff(np.sign(motion.load), axis=0) != 0, axis=0)
        self._joints = [j for j, rotary in enumerate(motion.rotary) if rotary and turns[j] >= self._kind.turns]
        self._starts: dict[int, tuple[list[Gear], FloatArray]] = {}
        self._settled: dict[int, Gear] = {}  # as the last fit asked for them; another term moves them little

    def follow(self, motion: GearMotion) -> GearSearch:
        """The same search on what gears change beside other links, from where gears were found to be.

        Args:
            motion: Of all joints.
        """
        other = GearSearch(motion, self._filled)
        other._settled = self._settled
        return other

    def propose(self, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, judge: JointJudges) -> ArmEquations:
        """The equations with a gear in the columns of each joint: that which explains most of what is left of it.

        That of the joint in which one explains most is refined, and so are those that the fit has already.

        Args:
            equations: Of these rows.
            fit: Of these equations.
            prior: How far the simulation is trusted.
            judge: Of what the fit leaves of each joint.
        """
        name = self._kind.term
        has = {j for j in self._joints if name in fit.model.forms[j].names}
        judges = {j: judge.get(j, name if j in has else None) for j in self._joints}
        found = {j: one for j in self._joints if j not in has and (one := self._choose(judges[j], j)).gain > 0.0}
        known = {j: _Tried(Gear(*equations.gears[self._filled][j].tolist()), 1.0) for j in has}
        if self._kind.spread < np.inf:
            for j, one in known.items():  # it stands where the factor is of a swing, which follows no stiffness
                self._settled.setdefault(j, one.gear)
            known = {j: one._replace(gear=self._take_share(one.gear, fit, j)) for j, one in known.items()}
            new = found.keys() - self._settled.keys()
            settled = self._settle(equations, fit, prior, found | known, _ROUNDS if new else _FEWER)
            inertia = self._motion.inertia
            gears = {j: one for j, one in settled.items() if j in has or swings(one.gear, float(inertia[j]))}
            return self._fill(equations, gears)
        first = max(found, key=lambda j: found[j].gain, default=None)
        if first is not None:
            found[first] = self._refine(judges[first], first, found[first].gear, _ROUNDS)
        for j, one in known.items():
            found[j] = self._refine(judges[j], j, one.gear, _FEWER)
        return self._fill(equations, found)

    def _take_share(self, gear: Gear, fit: ArmFit, joint: int) -> Gear:
        """The stiffness that does without a factor what a fit has of a gear with one: it bends by load over stiffness.

        What was taken in since then may ask for another one, and the factor follows it.
        """
        (name,) = TERMS[self._kind.term].names(0)
        share = min(max(fit.friction(joint)[name], 1.0 / _MOST_SHARE), _MOST_SHARE)
        return gear._replace(stiffness=gear.stiffness / share)

    def build(self, equations: ArmEquations, gears: FloatArray) -> ArmEquations:
        """The equations with gears that are known, none where all of one is zero. Shape (n_joints, 3)."""
        return self._fill(equations, {j: _Tried(Gear(*one.tolist()), 1.0) for j, one in enumerate(gears) if one[1]})

    def _fill(self, equations: ArmEquations, found: Mapping[int, _Tried]) -> ArmEquations:
        n = len(equations.columns)
        gears, torques = np.zeros((n, 3)), np.zeros((*self._motion.load.shape, n))
        for j, one in found.items():
            if one.gain > 0.0:
                gears[j] = one.gear
                torques[:, :, j] = self._motion.spread(j, one.gear, self._filled)
        return equations.with_gears(self._filled, gears, torques)

    def _settle(
        self, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, found: Mapping[int, _Tried], rounds: int
    ) -> dict[int, _Tried]:
        """Gears as all joints together ask for them, each by itself, and how probable each makes the recording.

        A joint feels the gear of another one too: by its own torque alone, that of a neighbour explains as much.
        """
        best = self._weigh(equations, fit, prior, {j: one.gear for j, one in found.items()})
        if best.keys() & self._settled.keys():
            before = {j: self._settled.get(j, one.gear) for j, one in best.items()}
            again = self._weigh(equations, fit, prior, before)
            best = {j: max(one, again[j], key=lambda each: each.gain) for j, one in best.items()}
        for k in range(_ROUNDS - rounds, _ROUNDS) if best else ():
            for name, factor in _list_factors(self._kind.refined, 0.5**k):
                moved = {j: one.gear._replace(**{name: factor * getattr(one.gear, name)}) for j, one in best.items()}
                tried = self._weigh(equations, fit, prior, moved)
                best = {j: max(one, tried[j], key=lambda each: each.gain) for j, one in best.items()}
        self._settled |= {j: one.gear for j, one in best.items()}
        return best

    def _weigh(
        self, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, gears: Mapping[int, Gear]
    ) -> dict[int, _Tried]:
        """How much more probable than none each of these gears makes the recording, with a factor near one."""
        tried = {j: _Tried(gear, 1.0) for j, gear in gears.items()}
        if not tried:
            return tried
        glance, name = Glance(self._fill(equations, tried), fit, prior), self._kind.term
        for j, gear in gears.items():
            rigid = fit.model.forms[j].without_term(name)
            without, model = (fit.model.with_form(j, form) for form in (rigid, rigid.with_term(name, 0)))
            away = (glance.solve(model).friction(j)[TERMS[name].names(0)[0]] - 1.0) / self._kind.spread
            gain = glance.measure_gain(model) - glance.measure_gain(without)
            tried[j] = _Tried(gear, gain - 0.5 * float(away) ** 2)
        return tried

    def _choose(self, judge: JointJudge, joint: int) -> _Tried:
        """The gear that explains most; of no gain where none does better than one that is said to be none of the kind:
        teeth that always touch are no gap."""
        gears, own = self._build_starts(joint)
        gains = judge.measure_gains(own, self._kind.near).tolist()
        tried = [_Tried(*pair) for pair in zip(gears, gains, strict=True)]
        best = max(tried, key=lambda one: one.gain)
        touching = (one.gain for one in tried if one.gear.width == 0.0 and self._filled == "gap")
        return best if best.gain > max(touching, default=0.0) + _EVIDENCE else best._replace(gain=0.0)

    def _refine(self, judge: JointJudge, joint: int, gear: Gear, rounds: int) -> _Tried:
        """Move one number at a time for as long as that explains more."""
        best = self._measure(judge, joint, gear)
        for k in range(_ROUNDS - rounds, _ROUNDS):
            for name, factor in _list_factors(self._kind.refined, 0.5**k):
                moved = best.gear._replace(**{name: factor * getattr(best.gear, name)})
                best = max(best, self._measure(judge, joint, moved), key=lambda each: each.gain)
        return best

    def _measure(self, judge: JointJudge, joint: int, gear: Gear) -> _Tried:
        own = self._motion.change_own(joint, [gear], self._filled)
        return _Tried(gear, float(judge.measure_gains(own, self._kind.spread)[0]))

    def bound(self, equations: ArmEquations, fit: ArmFit, joint: int) -> tuple[float, float]:
        """Width or stiffness on both sides of that of a gear, at which it explains less by what its interval allows.

        Args:
            equations: Of these rows.
            fit: Of these equations.
            joint: Number of the joint.
        """
        judge, gear = self._judge(equations, fit, joint)
        best = self._measure(judge, joint, gear)
        return self._find_end(judge, joint, best, 1.0 / _STEP), self._find_end(judge, joint, best, _STEP)

    def is_told_by_swing(self, equations: ArmEquations, fit: ArmFit, joint: int) -> bool:
        """Whether the time in which the load of a joint swings tells how stiff its gear is, and not how far it bends.

        Then one that bends as far by a factor of one explains less by far. Arguments as for `bound`.
        """
        judge, gear = self._judge(equations, fit, joint)
        bending = self._measure(judge, joint, self._take_share(gear, fit, joint))
        return bending.gain < (1.0 - _SWUNG) * self._measure(judge, joint, gear).gain - _HALF_CHI_SQUARE

    def _judge(self, equations: ArmEquations, fit: ArmFit, joint: int) -> tuple[JointJudge, Gear]:
        """The judge of a joint without its gear, and that."""
        left = fit.residuals(equations)[:, joint]
        gear = Gear(*equations.gears[self._filled][joint].tolist())
        return JointJudge(equations, fit, joint, left, term=self._kind.term), gear

    def _find_end(self, judge: JointJudge, joint: int, best: _Tried, ratio: float) -> float:
        """The first that explains less than the interval allows, on steps of a ratio, with other numbers that suit."""
        told, least, now = self._kind.told, best.gain - _HALF_CHI_SQUARE, best
        value = start = float(getattr(best.gear, told))
        others = [name for name in ("stiffness", "damping") if name != told]
        while now.gain >= least and 1.0 / _WIDEST < value / start < _WIDEST:
            value *= ratio
            moved = now.gear._replace(**{told: value})
            pairs = _list_factors(others, _TEETH_POWER)
            around = [moved, *(moved._replace(**{name: by * getattr(moved, name)}) for name, by in pairs)]
            now = max((self._measure(judge, joint, one) for one in around), key=lambda one: one.gain)
        return value

    def _build_starts(self, joint: int) -> tuple[list[Gear], FloatArray]:
        """Gears to start from, and what each changes in its joint [N·m]. Shape (n, n_gears)."""
        if joint not in self._starts:
            inertia = float(self._motion.inertia[joint])
            gears = [_build_gear(inertia, *start, _DAMPING) for start in self._kind.starts]
            self._starts[joint] = gears, self._motion.change_own(joint, gears, self._filled)
        return self._starts[joint]


def swings(gear: Gear, inertia: float) -> bool:
    """Whether a load swings on a gear that gives way, and faster than on the softest that is tried.

    Gears are damped by some hundredths of what is critical. What follows the load without a swing is a torque that
    lags, or friction that does: a real arm had a gear of 334 N·m/rad, damped by twice the critical, for it.

    Args:
        gear: Of a joint.
        inertia: Of the load [kg·m²].
    """
    rate = float(np.sqrt(gear.stiffness / inertia))
    return rate > _YIELDING[0] and gear.damping < 2.0 * rate * inertia


def _build_gear(inertia: float, width: float, rate: float, ratio: float) -> Gear:
    """Teeth on which a load of this inertia [kg·m²] swings at a rate [1/s], damped by a ratio."""
    return Gear(width, inertia * rate**2, 2.0 * ratio * inertia * rate)


def _list_factors(names: Sequence[str], power: float) -> Iterator[tuple[str, float]]:
    """Numbers of a gear, each with the factors by which it is moved: the first steps to a power."""
    for name in names:
        yield from ((name, _FIRST_STEPS[name] ** way) for way in (power, -power))
