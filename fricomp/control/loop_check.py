"""Is this loop safe with this compensation? Asked before a joint is enabled."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fricomp.control.choice import choose_settings
from fricomp.control.curve import FrictionCurves, split_law
from fricomp.control.limit_cycle import LIMIT_CYCLE_MARGIN, find_oscillation, steady_speeds
from fricomp.control.loop_simulation import LoopCases, simulate_loop
from fricomp.control.settings import CompensationSettings, LoopDynamics
from fricomp.errors import ParameterError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

__all__ = ["GainScan", "LoopCheck", "check_loop"]

# Times the gain in use; densest where the margin is decided.
_GAINS = (0.0, 0.2, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0, 1.05, 1.1, 1.15, 1.2, 1.3, 1.5, 1.75, 2.0, 2.5)
_SIMULATED_TIME = 1.5  # [s]
_STILL = 1e-9  # travel that is rounding [rad] or [m]


@dataclass(frozen=True)
class GainScan:
    """At which gains of the compensation the loop oscillates. Arrays have shape (n_gains,).

    Attributes:
        gain: From 0 to 2.5 times the gain in use [1].
        predicted: Whether the describing function lets an oscillation grow.
        simulated: Whether the simulated loop kept oscillating.
        swing: Largest swing of the simulated velocity around its reference, over that reference [1].
    """

    gain: FloatArray
    predicted: FloatArray
    simulated: FloatArray
    swing: FloatArray

    def limit_from(self, gain: float, *, simulated: bool) -> float:
        """Lowest gain from `gain` on that oscillates; infinity if none of the scan does [1]."""
        oscillates = self.simulated if simulated else self.predicted
        found = self.gain[(self.gain >= gain - 1e-9) & (oscillates > 0.5)]
        return float(found[0]) if len(found) else float("inf")


@dataclass(frozen=True)
class LoopCheck:
    """What was found.

    Attributes:
        settings: The compensation that was checked.
        loop: The loop around it.
        scan: Over the gain.
        predicted_limit: Gain at which the describing function lets an oscillation grow [1].
        simulated_limit: Gain from which the simulated loop oscillates [1].
        margin: The lower of both over the gain in use, minus one; infinity if none was found [1].
        safe_gain: Largest gain that keeps a margin of 15 % [1]; 0 where none does.
        sticks_without: Whether the loop oscillates with no compensation at all.
        drift: Travel at rest over the last three quarters of a simulated stop [rad] or [m].
    """

    settings: CompensationSettings
    loop: LoopDynamics
    scan: GainScan
    predicted_limit: float
    simulated_limit: float
    margin: float
    safe_gain: float
    sticks_without: bool
    drift: float

    @property
    def is_safe(self) -> bool:
        """Whether the gain in use keeps a margin of 15 % and the joint stays where it was stopped."""
        return self.margin >= LIMIT_CYCLE_MARGIN - 1.0 - 1e-9 and self.drift < _STILL


def check_loop(
    model: FrictionModel,
    loop: LoopDynamics,
    settings: CompensationSettings | None = None,
    *,
    period: float = 1e-3,
    velocity_quantum: float = 0.0,
) -> LoopCheck:
    """Predict by describing function and confirm by simulation where the loop starts to oscillate.

    Args:
        model: Friction of the joint, taken as true.
        loop: The position loop.
        settings: Of the compensation; those that fit model and loop if None.
        period: Control period [s].
        velocity_quantum: Step of the measured velocity [rad/s] or [m/s].

    Raises:
        ParameterError: The loop has no stiffness, or the model is dynamic.
    """
    if loop.stiffness <= 0.0:
        raise ParameterError("the loop check needs a position loop: its stiffness must be positive")
    curves = replace(split_law(model.law), bristle=None)
    chosen = settings or choose_settings(model, loop=loop, velocity_quantum=velocity_quantum)
    gains = (chosen.gain or 1.0) * np.array(_GAINS)
    predicted = find_oscillation(curves, loop, chosen, gains).at_gains.astype(np.float64)
    swing = _simulate_swing(curves, loop, chosen, gains, period, velocity_quantum)
    scan = GainScan(gains, predicted, (swing > 0.5).astype(np.float64), swing)
    limits = [scan.limit_from(chosen.gain, simulated=kind) for kind in (False, True)]
    limit = min(limits)
    return LoopCheck(
        settings=chosen,
        loop=loop,
        scan=scan,
        predicted_limit=limits[0],
        simulated_limit=limits[1],
        margin=limit / chosen.gain - 1.0 if chosen.gain > 0.0 else float("inf"),
        safe_gain=_safe_gain(scan),
        sticks_without=bool(scan.predicted[0] > 0.5 or scan.simulated[0] > 0.5),
        drift=_simulate_drift(curves, loop, chosen, period, velocity_quantum),
    )


def _safe_gain(scan: GainScan) -> float:
    """The highest gain from which neither finding oscillates up to 15 % above it; 0 where there is none."""
    clean = (scan.predicted < 0.5) & (scan.simulated < 0.5)
    ends = [k for k in range(len(clean)) if clean[k] and (k + 1 == len(clean) or not clean[k + 1])]
    for end in reversed(ends):
        start = end
        while start > 0 and clean[start - 1]:
            start -= 1
        safe = float(scan.gain[end]) / LIMIT_CYCLE_MARGIN
        if safe >= scan.gain[start]:
            return safe
    return 0.0


def _simulate_swing(
    curves: FrictionCurves,
    loop: LoopDynamics,
    settings: CompensationSettings,
    gains: FloatArray,
    period: float,
    velocity_quantum: float,
) -> FloatArray:
    """Largest swing of velocity over its reference, at the end of a run at each steady speed. Shape (n_gains,)."""
    speeds = steady_speeds(curves, settings)[1:]
    gain, speed = (grid.ravel() for grid in np.meshgrid(gains, speeds, indexing="ij"))
    cases = LoopCases(
        loop, gain, np.ones_like(gain), np.full_like(gain, loop.delay), velocity_quantum, loop.velocity_filter
    )
    time = np.arange(0.0, _SIMULATED_TIME, period)[:, None]
    done = simulate_loop(
        curves, settings, cases, (speed * time, speed + 0.0 * time), period=period, start_velocity=1.2 * speed
    )
    last = done.velocity[-len(time) // 3 :]
    swing = (last.max(axis=0) - last.min(axis=0)) / np.abs(speed)
    return np.asarray(swing.reshape(len(gains), -1).max(axis=1), dtype=np.float64)


def _simulate_drift(
    curves: FrictionCurves, loop: LoopDynamics, settings: CompensationSettings, period: float, velocity_quantum: float
) -> float:
    """Travel after a stop, from speeds of both directions: zero unless the compensation moves a resting joint."""
    speeds = steady_speeds(curves, settings)
    cases = LoopCases(
        loop,
        np.full_like(speeds, settings.gain),
        np.ones_like(speeds),
        np.full_like(speeds, loop.delay),
        velocity_quantum,
        loop.velocity_filter,
    )
    still = np.zeros(int(_SIMULATED_TIME / period))
    done = simulate_loop(curves, settings, cases, (still, still), period=period, start_velocity=speeds)
    return float(np.max(np.abs(done.position[-1] - done.position[len(still) // 4])))
