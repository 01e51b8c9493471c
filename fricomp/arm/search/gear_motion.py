"""How the links of an arm move otherwise than their motors on gears that have a gap, or give way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.diagnosis.effects.two_masses import CarriedLoad, Coupling, compute_twist
from fricomp.laws import FloatArray

from ..encoder_noise import clear_position
from ..fit import ArmFit
from ..friction import Filled
from ..rigid.regressor import compute_gradients, compute_mass_matrices
from ..rows import ArmRows

_FARTHEST = 1.0
"""[rad] by which no motor leads its link: teeth that are damped by more than they swing cannot be simulated at the rate
of a recording, and such a gear explains nothing."""

_UNKNOWN = 1.0
"""[s] from the start of a part in which nothing is said: on which side of a gap a load began, and how it swung, is gone
by then."""

_MASS_RATE = 8
"""Rows for each mass matrix: it changes as slowly as the joints turn."""


class Gear(NamedTuple):
    """A gear.

    Attributes:
        width: Whole free travel [rad].
        stiffness: Of teeth that touch [N·m/rad].
        damping: Of the same [N·m·s/rad].
    """

    width: float
    stiffness: float
    damping: float


class GearMotion:
    """What gears of any kind would change; it hangs on the motion and the links alone.

    Args:
        rows: Motion.
        fit: Of links that are near enough.

    Attributes:
        rotary: Whether each joint turns.
        load: Torque that the gears transmit at the rows [N·m]. Shape (n, n_joints).
        inertia: Of the load of each joint, in the middle [kg·m²]. Shape (n_joints,).
    """

    def __init__(self, rows: ArmRows, fit: ArmFit) -> None:
        sparse = np.unique(np.append(np.arange(0, len(rows), _MASS_RATE), len(rows) - 1))
        motion = rows.compare(lambda *motion: np.stack(motion, axis=1))
        position, velocity, acceleration = np.moveaxis(motion[sparse], 1, 0)
        mass = compute_mass_matrices(fit.arm, position, fit.inertia)
        slopes = compute_gradients(fit.arm, position, velocity, acceleration, fit.inertia)
        every = np.arange(len(rows))
        self._rows = rows
        self._mass, self._gradient, self._drag = (_interpolate(every, sparse, one) for one in (mass, *slopes))
        self.load, self._acceleration = fit.compute_load(rows), motion[:, 2]
        self.rotary, self.inertia = fit.arm.rotary, np.median(np.diagonal(self._mass, axis1=1, axis2=2), axis=0)
        self._carried: dict[int, list[CarriedLoad]] = {}
        self._positions: dict[tuple[int, Filled], list[FloatArray]] = {}

    def spread(self, joint: int, gear: Gear, filled: Filled) -> FloatArray:
        """Torques of all joints by how the link of one moves otherwise than its motor [N·m]. Shape (n, n_joints)."""
        return np.asarray(self._change(slice(None), joint, [gear], filled)[0])

    def change_own(self, joint: int, gears: Sequence[Gear], filled: Filled) -> FloatArray:
        """Torque of a joint by how its link moves otherwise than its motor, on each of some gears [N·m]. Shape
        (n, n_gears)."""
        return np.asarray(self._change(slice(joint, joint + 1), joint, gears, filled)[:, :, 0].T)

    def _change(self, joints: slice, joint: int, gears: Sequence[Gear], filled: Filled) -> FloatArray:
        """Torques of some joints by the gear of one: -(M s" + N s' + G s). Shape (n_gears, n, n_joints)."""
        own = slice(None), joints, joint
        parts = zip((self._gradient, self._drag, self._mass), self._follow(joint, gears, filled), strict=True)
        return np.asarray(-sum(slope[own] * moved[:, :, None] for slope, moved in parts))

    def _follow(self, joint: int, gears: Sequence[Gear], filled: Filled) -> FloatArray:
        """What the motor leads the link by at the rows [rad], and its first and second derivative [rad/s, rad/s²], on
        each gear. Shape (3, n_gears, n)."""
        rows, inertia = self._rows, float(self.inertia[joint])
        samples = [np.empty((len(time), 3, len(gears)), order="F") for time, _ in rows.clocks]
        for i, gear in enumerate(gears):
            coupling = Coupling(inertia, gear.stiffness, gear.damping, 0.5 * gear.width)
            for load, position, (time, period), own in zip(
                self._carry(joint), self._list_positions(joint, filled), rows.clocks, samples, strict=True
            ):
                twist = compute_twist(position, period, load, coupling)
                rate = np.gradient(twist, period)
                curvature = np.gradient(rate, period)
                curvature[time < time[0] + _UNKNOWN] = 0.0
                own[:, 0, i], own[:, 1, i], own[:, 2, i] = twist, rate, curvature
        whole = np.logical_and.reduce([np.all(np.abs(one[:, 0]) < _FARTHEST, axis=0) for one in samples])
        for one in samples:
            one[:, :, ~whole] = 0.0  # also where it is no number
        return np.moveaxis(rows.compare_samples(samples), 0, 2)

    def _list_positions(self, joint: int, filled: Filled) -> list[FloatArray]:
        """Where the motor of a joint was, part by part.

        Before a gap as recorded: smoothed, a motor that is let go and turns at once would cross a part of it unseen.
        Before a spring without what its encoder does not tell from noise: links that follow that noise less would be
        all that speaks for a gear that gives way.
        """
        if (joint, filled) not in self._positions:
            each = [np.ascontiguousarray(part.position[:, joint]) for part in self._rows.parts]
            if filled == "spring":
                each = [clear_position(one, part.period) for one, part in zip(each, self._rows.parts, strict=True)]
            self._positions[joint, filled] = each
        return self._positions[joint, filled]

    def _carry(self, joint: int) -> list[CarriedLoad]:
        """What hangs on a joint, part by part."""
        if joint not in self._carried:
            inertia, gradient = self._mass[:, joint, joint], self._gradient[:, joint, joint]
            rest, rows = self.load[:, joint] - inertia * self._acceleration[:, joint], self._rows
            self._carried[joint] = [
                CarriedLoad(*(np.interp(time, rows.time[here], one[here]) for one in (inertia, rest, gradient)))
                for here, (time, _) in ((rows.part == k, clock) for k, clock in enumerate(rows.clocks))
            ]
        return self._carried[joint]


def _interpolate(at: NDArray[np.intp], known: NDArray[np.intp], values: FloatArray) -> FloatArray:
    """Linear between rows that are known. Shapes (n,), (m,) and (m, n_joints, n_joints)."""
    after = np.clip(np.searchsorted(known, at), 1, len(known) - 1)
    part = ((at - known[after - 1]) / (known[after] - known[after - 1]))[:, None, None]
    return np.asarray((1.0 - part) * values[after - 1] + part * values[after])
