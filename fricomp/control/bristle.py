"""The bristle of a compensation, which not every law has."""

from __future__ import annotations

from collections.abc import Callable
from math import exp, tanh

from fricomp.control.curve import FrictionCurves

__all__ = ["FALLING_SHARE_WITHOUT_VELOCITY", "build_bristle", "deepest_bend"]

FALLING_SHARE_WITHOUT_VELOCITY = 0.5
"""Share of F_s - F_c that `blend` uses while no velocity is measured: half way between sticking and overshooting."""
_HEAVIEST = 1e3  # factor of a load on dry friction up to which bristles bend: what a wrong load has bent would last


def build_bristle(
    curves: FrictionCurves, period: float, smoothing: float
) -> tuple[Callable[[float, float, float], tuple[float, float]], Callable[[], None]]:
    """Bristle torque driven by the reference velocity, advanced exactly as `fricomp.laws.LuGre.advance`.

    It takes the velocity, the velocity that the friction level follows, which may lag, and the factor of the load, and
    gives the torque and the level that it would come to [N·m] or [N]. Beyond `deepest_bend` nothing bends and the
    torque is that level, with the direction changing over `smoothing` [rad/s] or [m/s].
    """
    assert curves.bristle is not None
    forward, reverse = curves.forward, curves.reverse
    sigma_0, damping = curves.bristle.sigma_0, curves.bristle.sigma_1 / period
    deepest = deepest_bend(curves)
    z = 0.0

    def bristle(velocity: float, felt: float, factor: float) -> tuple[float, float]:
        nonlocal z
        coulomb, rise, stribeck_velocity, exponent, _ = forward if velocity >= 0.0 else reverse
        speed = velocity if velocity >= 0.0 else -velocity
        level = factor * (coulomb + rise * exp(-((abs(felt) / stribeck_velocity) ** exponent)))
        steady = level / sigma_0
        if not 0.0 < steady < deepest:
            z = 0.0
            return level * tanh(velocity / smoothing), level
        target = steady if velocity >= 0.0 else -steady
        after = target + (z - target) * exp(-speed * period / steady)
        tau = sigma_0 * after + damping * (after - z)
        z = after
        return tau, level

    def reset() -> None:
        nonlocal z
        z = 0.0

    return bristle, reset


def deepest_bend(curves: FrictionCurves) -> float:
    """Deflection of the bristle that no load is believed to bring [rad] or [m]."""
    assert curves.bristle is not None
    levels = (max(c.coulomb, c.coulomb + c.rise) for c in (curves.forward, curves.reverse))
    return _HEAVIEST * max(levels) / curves.bristle.sigma_0
