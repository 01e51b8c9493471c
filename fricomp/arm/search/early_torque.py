"""Whether a torque was recorded early, told from a gear that gives way.

    τ_j(t) = τ_links(t - T_l) + τ_friction(t - T_f),   T_l and T_f both below zero

A command that acts after its stamp moves all of its torque. Links on an
elastic gear follow their motor late, and ask for their torque at another time, while friction turns with the joint
whose position was recorded; with positions of the links it is friction that turns early, and links ask in time.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from fricomp.laws import FloatArray

from ..equations import ArmEquations
from ..fit import ArmFit
from ..friction import TERMS
from ..glance import Glance
from ..rows import ArmRows
from .judge import Estimate, JointJudge
from .shared_delay import is_before_most

_DELAY = "torque_delay"

_SURE = 3.5
"""Standard deviations by which both parts of a torque must be early, or differ: as many as whatever is taken in has."""


_LATE = 2.0
"""The same of what links ask for where a joint's torque is late: friction says so as well, and may say so alone."""


class EarlyTorques:
    """Which joints' torques are early beside the time that a fit has for all.

    Args:
        rows: Their times.
        equations: Of these rows.
        fit: Of these equations.
    """

    def __init__(self, rows: ArmRows, equations: ArmEquations, fit: ArmFit) -> None:
        self._rows, self._equations, self._fit = rows, equations, fit
        self.measure = cache(self._measure)

    def shows(self, joint: int, glance: Glance) -> bool:
        """Whether this joint's torque is surely before those of most others, in both of its parts, by no gear.

        Args:
            joint: Its number.
            glance: At the fit.
        """
        return (
            not self._fit.model.forms[joint].geared and is_before_most(glance, self._fit, joint) and self.holds(joint)
        )

    def holds(self, joint: int) -> bool:
        """Whether both what links ask of this joint and what rubs in it were recorded early."""
        found = self.measure(joint)
        return bool(np.all(found.values < -_SURE * found.deviations))

    def is_link_late(self, joint: int) -> bool:
        """Whether what links ask of this joint was recorded late, and not its friction alone."""
        found = self.measure(joint)
        return bool(found.values[0] > _LATE * found.deviations[0])

    def is_torn(self, joint: int) -> bool:
        """Whether links and friction of this joint surely ask for times on either side of that of all.

        A torque that is late, or early, is so in both. Friction that turns before its joint does, as where a joint
        sticks or a simulated friction acts against what would move it, makes the links look late.
        """
        found = self.measure(joint)
        sure = found.values / found.deviations
        return bool(np.min(sure) < -_LATE and np.max(sure) > _LATE)

    def are_all(self, delay: float) -> bool:
        """Whether all torques were recorded early, in what links ask for as well.

        No gear gives way, so that links and friction of each joint have one time as far as is known; and that of the
        links is surely before zero, since friction of joints that stick turns before they move.

        Args:
            delay: By how much later than the positions the fit takes them to be [s].
        """
        return all(map(self._is_one, self._measure_all())) and self._are_links_early(delay)

    def are_held(self, delay: float) -> bool:
        """Whether all torques were recorded early, and friction turns earlier still.

        Gears that give way make it the other way round: there, links ask for their torque before friction turns.

        Args:
            delay: By how much later than the positions the fit takes them to be [s].
        """
        ahead = [float(links - friction) for links, friction in (one.values for one in self._measure_all())]
        return float(np.median(ahead)) > 0.0 and self._are_links_early(delay)

    def _measure_all(self) -> list[Estimate]:
        return [self.measure(joint) for joint in range(len(self._fit.arm.joints))]

    def _are_links_early(self, delay: float) -> bool:
        """Whether what links ask for was surely recorded before the positions, in the mean of all joints."""
        found = self._measure_all()
        weights = np.array([one.deviations[0] ** -2.0 for one in found])
        links = delay + float(weights @ [one.values[0] for one in found]) / float(np.sum(weights))
        return links < -_SURE / float(np.sqrt(np.sum(weights)))

    @staticmethod
    def _is_one(found: Estimate) -> bool:
        apart = np.array([1.0, -1.0])
        return bool(abs(apart @ found.values) < _SURE * np.sqrt(apart @ found.covariance @ apart))

    def _measure(self, joint: int) -> Estimate:
        """By how much later than all the torque of the links is, and that of friction [s]. Shapes (2,)."""
        (name,) = TERMS[_DELAY].names(0)
        column = self._equations.friction_of(joint, [name])[:, 0]
        left = self._fit.residuals(self._equations)[:, joint]
        judge = JointJudge(self._equations, self._fit, joint, left, term=_DELAY, delay=False)
        links, friction = (part[:, joint] for part in self._fit.predict(self._equations))
        rubbed = friction - self._fit.friction(joint).get(name, 0.0) * column
        return judge.estimate(-np.stack([self._differentiate(part) for part in (links, rubbed)], axis=1))

    def _differentiate(self, values: FloatArray) -> FloatArray:
        rate, part = np.zeros_like(values), self._rows.part
        for k in np.unique(part):
            here, time = part == k, self._rows.time[part == k]
            rate[here] = CubicSpline(time, values[here])(time, 1) if time.size > 1 else 0.0
        return rate
