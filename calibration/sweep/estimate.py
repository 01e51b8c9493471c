"""From friction points to the friction model, with an uncertainty that holds what the points share.

Points scatter independently; their level is estimated from the scatter itself. The zero of the torque sensor is
different: an error in it raises friction in one direction and lowers it in the other at every speed, so that it can
be told from friction only where the torque is known to be zero. It is measured there, with the joint at rest and not
energised, and what stays unknown of it enters the covariance through the parameters' sensitivity to it. So does the
ripple of the speed that the encoder hides: over the bends of the curve it shifts the mean torque of every plateau.
So does, where no model says what gravity is, the age of the torque signal: over the slope of gravity it looks like
viscous friction.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike

from fricomp.errors import IdentificationError, ParameterError
from fricomp.laws import FloatArray

from ..identification import IdentificationOptions, IdentificationResult, identify
from ..identification.doubt import with_covariance
from ..identification.identify import Method
from .analysis.analysis import HALF_DIFFERENCE, SweepAnalysis
from .analysis.point import FrictionPoint
from .analysis.steadiness import CURES, REASONS
from .sweep import CREEP_RATIO

__all__ = ["FEWEST_POINTS", "Estimate", "IdentificationSettings", "estimate_friction"]

# A breakaway torque is known to this fraction at best: see `measure_breakaway` for what the encoder hides, and it
# depends on how long the joint rested and how fast the torque rose [1].
BREAKAWAY_ACCURACY = 0.01
# A sweep that goes below this fraction of the Stribeck velocity shows the static torque itself, and better [1].
REACHES_STATIC = 0.5
# Two more than the parameters of the bidirectional law leave something to tell the noise from.
FEWEST_POINTS = 10
# Noise models that a sweep can be identified with.
NOISES = ("auto", "relative", "absolute")
# Between two counts the loop does not see the joint, whose speed ripples by about this many counts a second: 0.4 to
# 1.3 mrad/s were measured on the stand-in, whose count is 24 µrad [1/s].
RIPPLE_RATE = 30.0
# Counts a second, over the samples, up to which the torque resolves each of them; the torque sensor's own filter may
# hide half of what it shows.
RESOLVED, RIPPLE_MARGIN = 0.4, 2.0
# Scatter below this fraction of the largest torque is rounding [1].
LEAST_LEVEL = 1e-9


@dataclass(frozen=True)
class IdentificationSettings:
    """How friction is identified from the points.

    Attributes:
        method: `pinn` or `least_squares`.
        noise: `auto`, `relative` or `absolute`.
        seed: Of the network's first weights.

    Raises:
        ParameterError: A method or a noise model that there is not, or a negative seed.
    """

    method: Method = "pinn"
    noise: str = "auto"
    seed: int = 0

    def __post_init__(self) -> None:
        # Before a sweep that takes minutes, not after it.
        for name, choices in (("method", get_args(Method)), ("noise", NOISES)):
            if getattr(self, name) not in choices:
                raise ParameterError(f"unknown {name} {getattr(self, name)!r}; use {', '.join(choices)}")
        if self.seed < 0:
            raise ParameterError(f"seed must be at least 0, got {self.seed!r}")


@dataclass(frozen=True)
class Estimate:
    """The identified friction.

    Attributes:
        result: With the whole covariance.
        deviation: Standard deviation that each point was given [N·m] or [N]. Shape (n_points,).
        used: The points, plateaus first, then static torques.
    """

    result: IdentificationResult
    deviation: FloatArray
    used: tuple[FrictionPoint, ...]


def estimate_friction(analysis: SweepAnalysis, settings: IdentificationSettings) -> Estimate:
    """Identify the bidirectional Stribeck law of a sweep, or the symmetric one where both directions look alike.

    Measured static torques take part where the sweep does not go slow enough.

    Raises:
        IdentificationError: There are too few steady plateaus.
    """
    points = analysis.steady
    if len(points) < FEWEST_POINTS:
        raise IdentificationError(_describe_too_few(analysis))
    both_alike = analysis.torque_source == HALF_DIFFERENCE
    law = "symmetric_stribeck" if both_alike else "stribeck"
    first = identify(
        [p.velocity for p in points],
        [p.torque for p in points],
        _list_loads(points),
        "least_squares",
        settings.noise,
        law=law,
    )
    static = _make_static_points(analysis, points, _find_bend(first))
    used = (*points, *static)
    deviation = np.concatenate([_estimate_scatter(points, first, both_alike), [point.deviation for point in static]])
    metadata = analysis.metadata
    result = identify(
        [point.velocity for point in used],
        [point.torque for point in used],
        _list_loads(used),
        method=settings.method,
        noise=deviation,
        seed=settings.seed,
        law=law,
        options=IdentificationOptions(
            reference_load=analysis.mean_load,
            joint=metadata.joint,
            motion=metadata.motion,
            torque_unit=metadata.torque_unit,
            independent=not both_alike,  # the two points of a pair are one measurement
            measurements=len(used) // 2 if both_alike else None,
        ),
    )
    changes = [_compute_sensitivity(result, shift) for shift in _compute_shared_shifts(result, analysis, used)]
    result = with_covariance(result, result.covariance + sum(np.outer(change, change) for change in changes))
    return Estimate(_with_notes(result, analysis), deviation, used)


def _compute_shared_shifts(
    result: IdentificationResult, analysis: SweepAnalysis, used: Sequence[FrictionPoint]
) -> list[FloatArray]:
    """Errors of the points' friction magnitude that no number of plateaus averages out. Shapes (n_points,)."""
    swing = hidden_swing(result, analysis.steady, analysis.metadata.encoder_resolution or 0.0, analysis.sample_rate)
    shifts = [_compute_ripple_shift(result, swing)]
    sign = result.observations.sign
    if analysis.torque_source != HALF_DIFFERENCE:
        shifts.append(analysis.offset.deviation * sign)
    elif analysis.gravity is not None:
        rates = np.array([point.load_rate for point in used])[result.observations.kept]
        shifts.append(analysis.gravity.lag_deviation * rates * sign)
    return shifts


