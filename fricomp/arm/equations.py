"""The equations of an arm as sums over rows: all that any model of it needs to be fitted, however long the recording.

    G_j = Σ_rows w Zᵀ Z,  Z = [links | rotor | friction | gears of others | lean of gravity | rate of torque | torque]

of joint j.

A fit is then a matter of small matrices, so that a hundred models cost what one pass over the rows does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

from .columns import creep_columns, friction_columns, load_columns, plain_columns, ripple_columns, stribeck_columns
from .equation_sums import EquationSums
from .friction import (
    GEARS,
    LEAST_CREEP,
    LEAST_STRIBECK,
    MOST_STRIBECK,
    STRIBECK_EXPONENTS,
    Filled,
    column_names,
    find_columns,
    is_rounded,
    list_creep_starts,
    list_stribeck_starts,
)
from .prior.sizes import TorqueSizes, measure_torques
from .rigid.simulated_arm import SimulatedArm
from .row_weights import BoolArray, Weights, weigh_rows
from .rows import ArmRows

N_LAST = 4
"""Columns behind those of friction: of gravity that leans over along two level axes, the torque's rate, the torque."""

_SLOW = 0.02
"""Speeds below this part of a joint's top speed leave its sign to noise; such rows of that joint are not compared."""

_MOST_SLOW = 0.3
"""The same where the steps of an encoder would leave out more: then friction is known as badly as they say."""


