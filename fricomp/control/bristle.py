"""The bristle of a compensation, which not every law has."""

from __future__ import annotations

from collections.abc import Callable
from math import exp

from fricomp.control.curve import FrictionCurves

__all__ = ["FALLING_SHARE_WITHOUT_VELOCITY", "build_bristle"]

FALLING_SHARE_WITHOUT_VELOCITY = 0.5
"""Share of F_s - F_c that `blend` uses while no velocity is measured: half way between sticking and overshooting."""


def build_bristle(
    curves: FrictionCurves, period: float
) -> tuple[Callable[[float, float, float], float], Callable[[], None]]:
    """Bristle torque driven by the reference velocity, advanced exactly as `fricomp.laws.LuGre.advance`.

    It takes the velocity, the velocity that the friction level follows, which may lag, and the factor of the load.
    """
    assert curves.bristle is not None
    forward, reverse = curves.forward, curves.reverse
    sigma_0, damping = curves.bristle.sigma_0, curves.bristle.sigma_1 / period
    z = 0.0

    def bristle(velocity: float, felt: float, factor: float) -> float:
        nonlocal z
        coulomb, rise, stribeck_velocity, exponent, _ = forward if velocity >= 0.0 else reverse
        speed = velocity if velocity >= 0.0 else -velocity
        steady = factor * (coulomb + rise * exp(-((abs(felt) / stribeck_velocity) ** exponent))) / sigma_0
        if not steady > 0.0:
            z = 0.0
            return 0.0
        target = steady if velocity >= 0.0 else -steady
        after = target + (z - target) * exp(-speed * period / steady)
        tau = sigma_0 * after + damping * (after - z)
        z = after
        return tau

    def reset() -> None:
        nonlocal z
        z = 0.0

    return bristle, reset