def _describe_too_few(analysis: SweepAnalysis) -> str:
    """Why there are too few plateaus, and what brings more of them."""
    steady, rejected = len(analysis.steady), Counter(point.verdict for point in analysis.rejected)
    said = f"{steady} of {len(analysis.points)} plateaus can be used, at least {FEWEST_POINTS} are needed"
    if not rejected:
        return f"{said}: none was rejected, the sweep was too short; give more --speeds or --repeats"
    reasons = ", ".join(f"{count} {REASONS[verdict]}" for verdict, count in rejected.most_common())
    cures = "; ".join(f"{REASONS[verdict]}: {CURES[verdict]}" for verdict in rejected)
    return f"{said} ({reasons}). {cures[0].upper()}{cures[1:]}"


def _estimate_scatter(points: Sequence[FrictionPoint], first: IdentificationResult, both_alike: bool) -> FloatArray:
    """Standard deviation of each point [N·m] or [N] from the scatter about a first fit. Shape (n_points,).

    A plateau that lasts longer scatters less, with the root of its duration. Where both directions are alike, the two
    points of a pair are one measurement: half as many are free to scatter, and each point counts for half of it.
    """
    duration = np.array([p.duration for p in points])
    shape = np.sqrt(np.median(duration) / duration)
    if first.noise.kind == "relative":
        shape = shape * first.at_points.magnitude
    error = (first.observations.magnitude - first.at_points.magnitude) / shape
    independent = len(points) // 2 if both_alike else len(points)
    freedom = max(independent - len(first.parameter_names), 1)
    level = float(np.sqrt(np.sum(error**2) / freedom))
    return np.asarray(np.maximum(level, LEAST_LEVEL * float(np.max(first.at_points.magnitude))) * shape)