@dataclass(frozen=True)
class ArmEquations:
    """Sums over rows.

    Attributes:
        arm: The simulation.
        columns: Of each joint; torque comes last, its rate before it. Shapes (n, n_columns).
        weights: Of the rows.
        top_speed: Of each joint [rad/s] or [m/s]. Shape (n_joints,).
        own_delays: By how much later than all the torque of each joint is taken to be, where its own delay is linear
            about that [s]. Shape (n_joints,).
        ripple: Waves a radian times 2 pi in the columns of each joint's ripple; 0 for none. Shape (n_joints,).
        stribeck: Stribeck velocities [rad/s] or [m/s] and exponents in the columns of each joint. Shape (n_joints,
            n_variants, 2).
        creep: Speeds below which friction creeps in the columns of each joint [rad/s] or [m/s]. Shape (n_joints,
            n_variants).
        gears: Width of the gap [rad], stiffness [N·m/rad] and damping [N·m·s/rad] of the gear in the columns of each
            joint's gap, and of its spring; zeros for none. Shapes (n_joints, 3).
    """

    arm: SimulatedArm
    columns: tuple[FloatArray, ...]
    weights: Weights
    top_speed: FloatArray
    own_delays: FloatArray
    ripple: FloatArray
    stribeck: FloatArray
    creep: FloatArray
    gears: Mapping[Filled, FloatArray]

    @cached_property
    def sums(self) -> FloatArray:
        """G of each joint. Shape (n_joints, n_columns, n_columns)."""
        return _sum_rows(self.columns, self.weights.rows)

    @cached_property
    def torque_sizes(self) -> TorqueSizes:
        """What priors are measured in."""
        return measure_torques(self.arm, self.sums, self.top_speed)

    @cached_property
    def counts(self) -> FloatArray:
        """Rows that count, of each joint. Shape (n_joints,)."""
        return np.asarray(np.sum(self.weights.rows > 0.0, axis=0), dtype=np.float64)

    def split(self, block: NDArray[np.intp]) -> list[EquationSums]:
        """Sums over the rows of each block, so that any choice of blocks is a sum of them.

        Args:
            block: Number of the block of each row. Shape (n,).
        """
        chosen = [np.flatnonzero(block == k) for k in range(int(block.max()) + 1)]
        rows = self.weights.rows
        return [
            EquationSums(
                arm=self.arm,
                sums=_sum_rows([one[at] for one in self.columns], rows[at]),
                counts=np.sum(rows[at] > 0.0, axis=0).astype(np.float64),
                weights=self.weights,
                top_speed=self.top_speed,
            )
            for at in chosen
        ]

    def with_rows(self, kept: BoolArray) -> ArmEquations:
        """The same over some of the rows. Shape (n,), bool."""
        return replace(self, weights=replace(self.weights, rows=self.weights.rows * kept[:, None]))

    def with_links(self, rows: ArmRows, load: FloatArray, inertia: FloatArray) -> ArmEquations:
        """The same with friction that follows the load, and what leans with gravity, by what links weigh.

        Args:
            rows: Motion.
            load: That links make [N·m] or [N]. Shape (n, n_joints).
            inertia: Ten numbers of each link. Shape (n_links, 10).
        """
        sign, place = self._friction + column_names().index("coulomb"), find_columns("load")
        places = [*range(self._friction + place.start, self._friction + place.stop), *range(-N_LAST, -2)]
        leaning = rows.weigh_lean(inertia)
        values = [
            np.column_stack([load_columns(load[:, j], one[:, sign]), leaning[:, j]])
            for j, one in enumerate(self.columns)
        ]
        unsummed = replace(self)  # rows are weighed anew by what that leaves, so that no sum stays
        return unsummed._change([np.array(places) % self._width] * len(values), values)

    def with_torque(self, rows: ArmRows, own: FloatArray | None = None) -> ArmEquations:
        """The same motion with the torques of these rows.

        Args:
            rows: Motion and torques.
            own: Times about which the delay of each joint is linear, in place of those that it has [s]. Shape
                (n_joints,).
        """
        own = self.own_delays if own is None else own
        torque, rate = rows.find_torques(own) if np.any(own) else (rows.torque, rows.torque_rate)
        width, delay = self._width, self._friction + find_columns("delay").start
        places = [np.array([delay, width - 2, width - 1])] * len(self.columns)
        values = np.stack([-rate, rate, torque - own * rate], axis=2)  # by its delay, that is as early as the others
        return self._change(places, list(np.swapaxes(values, 0, 1)), own_delays=own)

    def with_ripple(self, rows: ArmRows, orders: FloatArray) -> ArmEquations:
        """The same with waves of these orders over the positions of the joints. Shape (n_joints,)."""
        waves = [ripple_columns(rows, j, order) * (order > 0.0) for j, order in enumerate(orders.tolist())]
        return self._fill("ripple", waves, ripple=orders)

    def with_gears(self, filled: Filled, gears: FloatArray, torques: FloatArray) -> ArmEquations:
        """The same with these gears.

        Args:
            filled: Which of `GEARS` they are.
            gears: Shape as those of `gears`.
            torques: By which the links ask more of each joint with the gear of each joint [N·m]. Shape (n, n_joints,
                n_joints): of joint i with the gear of joint j.
        """
        joints, own = range(len(gears)), self._friction + find_columns(filled).start
        places = [
            np.array([own if i == j else find_reached(self._friction, i, j, len(gears), filled) for j in joints])
            for i in joints
        ]
        return self._change(places, list(np.swapaxes(torques, 0, 1)), gears={**self.gears, filled: gears})

    def with_stribeck(self, rows: ArmRows, curves: FloatArray) -> ArmEquations:
        """The same with these Stribeck curves, as far as a joint can show them. Shape as `stribeck`."""
        top = self.top_speed[:, None]
        speeds = np.clip(curves[:, :, 0], LEAST_STRIBECK * top, MOST_STRIBECK * top)
        curves = np.stack([speeds, np.clip(curves[:, :, 1], *STRIBECK_EXPONENTS)], axis=2)

        def made(joint: int, variant: int) -> FloatArray:
            return stribeck_columns(rows, joint, *curves[joint, variant].tolist())

        return self._change_variants("stribeck", np.any(curves != self.stribeck, axis=2), made, stribeck=curves)

    def with_creep(self, rows: ArmRows, speeds: FloatArray) -> ArmEquations:
        """The same with friction that creeps below these speeds, as far as a joint can show them. Shape as `creep`."""
        top = self.top_speed[:, None]
        speeds = np.clip(speeds, LEAST_CREEP * top, MOST_STRIBECK * top)

        def made(joint: int, variant: int) -> FloatArray:
            return creep_columns(rows, joint, float(speeds[joint, variant]), rounded=is_rounded(variant))

        return self._change_variants("creep", speeds != self.creep, made, creep=speeds)

    def _change_variants(
        self, filled: Filled, moved: BoolArray, made: Callable[[int, int], FloatArray], **fields: Any
    ) -> ArmEquations:
        """The same with other columns of those variants of a term that moved. Shape (n_joints, n_variants)."""
        place = find_columns(filled)
        first, size = self._friction + place.start, (place.stop - place.start) // moved.shape[1]
        places, values = [], []
        for j, each in enumerate(moved):
            changed = np.flatnonzero(each)
            places.append((first + size * changed[:, None] + np.arange(size)).ravel())
            parts = [made(j, int(k)) for k in changed]
            values.append(np.concatenate(parts, axis=1) if parts else np.zeros((len(self.columns[j]), 0)))
        return self._change(places, values, **fields)

    def _fill(self, filled: Filled, values: Sequence[FloatArray], **fields: Any) -> ArmEquations:
        place = find_columns(filled)
        places = self._friction + np.arange(place.start, place.stop)
        return self._change([places] * len(values), values, **fields)

    def _change(self, places: Sequence[NDArray[np.intp]], values: Sequence[FloatArray], **fields: Any) -> ArmEquations:
        """The same with other columns in some places of each joint; sums of the others, where known, are taken over."""
        columns = []
        for one, place, value in zip(self.columns, places, values, strict=True):
            columns.append(one.copy(order="K") if place.size else one)
            columns[-1][:, place] = value
        changed = replace(self, columns=tuple(columns), **fields)
        if "sums" in self.__dict__:
            changed.__dict__["sums"] = _update_sums(self.sums, columns, self.weights.rows, places)
        return changed

    def with_residuals(
        self, residuals: FloatArray, rows: ArmRows, *, robust: bool = True, settled: bool = False
    ) -> ArmEquations:
        """The same with weights and noise as the residuals of a fit have them.

        Args:
            residuals: [N·m] or [N]. Shape (n, n_joints).
            rows: Their times.
            robust: Hold outliers down; otherwise all rows count alike, and what few of them leave counts as noise.
            settled: Rows near a reversal of their joint count by what is left of such rows. A joint that sticks has no
                sign of its velocity, and the filters spread that; but a model still to be chosen is chosen by them.
        """
        return replace(self, weights=weigh_rows(residuals, self.moving, rows, robust=robust, settled=settled))

    def friction_of(self, joint: int, names: Sequence[str]) -> FloatArray:
        """Columns of a joint's friction by their names. Shape (n, len(names))."""
        every = column_names()
        return np.asarray(self.columns[joint][:, [self._friction + every.index(name) for name in names]])

    @property
    def moving(self) -> BoolArray:
        """Rows that are compared. Shape (n, n_joints)."""
        return np.asarray(self.weights.rows > 0.0)

    @property
    def _friction(self) -> int:
        """Number of the first column of friction."""
        return self._width - count_columns(0, len(self.columns))

    @property
    def _width(self) -> int:
        return int(self.columns[0].shape[1])


