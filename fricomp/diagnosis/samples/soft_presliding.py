"""Presliding so soft that it fills much of the motion: a bristle driven by the recorded position, in the samples.

Where the travel of a joint is a few times its breakaway distance the base model bends its viscous friction and its
gravity into the loop, and the search starts from there. Here the bristle is driven by the position itself, and is
held against everything that has no memory: friction over speed, any torque over position, inertia.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricomp.laws import FrictionLaw, LuGre, StribeckCurve
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..inputs.track import FloatArray, differentiate, find_encoder_step
from ..joint.kernel import compile_kernel
from .fine_ripple import predict_left_out_blocks
from .settings import PRESLIDING


@dataclass(frozen=True)
class SoftPresliding:
    """A soft bristle. Arrays of shape (n_samples,).

    Attributes:
        distance: Travel over which the bristle builds up, F_c / sigma_0 [rad] or [m].
        distance_error: Standard deviation of its logarithm, from blocks left out.
        level: F_c [N·m] or [N].
        level_error: Its standard deviation.
        viscous: F_v forward and reverse [N·m·s/rad].
        errors: Held-out RMS error [N·m] of "stiff" (a bristle of the base), "memoryless" and "presliding".
        samples: Time, position, velocity, acceleration of the samples, by name.
        before: Held-out error of the better explanation without memory [N·m].
        after: Held-out error with the bristle [N·m].
    """

    distance: float
    distance_error: float
    level: float
    level_error: float
    viscous: tuple[float, float]
    errors: dict[str, float]
    samples: dict[str, FloatArray]
    before: FloatArray
    after: FloatArray

    @property
    def law(self) -> FrictionLaw:
        """The bristle as a friction law."""
        forward, reverse = (StribeckCurve(self.level, self.level, 1.0, max(one, 0.0)) for one in self.viscous)
        return FrictionLaw((LuGre(forward, reverse, sigma_0=self.level / self.distance, sigma_1=0.0),))


@compile_kernel
def simulate_bristle(position: np.ndarray, distance: float) -> np.ndarray:
    """Deflection of a Dahl bristle as part of the largest, for a driven joint [dahl1968]. Shape (n,)."""
    out = np.zeros_like(position)
    for k in range(1, position.shape[0]):
        step = position[k] - position[k - 1]
        end = 1.0 if step > 0.0 else -1.0
        out[k] = end + (out[k - 1] - end) * np.exp(-abs(step) / distance)
    return out


def find_soft_presliding(recording: Recording) -> SoftPresliding | None:
    """The bristle that explains blocks left out far better than anything without memory; None where none does."""
    motion = _Motion.read(recording)
    stiff, softest = motion.find_limits(recording)
    if softest < PRESLIDING.range * stiff:
        return None
    firm = [motion.leave_out(float(d)) for d in np.geomspace(PRESLIDING.firm * stiff, stiff, PRESLIDING.firm_distances)]
    without = min([*firm, motion.leave_out(stiff, memoryless=True)], key=compute_rms)
    distances, tried = motion.find_nearest(np.geomspace(stiff, softest, PRESLIDING.distances))
    if distances is None or compute_rms(tried) > (1.0 - PRESLIDING.least_fall) * min(
        compute_rms(without), motion.spread
    ):
        return None
    if not _wins_most_blocks(without, tried):
        return None
    everything = compute_rms(motion.leave_out(float(distances[1]), memoryless=True))
    if compute_rms(without) ** 2 - compute_rms(tried) ** 2 < PRESLIDING.covered * (
        compute_rms(without) ** 2 - everything**2
    ):
        return None
    errors = {
        "stiff": min(map(compute_rms, firm)),
        "memoryless": compute_rms(without),
        "presliding": compute_rms(tried),
    }
    distance, deviation = motion.estimate_distance(distances)
    level, level_error, viscous = motion.estimate_levels(distance)
    if level <= 0.0:
        return None
    samples = motion.list_samples()
    return SoftPresliding(distance, deviation, level, level_error, viscous, errors, samples, without, tried)


@dataclass(frozen=True)
class _Motion:
    """A uniform recording; `keep` are the samples that are fitted."""

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    torque: FloatArray
    keep: np.ndarray

    @classmethod
    def read(cls, recording: Recording) -> _Motion:
        dt = recording.sample_period
        t = np.asarray(recording.time) - recording.time[0]
        grid = np.arange(int(t[-1] / dt) + 1, dtype=np.float64) * np.float64(dt)
        position, torque = (np.interp(grid, t, one) for one in (recording.position, recording.torque))
        velocity = differentiate(position, dt)
        acceleration = differentiate(velocity, dt)
        return cls(
            grid,
            position,
            velocity,
            acceleration,
            torque,
            np.arange(0, grid.size, 1 + grid.size // PRESLIDING.most_samples),
        )

    @property
    def spread(self) -> float:
        """Standard deviation of the torque [N·m]."""
        return float(np.std(self.torque[self.keep]))

    def find_limits(self, recording: Recording) -> tuple[float, float]:
        """Shortest and longest breakaway distance that are looked for."""
        travel = float(np.ptp(self.position))
        step = recording.metadata.encoder_resolution or find_encoder_step(self.position)
        stiff = PRESLIDING.stiff if recording.metadata.motion == "rotary" else PRESLIDING.stiff_share * travel
        return max(stiff, PRESLIDING.stiff_steps * step), PRESLIDING.softest * travel

    def build_table(self, distance: float, memoryless: bool = False) -> FloatArray:
        """Columns at the samples kept: the bristle first, then viscous friction of both directions. Shape (n, d)."""
        k = self.keep
        z, v, q = simulate_bristle(self.position, distance)[k], self.velocity[k], self.position[k]
        top = float(np.quantile(np.abs(v), PRESLIDING.top))
        x = 2.0 * (q - q.mean()) / np.ptp(q)
        columns = [z, v * (v > 0.0), v * (v < 0.0), np.ones_like(v), self.acceleration[k], x, x**2, x**3]
        columns += [np.exp(-((v / (f * top)) ** 2)) * z for f in PRESLIDING.stribeck]
        if memoryless:
            knots = np.linspace(-1.0, 1.0, PRESLIDING.knots)
            speed = np.sign(v) * np.sqrt(np.minimum(np.abs(v) / top, 1.0))
            columns += [np.interp(u, knots, one) for u in (speed, x) for one in np.eye(PRESLIDING.knots)[1:]]
        return np.column_stack(columns)

    def leave_out(self, distance: float, memoryless: bool = False) -> FloatArray:
        """Error on blocks that the fit did not use [N·m]. Shape (n_kept,)."""
        table = self.build_table(distance, memoryless)
        return predict_left_out_blocks(table / np.maximum(np.linalg.norm(table, axis=0), 1e-12), self.torque[self.keep])

    def find_nearest(self, distances: FloatArray) -> tuple[FloatArray | None, FloatArray]:
        """Three distances about the best one, and its error; None where the best one is at an end of the range."""
        for zoom in (True, False):
            tried = [self.leave_out(float(d)) for d in distances]
            best = int(np.argmin([compute_rms(error) for error in tried]))
            if not 1 <= best < distances.size - 1:
                return None, tried[best]
            around, error = distances[best - 1 : best + 2], tried[best]
            distances = np.geomspace(around[0], around[2], PRESLIDING.finer) if zoom else around
        return distances, error

    def estimate_distance(self, around: FloatArray) -> tuple[float, float]:
        """Distance at the vertex between three, and the deviation of its logarithm."""
        torque, tables = self.torque[self.keep], [self.build_table(float(d)) for d in around]
        found = []
        for part in [np.array([], dtype=int), *np.array_split(np.arange(torque.size), PRESLIDING.folds)]:
            kept = np.delete(np.arange(torque.size), part)
            fits = [
                t[kept] @ np.linalg.lstsq(t[kept], torque[kept], rcond=PRESLIDING.rank)[0] - torque[kept]
                for t in tables
            ]
            found.append(_find_vertex(np.log(around), np.array([compute_rms(one) for one in fits])))
        return float(np.exp(found[0])), float(np.sqrt((PRESLIDING.folds - 1) * np.var(found[1:])))

    def estimate_levels(self, distance: float) -> tuple[float, float, tuple[float, float]]:
        """F_c with its deviation over blocks, and viscous friction of both directions, without Stribeck columns."""
        table, torque = self.build_table(distance)[:, :8], self.torque[self.keep]
        whole = np.linalg.lstsq(table, torque, rcond=PRESLIDING.rank)[0]
        drawn = [
            np.linalg.lstsq(np.delete(table, part, axis=0), np.delete(torque, part), rcond=PRESLIDING.rank)[0][0]
            for part in np.array_split(np.arange(torque.size), PRESLIDING.folds)
        ]
        deviation = float(np.sqrt((PRESLIDING.folds - 1) * np.var(drawn)))
        return float(whole[0]), deviation, (float(whole[1]), float(whole[2]))

    def list_samples(self) -> dict[str, FloatArray]:
        """The samples kept, by name."""
        return {name: getattr(self, name)[self.keep] for name in ("time", "position", "velocity", "acceleration")}


def _wins_most_blocks(before: FloatArray, after: FloatArray) -> bool:
    """Whether the error falls as far as it must on most of the blocks that were left out."""
    pairs = zip(np.array_split(before, PRESLIDING.folds), np.array_split(after, PRESLIDING.folds), strict=True)
    won = [compute_rms(last) <= (1.0 - PRESLIDING.least_fall) * compute_rms(first) for first, last in pairs]
    return float(np.mean(won)) >= PRESLIDING.won


def _find_vertex(at: FloatArray, values: FloatArray) -> float:
    """Minimum of the parabola through three points, kept between the outer ones."""
    bend = values[0] - 2.0 * values[1] + values[2]
    shift = 0.5 * (values[0] - values[2]) / bend if bend > 0.0 else 0.0
    return float(at[1] + np.clip(shift, -1.0, 1.0) * (at[1] - at[0]))
