"""The next experiment: of a menu of motions, the one in which two explanations would differ most."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .base import BASE_NAMES
from .context import build_contexts
from .explanation import Explanation
from .observer import Contribution, Job, Observation, Plant
from .preparation import Prepared
from .problem import observer_for
from .screening import orthonormal, project_out
from .structure import N_BASE
from .track import FloatArray, Track, smooth_derivative

__all__ = ["Proposal", "propose"]

_DURATION = 40.0  # [s]
_FADE = 1.0  # [s] from rest and back to it


class Range(NamedTuple):
    """Where the recorded joint has been: the motions stay inside."""

    centre: float
    half: float
    speed: float


class Proposal(NamedTuple):
    """A motion and what it would tell.

    Attributes:
        motion: Columns time [s], position_reference, velocity_reference.
        title: What the motion is.
        difference: Predicted root mean square difference of the two explanations [N·m].
    """

    motion: dict[str, FloatArray]
    title: str
    difference: float


def propose(prepared: Prepared, one: Explanation, other: Explanation) -> Proposal | None:
    """The motion that tells `one` from `other` best; None where no motion of the menu would."""
    track = prepared.problem.tracks[0]
    reach = _range(prepared)
    best: Proposal | None = None
    for title, shape in MENU.items():
        time = np.arange(int(_DURATION / track.dt), dtype=np.float64) * track.dt
        fade = np.clip(np.minimum(time, time[-1] - time) / _FADE, 0.0, 1.0)
        position = reach.centre + shape(time, reach) * (3.0 - 2.0 * fade) * fade**2
        difference = _difference(prepared, (one, other), position)
        if best is None or difference > best.difference:
            motion = {
                "time": time,
                "position_reference": position,
                "velocity_reference": np.gradient(position, track.dt),
            }
            best = Proposal(motion, title, difference)
    return best if best is not None and best.difference > 0.0 else None


def _range(prepared: Prepared) -> Range:
    low = min(float(track.position.min()) for track in prepared.problem.tracks)
    high = max(float(track.position.max()) for track in prepared.problem.tracks)
    speed = max(float(np.quantile(np.abs(track.velocity), 0.99)) for track in prepared.problem.tracks)
    return Range(0.5 * (low + high), 0.48 * (high - low), speed)


def _difference(prepared: Prepared, pair: tuple[Explanation, Explanation], position: FloatArray) -> float:
    """What the two explanations predict differently on a motion, beyond what the base could absorb."""
    track, plant = _virtual(prepared, position)
    alone = observer_for([track], plant, prepared.problem.observer)
    (track,), (grid,) = alone.tracks, alone.grids
    seen = alone.observe([Job(track, plant, Contribution())])
    context = build_contexts(alone, plant, seen, prepared.structure.contexts[0].hints)[0]
    rows = []
    for explanation in pair:
        # By name: of several recordings some effects have parameters of their own, of which the first ones count here.
        structure, theta = explanation.structure, explanation.fit.theta
        effects = structure.contribution(context, structure.values(theta[N_BASE:]))
        run = alone.observe([Job(track, structure.plant(theta), effects)])[0]
        rows.append(grid.of(run.missing))
    basis = orthonormal(_base_columns(context.position, seen[0], plant)[grid.centres])
    left = project_out((rows[0] - rows[1])[:, None], basis)
    return float(np.sqrt(np.mean(left**2)))


def _virtual(prepared: Prepared, position: FloatArray) -> tuple[Track, Plant]:
    """The recording that the base model would give on a motion, without noise."""
    plant = prepared.structure.plant(prepared.fit.theta)
    old = prepared.problem.tracks[0]
    v = smooth_derivative(position, old.dt)
    a = smooth_derivative(v, old.dt)
    speed = np.abs(v)
    curves = []
    for coulomb, static, stribeck, viscous in (plant.forward, plant.reverse):
        curves.append(coulomb + (static - coulomb) * np.exp(-((speed / stribeck) ** 2)) + viscous * speed)
    friction = np.where(v >= 0.0, curves[0], -curves[1]) * np.tanh(speed / 1e-3)
    torque = plant.inertia * a + plant.gravity_torque(position, old.rotary) + friction
    channels: dict[str, FloatArray] = {}
    return Track.build(old.dt, position, torque, rotary=old.rotary, channels=channels, name="proposal"), plant


def _base_columns(position: FloatArray, seen: Observation, plant: Plant) -> FloatArray:
    v = seen.velocity
    a = np.gradient(v)
    columns = [np.ones_like(v), np.cos(position), np.sin(position), a]
    for sign, curve in ((1.0, plant.forward), (-1.0, plant.reverse)):
        on = np.sign(v) == sign
        columns += [on * 1.0, on * v, on * np.exp(-((v / curve[2]) ** 2))]
    assert len(columns) <= len(BASE_NAMES)
    return np.stack(columns, axis=1)


def _slow_sine(time: FloatArray, reach: Range) -> FloatArray:
    rate = min(0.2 * reach.speed / reach.half, 2 * np.pi * 0.2)
    return np.asarray(reach.half * np.sin(rate * time), dtype=np.float64)


def _fast_sine(time: FloatArray, reach: Range) -> FloatArray:
    return np.asarray(reach.half * np.sin(0.9 * reach.speed / reach.half * time), dtype=np.float64)


def _chirp(time: FloatArray, reach: Range) -> FloatArray:
    low, high = 0.1, 4.0
    rate = np.log(high / low) / time[-1]
    frequency = low * np.exp(rate * time)
    phase = 2 * np.pi * low * (np.exp(rate * time) - 1.0) / rate
    return np.asarray(np.minimum(0.5 * reach.half, reach.speed / (2 * np.pi * frequency)) * np.sin(phase))


def _small_reversals(time: FloatArray, reach: Range) -> FloatArray:
    return np.asarray(0.06 * reach.half * np.sin(2 * np.pi * 0.4 * time) * (1.0 + 3.0 * time / time[-1]))


def _staircase(time: FloatArray, reach: Range) -> FloatArray:
    speeds = reach.speed * np.geomspace(0.01, 1.0, 8)
    v = np.zeros_like(time)
    position, sign, at = 0.0, 1.0, 0
    dt = float(time[1])
    i = 0
    while at < time.size:
        speed = float(speeds[i % 8])
        length = min(time.size - at, int(min(3.0, (reach.half - sign * position) / speed * 0.95) / dt))
        if length < int(0.2 / dt):
            sign = -sign
            length = min(time.size - at, int(0.3 / dt))
        v[at : at + length] = sign * speed
        position += sign * speed * length * dt
        at, i = at + length, i + 1
        if i % 8 == 0:
            sign = -sign
    window = np.hanning(101)
    return np.clip(np.cumsum(np.convolve(v, window / window.sum(), "same")) * dt, -reach.half, reach.half)


MENU: dict[str, Callable[[FloatArray, Range], FloatArray]] = {
    "slow sine over the whole range": _slow_sine,
    "fast sine over the whole range": _fast_sine,
    "chirp from 0.1 to 4 Hz": _chirp,
    "small reversals that grow": _small_reversals,
    "speed staircase in both directions": _staircase,
}