def count_columns(friction: int, n_joints: int) -> int:
    """Columns of each joint, of which that many stand before those of friction."""
    return friction + len(column_names()) + len(GEARS) * (n_joints - 1) + N_LAST


def find_reached(friction: int, joint: int, other: int, n_joints: int, filled: Filled) -> int:
    """Number of the column by which what is in another joint's gear acts in this one: behind all of its friction.

    Args:
        friction: Number of the first column of friction.
        joint: Number of the joint whose column it is.
        other: Number of the other joint.
        n_joints: How many there are.
        filled: Which of `GEARS` it is.
    """
    first = friction + len(column_names()) + GEARS.index(filled) * (n_joints - 1)
    return first + (other - joint) % n_joints - 1


def build_equations(arm: SimulatedArm, rows: ArmRows, load: FloatArray, *, plain: bool = False) -> ArmEquations:
    """Set up all columns of all joints.

    Args:
        arm: The simulation.
        rows: Motion and torques.
        load: Torque that each joint transmits, for friction that follows it [N·m]. Shape (n, n_joints).
        plain: No model of more than plain friction will be fitted: the other columns stay zero.
    """
    acceleration = rows.compare(lambda _, __, a: a)
    speed = np.abs(rows.compare(lambda _, v, __: v))
    top = np.maximum(np.quantile(speed, 0.99, axis=0), 1e-9)
    n = len(arm.joints)
    first = rows.links.shape[2] + 1
    columns = [np.zeros((len(rows), count_columns(first, n)), order="F") for _ in range(n)]  # changed by the column
    place = find_columns("motion")
    for j, one in enumerate(columns):
        one[:, : first - 1], one[:, first - 1] = rows.links[:, j], acceleration[:, j]
        known = plain_columns(rows, j) if plain else friction_columns(rows, j, float(top[j]), rotary=arm.rotary[j])
        one[:, first + place.start : first + place.start + known.shape[1]] = known
    moving = (speed > np.maximum(_SLOW * top, np.minimum(rows.least_speed, _MOST_SLOW * top))).astype(np.float64)
    noise = np.maximum(np.std(rows.torque, axis=0), 1e-9)
    starts = list_stribeck_starts()
    weights, curves, creep = Weights(moving, noise, np.ones(n)), np.zeros((n, *starts.shape)), list_creep_starts()
    gears = {one: np.zeros((n, 3)) for one in GEARS}
    bare = ArmEquations(
        arm, tuple(columns), weights, top, np.zeros(n), np.zeros(n), curves, np.zeros((n, creep.size)), gears
    )
    bare = bare.with_links(rows, load, arm.inertia).with_torque(rows)
    if plain:
        return bare
    return bare.with_stribeck(rows, np.array([starts * (one, 1.0) for one in top])).with_creep(
        rows, np.outer(top, creep)
    )


def _sum_rows(columns: Sequence[FloatArray], weights: FloatArray) -> FloatArray:
    """G of each joint; a matrix times itself costs half of a product. Shape (n_joints, n_columns, n_columns)."""
    halves = [Z * np.sqrt(w)[:, None] for Z, w in zip(columns, weights.T, strict=True)]
    return np.stack([half.T @ half for half in halves])


def _update_sums(
    sums: FloatArray, columns: Sequence[FloatArray], weights: FloatArray, places: Sequence[NDArray[np.intp]]
) -> FloatArray:
    """G of each joint where only some columns changed: a tenth of the work where a few did. Shape as `sums`."""
    result = sums.copy()
    for one, Z, w, place in zip(result, columns, weights.T, places, strict=True):
        products = Z.T @ (Z[:, place] * w[:, None])
        one[:, place], one[place] = products, products.T
    return result
