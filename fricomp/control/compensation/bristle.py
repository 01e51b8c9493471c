"""Limits of the compensation of falling and presliding friction."""

from fricomp.control.compensation.curve import FrictionCurves

FALLING_SHARE_WITHOUT_VELOCITY = 0.5
"""Share of F_s - F_c that `blend` uses while no velocity is measured: half way between sticking and overshooting."""
_HEAVIEST = 1e3  # factor of a load on dry friction up to which bristles bend: what a wrong load has bent would last


def deepest_bend(curves: FrictionCurves) -> float:
    """Deflection of the bristle that no load is believed to bring [rad] or [m]."""
    assert curves.bristle is not None
    levels = (max(c.coulomb, c.coulomb + c.rise) for c in (curves.forward, curves.reverse))
    return _HEAVIEST * max(levels) / curves.bristle.sigma_0
