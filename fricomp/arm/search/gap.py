"""Gaps in the gears of an arm: how wide one is, and how hard its teeth are, is read off what a fit leaves.

    M_jj s" = τ_l - K dz(s, gap) - c s',   torques of all joints change by -M_ij s"

where s is what the motor leads the link by, and τ_l what the rigid gear would transmit [nordin2002]: the simulation of
a single joint's gap, on what the arm's dynamics ask for. The position is the motor's.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.diagnosis.effects.two_masses import CarriedLoad, Coupling, compute_twist
from fricomp.laws import FloatArray

from ..equations import ArmEquations
from ..fit import ArmFit
from ..friction import TERMS
from ..rigid.regressor import compute_mass_matrices
from ..rows import ArmRows
from .judge import JointJudge

__all__ = ["GapSearch"]

_GAP = next(term for term in TERMS.values() if term.filled == "gap")
"""The term whose columns are made here."""

_WIDTHS = tuple(3e-4 * 2.0 ** (0.5 * k) for k in range(13))
"""[rad] or [m] that a search starts from, up to 19 mrad; between two of them the time to cross differs by an eighth."""

_RATES = (60.0, 120.0, 240.0, 480.0)
"""[1/s] at which the mean load swings on teeth that touch: from gears that are hardly stiffer than a loop that holds
an arm to those whose swings no row shows."""

_DAMPING = 0.2
"""Damping ratio of that swing to start from."""

_ROUNDS = 5
"""Of refining a width and its teeth, each with half of the steps of the one before."""

_FIRST_STEPS = (2.0**0.5, 2.0, 2.0)
"""Ratios by which the width, the stiffness and the damping are first moved."""

_EVIDENCE = 6.0
"""By how much a gap must be more probable than teeth that always touch: half a difference of weighted squares."""

_TURNS = 2
"""Least changes of sign of the transmitted torque: a gear that is always pulled one way does not show its gap."""

_HALF_CHI_SQUARE, _WIDTH_STEP, _WIDEST = 1.92, 1.02, 2.0
"""Half of the 95 % point of χ² of one number, the step in which its ends are looked for, and how far they are."""

_TEETH_POWER = 0.5
"""Power of the first steps by which stiffness and damping follow a width on the way to its ends."""

_FARTHEST = 1.0
"""[rad] by which no motor leads its link: teeth that are damped by more than they swing cannot be simulated at the rate
of a recording, and such a gear explains nothing."""

_UNKNOWN = 1.0
"""[s] from the start of a part in which nothing is said: on which side of a gap a load began, and how it swung, is gone
by then."""

_MASS_RATE = 8
"""Rows for each mass matrix: it changes as slowly as the joints turn."""


class Gap(NamedTuple):
    """A gear.

    Attributes:
        width: Whole free travel [rad].
        stiffness: Of teeth that touch [N·m/rad].
        damping: Of the same [N·m·s/rad].
    """

    width: float
    stiffness: float
    damping: float


class _Tried(NamedTuple):
    """A gear, and how much it lowers half the weighted squares by its best factor."""

    gap: Gap
    gain: float


class GapSearch:
    """Looks for gaps in what fits leave of the torques.

    What gears of all kinds would change is computed once, for it hangs on the motion and the links alone.

    Args:
        rows: Motion.
        fit: Of links that are near enough.
    """

    def __init__(self, rows: ArmRows, fit: ArmFit) -> None:
        self._rows = rows
        position = rows.compare(lambda q, _, __: q)
        sparse = np.unique(np.append(np.arange(0, len(rows), _MASS_RATE), len(rows) - 1))
        mass = compute_mass_matrices(fit.arm, position[sparse], fit.inertia)
        self._mass = _interpolate(np.arange(len(rows)), sparse, mass)
        self._load, self._acceleration = fit.compute_load(rows), rows.compare(lambda _, __, a: a)
        turns = np.sum(np.diff(np.sign(self._load), axis=0) != 0, axis=0)
        self._joints = [j for j, rotary in enumerate(fit.arm.rotary) if rotary and turns[j] >= _TURNS]
        self._starts: dict[int, tuple[list[Gap], FloatArray]] = {}

    def propose(self, equations: ArmEquations, fit: ArmFit) -> ArmEquations:
        """The equations with a gap in the columns of each joint, of the width that explains most of what is left of it.

        That of the joint in which one explains most is refined, and so are those that the fit has already.

        Args:
            equations: Of these rows.
            fit: Of these equations.
        """
        n, left = len(fit.arm.joints), fit.residuals(equations)
        judges = {j: JointJudge(equations, fit, j, left[:, j], term=_GAP.name) for j in self._joints}
        has = {j for j in self._joints if _GAP.name in fit.model.forms[j].names}
        found = {j: self._choose(judges[j], j) for j in self._joints if j not in has}
        first = max(found, key=lambda j: found[j].gain, default=None)
        for j in has:
            found[j] = self._refine(judges[j], j, Gap(*equations.gaps[j].tolist()), _ROUNDS // 2)
        if first is not None and found[first].gain > 0.0:
            found[first] = self._refine(judges[first], first, found[first].gap, _ROUNDS)
        gaps, torques = np.zeros((n, 3)), np.zeros((len(self._rows), n, n))
        for j, one in found.items():
            if one.gain > 0.0:
                gaps[j] = one.gap
                torques[:, :, j] = self._spread(j, self._follow(j, one.gap))
        return equations.with_gaps(gaps, torques)

    def _choose(self, judge: JointJudge, joint: int) -> _Tried:
        """The gear that explains most; of no gain where none does better than one whose teeth always touch."""
        gears, own = self._build_starts(joint)
        tried = [_Tried(*pair) for pair in zip(gears, judge.measure_gains(own).tolist(), strict=True)]
        best = max(tried, key=lambda one: one.gain)
        closed = max(one.gain for one in tried if one.gap.width == 0.0)
        return best if best.gain > closed + _EVIDENCE else best._replace(gain=0.0)

    def _refine(self, judge: JointJudge, joint: int, gap: Gap, rounds: int) -> _Tried:
        """Move one number at a time for as long as that explains more."""
        best = self._measure(judge, joint, gap)
        for k in range(_ROUNDS - rounds, _ROUNDS):
            for one in _list_moves(best.gap, 0.5**k):
                best = max(best, self._measure(judge, joint, one), key=lambda each: each.gain)
        return best

    def _measure(self, judge: JointJudge, joint: int, gap: Gap) -> _Tried:
        own = -self._mass[:, joint, joint] * self._follow(joint, gap)
        return _Tried(gap, float(judge.measure_gains(own[:, None])[0]))

    def bound_width(self, equations: ArmEquations, fit: ArmFit, joint: int) -> tuple[float, float]:
        """Widths on both sides of a gap that the fit has, at which it explains less by what its 95 % interval allows.

        Args:
            equations: Of these rows.
            fit: Of these equations.
            joint: Number of the joint.
        """
        judge = JointJudge(equations, fit, joint, fit.residuals(equations)[:, joint], term=_GAP.name)
        gap = Gap(*equations.gaps[joint].tolist())
        best = self._measure(judge, joint, gap)
        return self._find_end(judge, joint, best, 1.0 / _WIDTH_STEP), self._find_end(judge, joint, best, _WIDTH_STEP)

    def _find_end(self, judge: JointJudge, joint: int, best: _Tried, ratio: float) -> float:
        """The first width that explains less than the interval allows, on steps of a ratio, with teeth that suit it."""
        gap, least, now = best.gap, best.gain - _HALF_CHI_SQUARE, best
        while now.gain >= least and 1.0 / _WIDEST < now.gap.width / gap.width < _WIDEST:
            wider = now.gap._replace(width=now.gap.width * ratio)
            around = [wider, *(one for one in _list_moves(wider, _TEETH_POWER) if one.width == wider.width)]
            now = max((self._measure(judge, joint, one) for one in around), key=lambda one: one.gain)
        return now.gap.width

    def _build_starts(self, joint: int) -> tuple[list[Gap], FloatArray]:
        """Gears to start from, and what each changes in its joint [N·m]. Shape (n, n_gears)."""
        if joint not in self._starts:
            inertia = float(np.median(self._mass[:, joint, joint]))
            gears = [_build_gap(inertia, width, rate, _DAMPING) for width, rate in product((0.0, *_WIDTHS), _RATES)]
            curvatures = np.stack([self._follow(joint, one) for one in gears], axis=1)
            self._starts[joint] = gears, -self._mass[:, joint, joint, None] * curvatures
        return self._starts[joint]

    def _spread(self, joint: int, curvature: FloatArray) -> FloatArray:
        """Torques of all joints by how the link of one moves otherwise than its motor [N·m]. Shape (n, n_joints)."""
        return np.asarray(-self._mass[:, :, joint] * curvature[:, None])

    def _follow(self, joint: int, gap: Gap) -> FloatArray:
        """Second derivative of what the motor leads the link by, at the rows [rad/s²]. Shape (n,)."""
        inertia, rows = self._mass[:, joint, joint], self._rows
        rest = self._load[:, joint] - inertia * self._acceleration[:, joint]
        coupling = Coupling(float(np.median(inertia)), gap.stiffness, gap.damping, 0.5 * gap.width)
        curvatures = []
        for k, ((position, _, __), (time, period)) in enumerate(zip(rows.motion, rows.clocks, strict=True)):
            here = rows.part == k
            mass, torque = (np.interp(time, rows.time[here], one[here]) for one in (inertia, rest))
            load = CarriedLoad(mass, torque, np.zeros(time.size))
            twist = compute_twist(np.ascontiguousarray(position[:, joint]), period, load, coupling)
            if not np.all(np.abs(twist) < _FARTHEST):  # nor where it is no number
                return np.zeros(len(rows))
            curvature = np.gradient(np.gradient(twist, period), period)
            curvature[time < time[0] + _UNKNOWN] = 0.0
            curvatures.append(curvature)
        return rows.compare_samples(curvatures)


def _build_gap(inertia: float, width: float, rate: float, ratio: float) -> Gap:
    """Teeth on which a load of this inertia [kg·m²] swings at a rate [1/s], damped by a ratio."""
    return Gap(width, inertia * rate**2, 2.0 * ratio * inertia * rate)


def _list_moves(gap: Gap, power: float) -> Iterator[Gap]:
    """Gears that differ in one number, by the first steps to a power."""
    for k, step in enumerate(_FIRST_STEPS):
        for factor in (step**power, step**-power):
            yield gap._replace(**{gap._fields[k]: gap[k] * factor})


def _interpolate(at: NDArray[np.intp], known: NDArray[np.intp], values: FloatArray) -> FloatArray:
    """Linear between rows that are known. Shapes (n,), (m,) and (m, n_joints, n_joints)."""
    after = np.clip(np.searchsorted(known, at), 1, len(known) - 1)
    part = ((at - known[after - 1]) / (known[after] - known[after - 1]))[:, None, None]
    return np.asarray((1.0 - part) * values[after - 1] + part * values[after])
