"""Is this loop safe with this compensation? Asked before a joint is enabled."""

from dataclasses import dataclass, replace
from math import inf
from typing import Any, NamedTuple

import numpy as np

from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.curve import FrictionCurves
from fricomp.control.compensation.limit_cycle import LIMIT_CYCLE_MARGIN, find_oscillation, steady_speeds
from fricomp.control.compensation.trust import trusted_curves
from fricomp.control.loop.loop_simulation import LoopCases, SimulatedLoop, simulate_loop
from fricomp.control.settings import NO_LIMITS, CompensationSettings, DriveLimits, LoopDynamics
from fricomp.errors import ParameterError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

# Times the gain in use; densest where the margin is decided.
_GAINS = (0.0, 0.2, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0, 1.05, 1.1, 1.15, 1.2, 1.3, 1.5, 1.75, 2.0, 2.5)
_SIMULATED_TIME = 1.5  # [s]
_STILL = 1e-9  # travel that is rounding [rad] or [m]
_OFFSETS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5)  # off the reference at the start [rad] or [m]
_STOPPED_TIME = 3.0  # [s]
_CALM = 0.1  # speed at the end over the largest that counts as settled [1]


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
        drift: Travel over the last third of a simulated stop [rad] or [m].
        drive: Limits of the drive that the simulations kept to.
        unsettled_from: Distance to the reference at the start from which the joint keeps oscillating; infinity if it
            settles from every one that was tried, up to 0.5 [rad] or [m].
        unsettled_without: The same without compensation.
        left_out: What the check does not know of the law: terms beside the curve, the bristle of a dynamic law, whose
            curve of steady sliding is checked, and the lag of friction.
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
    drive: DriveLimits
    unsettled_from: float
    unsettled_without: float
    left_out: tuple[str, ...]

    @property
    def is_safe(self) -> bool:
        """Whether the gain in use keeps a margin of 15 % and the joint comes to rest where it is stopped."""
        return self.margin >= LIMIT_CYCLE_MARGIN - 1.0 - 1e-9 and self.drift < _STILL


def check_loop(
    model: FrictionModel,
    loop: LoopDynamics,
    settings: CompensationSettings | None = None,
    *,
    period: float = 1e-3,
    velocity_quantum: float = 0.0,
    drive: DriveLimits | None = None,
) -> LoopCheck:
    """Predict by describing function and confirm by simulation where the loop starts to oscillate.

    The simulations keep to the drive's limits, which the describing function does not know.

    Args:
        model: Friction of the joint, taken as true.
        loop: The position loop.
        settings: Of the compensation; those that fit model and loop if None.
        period: Control period [s].
        velocity_quantum: Step of the measured velocity [rad/s] or [m/s].
        drive: Limits of the torque; none if None.

    Raises:
        ParameterError: The loop has no stiffness, the law leaves nothing to compensate, or period or quantum are out of
            their domain.
    """
    if not 0.0 < period < inf:
        raise ParameterError(f"the period must be finite and above 0 s, got {period!r}")
    if not 0.0 <= velocity_quantum < inf:
        raise ParameterError(f"the step of the velocity must be finite and at least 0, got {velocity_quantum!r}")
    if loop.stiffness <= 0.0:
        raise ParameterError("the loop check needs a position loop: its stiffness must be positive")
    known = trusted_curves(model)
    curves = replace(known, bristle=None)
    chosen = settings or choose_settings(model, loop=loop, velocity_quantum=velocity_quantum)
    gains = (chosen.gain or 1.0) * np.array(_GAINS)
    predicted = find_oscillation(curves, loop, chosen, gains).at_gains.astype(np.float64)
    bench = _Bench(curves, loop, chosen, period, velocity_quantum, drive or NO_LIMITS)
    swing, stop = bench.swing(gains), bench.stop()
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
        safe_gain=_find_safe_gain(scan),
        sticks_without=bool(scan.predicted[0] > 0.5 or scan.simulated[0] > 0.5),
        drift=stop.drift,
        drive=bench.drive,
        unsettled_from=stop.unsettled_from,
        unsettled_without=stop.unsettled_without,
        left_out=_list_left_out(known),
    )


def _list_left_out(curves: FrictionCurves) -> tuple[str, ...]:
    state = {"bristle": curves.bristle is not None, "lag of friction": curves.lag > 0.0}
    return (*(term.name for term in curves.extra), *(name for name, has in state.items() if has))


def _find_safe_gain(scan: GainScan) -> float:
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


class _Stop(NamedTuple):
    """How the joint comes to rest; see `LoopCheck`."""

    drift: float
    unsettled_from: float
    unsettled_without: float


@dataclass(frozen=True)
class _Bench:
    """One loop, ready to be simulated in many cases."""

    curves: FrictionCurves
    loop: LoopDynamics
    settings: CompensationSettings
    period: float
    velocity_quantum: float
    drive: DriveLimits

    def swing(self, gains: FloatArray) -> FloatArray:
        """Largest swing of velocity over its reference, at the end of a run at each steady speed. Shape (n_gains,)."""
        speeds = steady_speeds(self.curves, self.settings)[1:]
        gain, speed = (grid.ravel() for grid in np.meshgrid(gains, speeds, indexing="ij"))
        time = np.arange(0.0, _SIMULATED_TIME, self.period)[:, None]
        done = self._run(gain, (speed * time, speed + 0.0 * time), start_velocity=1.2 * speed)
        last = done.velocity[-len(time) // 3 :]
        swing = (last.max(axis=0) - last.min(axis=0)) / np.abs(speed)
        return np.asarray(swing.reshape(len(gains), -1).max(axis=1), dtype=np.float64)

    def stop(self) -> _Stop:
        """Simulate a resting reference: the joint still moves, or is off it to either side, the latter also alone."""
        speeds = steady_speeds(self.curves, self.settings)
        offsets = np.array([side * offset for offset in _OFFSETS for side in (1.0, -1.0)])
        gain = np.repeat([self.settings.gain, self.settings.gain, 0.0], [len(speeds), len(offsets), len(offsets)])
        still = np.zeros(int(_STOPPED_TIME / self.period))
        done = self._run(
            gain,
            (still, still),
            start_velocity=np.concatenate([speeds, np.zeros(2 * len(offsets))]),
            start_offset=np.concatenate([np.zeros_like(speeds), offsets, offsets]),
        )
        end, speed = len(still) // 3, np.abs(done.velocity)
        travel = np.ptp(done.position[-end:, : len(speeds)], axis=0)
        unsettled = (speed[-end:].max(axis=0) > _CALM * speed.max(axis=0))[len(speeds) :].reshape(2, -1)
        distances = [float(np.min(np.abs(offsets)[rows], initial=np.inf)) for rows in unsettled]
        return _Stop(float(np.max(travel)), *distances)

    def _run(self, gain: FloatArray, reference: tuple[FloatArray, FloatArray], **start: Any) -> SimulatedLoop:
        loop = self.loop
        # The simulation holds the torque over a period itself, which delays it by half of one.
        delay = max(loop.delay - 0.5 * self.period, 0.0)
        cases = LoopCases(
            loop,
            gain,
            np.ones_like(gain),
            np.full_like(gain, delay),
            self.velocity_quantum,
            loop.velocity_filter,
            self.drive,
        )
        return simulate_loop(self.curves, self.settings, cases, reference, period=self.period, **start)