def _make_static_points(
    analysis: SweepAnalysis, points: Sequence[FrictionPoint], bend: float
) -> tuple[FrictionPoint, ...]:
    """One point a direction from the breakaway torques, where the slowest plateau is not slow enough to show it."""
    slowest = min(abs(p.velocity) for p in points)
    if slowest < REACHES_STATIC * bend or analysis.torque_source == HALF_DIFFERENCE:
        return ()
    found = []
    for direction in (1, -1):
        static = analysis.static_torque(direction)
        if static is not None:
            deviation = float(np.hypot(static.deviation, BREAKAWAY_ACCURACY * static.value))
            velocity = direction * CREEP_RATIO * slowest
            point = FrictionPoint(-1, 0.0, velocity, direction * static.value, deviation, 0.0, "steady")
            found.append(replace(point, normal_load=analysis.mean_load))
    return tuple(found)


def _find_bend(first: IdentificationResult) -> float:
    """The lowest Stribeck velocity [rad/s] or [m/s]."""
    return min(value for name, value in first.parameters.items() if name.endswith("stribeck_velocity"))


def _list_loads(points: Sequence[FrictionPoint]) -> ArrayLike | None:
    loads = [point.normal_load for point in points if point.normal_load is not None]
    return loads if len(loads) == len(points) else None


def hidden_swing(
    result: IdentificationResult, points: Sequence[FrictionPoint], count: float, sample_rate: float
) -> float:
    """How far the speed may swing unseen by the encoder [rad/s] or [m/s].

    Of a coarse encoder each count is resolved by the torque samples, and a swing of the speed shows in the torque: a
    loop under which the joint slid steadily down the falling branch damps more than that branch falls, so that a
    swing is at most the torque's over the steepest fall.

    Args:
        result: The identified friction.
        points: That were used.
        count: Step of the encoder [rad] or [m].
        sample_rate: [Hz].
    """
    usual = RIPPLE_RATE * count
    seen = result.observations.speed
    speeds = np.geomspace(float(seen.min()), float(seen.max()), 400)
    loads = result.observations.normal_load
    load = None if loads is None else float(loads.mean())
    slope = np.gradient(np.abs(result.model.torque(speeds, normal_load=load)), speeds)
    steepest, bend = -float(np.min(slope)), float(speeds[np.argmin(slope)])
    if count <= 0.0 or steepest <= 0.0:
        return usual
    if bend / count > RESOLVED * sample_rate:
        return usual
    return min(usual, RIPPLE_MARGIN * float(np.median([point.ripple for point in points])) / steepest)


def _compute_ripple_shift(result: IdentificationResult, swing: float) -> FloatArray:
    """Shift of the mean friction magnitude by a speed that swings by `swing` [rad/s] or [m/s]. Shape (n,)."""
    speed = result.observations.speed
    points = result.observations

    def level(change: float) -> FloatArray:
        velocity = points.sign * np.maximum(speed + change, 0.5 * speed)
        return np.abs(result.model.torque(velocity, normal_load=points.normal_load))

    return np.asarray(0.5 * (level(-swing) + level(swing)) - level(0.0))


def _compute_sensitivity(result: IdentificationResult, shift: FloatArray) -> FloatArray:
    """Change of each parameter by a `shift` of the points' friction magnitude. Shape (n_parameters,)."""
    optimum = result.at_points
    weighted = optimum.whitened.weight[:, None] * optimum.jacobian
    by_logarithm, *_ = np.linalg.lstsq(weighted, optimum.whitened.weight * shift, rcond=1e-12)
    return np.asarray(by_logarithm * np.exp(optimum.logs))


def _with_notes(result: IdentificationResult, analysis: SweepAnalysis) -> IdentificationResult:
    provenance = result.model.provenance
    notes = {
        "torque_source": analysis.torque_source,
        "normal_load": analysis.load_source,
        "torque_offset": f"{analysis.offset.value:.6g} +- {analysis.offset.deviation:.2g}",
        "torque_kind": analysis.metadata.torque_kind,
    }
    if analysis.gravity is not None:
        notes["torque_age"] = f"{analysis.gravity.lag:.3g} +- {analysis.gravity.lag_deviation:.2g}"
    noted = replace(provenance, notes={**provenance.notes, **notes})
    return replace(result, model=replace(result.model, provenance=noted))
