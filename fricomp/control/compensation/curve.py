"""A friction law taken apart for the hot path: one curve a direction, and the terms that do not fit one."""

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    Dahl,
    FrictionLaw,
    LaggedLuGre,
    LaggedStribeck,
    LoadScaling,
    LuGre,
    SmoothedCoulomb,
    Stribeck,
    StribeckCurve,
    Term,
    Viscous,
)
from fricomp.laws.stribeck import compute_dry_level, compute_falling_share


class CurveParameters(NamedTuple):
    """F(s) = coulomb + rise exp(-(s/stribeck_velocity)^exponent) + viscous s for one direction, s = |v|.

    Attributes:
        coulomb: F_c [N·m] or [N].
        rise: F_s - F_c [N·m] or [N].
        stribeck_velocity: v_s [rad/s] or [m/s].
        exponent: delta [1].
        viscous: F_v [N·m·s/rad] or [N·s/m].
    """

    coulomb: float
    rise: float
    stribeck_velocity: float
    exponent: float
    viscous: float

    def falling_share(self, speed: Any) -> Any:
        """Share of the rise that is left at `speed` >= 0 [1]."""
        return compute_falling_share(speed, self.stribeck_velocity, self.exponent)

    def dry_of(self, falling_share: Any) -> Any:
        """Dry friction where that share of the rise is left [N·m] or [N]."""
        return compute_dry_level(self.coulomb, self.rise, falling_share)

    def dry(self, speed: Any) -> Any:
        """Dry friction at `speed` >= 0, a number, an array or a formula [N·m] or [N]."""
        return self.dry_of(self.falling_share(speed))

    def level(self, speed: float) -> float:
        """Friction at `speed` >= 0 [N·m] or [N]."""
        return float(self.dry(speed)) + self.viscous * speed

    def steepest_fall(self) -> float:
        """Largest -dF/ds of the curve, 0 where it never falls [N·m·s/rad] or [N·s/m].

        For exponent 2 this is sqrt(2/e) rise/stribeck_velocity minus the viscous coefficient [armstrong1994survey].
        """
        delta = self.exponent
        if self.rise <= 0.0:
            return 0.0
        # -d/dx exp(-x^delta) = delta x^(delta-1) exp(-x^delta) is largest at x^delta = 1 - 1/delta, at 0 below delta 1.
        bend = max(1.0 - 1.0 / delta, 1e-3)
        x = bend ** (1.0 / delta)
        slope: float = delta * x ** (delta - 1.0) * math.exp(-bend)
        return max(0.0, self.rise / self.stribeck_velocity * slope - self.viscous)


@dataclass(frozen=True)
class Bristle:
    """The state of LuGre or Dahl friction.

    Attributes:
        sigma_0: Stiffness [N·m/rad] or [N/m].
        sigma_1: Damping [N·m·s/rad] or [N·s/m].
    """

    sigma_0: float
    sigma_1: float


@dataclass(frozen=True)
class FrictionCurves:
    """What the hot path needs of a law.

    Attributes:
        forward: For v > 0.
        reverse: For v < 0.
        load: How the dry part follows the normal load.
        smoothing: Smoothing velocity that the law itself asks for, else 0 [rad/s] or [m/s].
        bristle: State of the dry part, or None where it is static.
        lag: Time by which friction follows the velocity; 0 for none [s].
        extra: Terms that are evaluated as they are.
    """

    forward: CurveParameters
    reverse: CurveParameters
    load: LoadScaling = field(default_factory=LoadScaling)
    smoothing: float = 0.0
    bristle: Bristle | None = None
    lag: float = 0.0
    extra: tuple[Term, ...] = ()

    @property
    def stribeck_velocity(self) -> float | None:
        """The lower Stribeck velocity of both directions; None where nothing falls or rises [rad/s] or [m/s]."""
        found = [curve.stribeck_velocity for curve in (self.forward, self.reverse) if curve.rise != 0.0]
        return min(found, default=None)

    @property
    def steepest_fall(self) -> float:
        """Largest negative slope of either direction [N·m·s/rad] or [N·s/m]."""
        return max(self.forward.steepest_fall(), self.reverse.steepest_fall())

    @property
    def static_ratio(self) -> float:
        """Largest F_s/F_c of either direction, of all that is dry: a law may hold a part of its level in a bristle."""
        beside = [_split_directions(term)[:2] for term in self.extra if _is_dry(term)]
        ratios = []
        for k, curve in enumerate((self.forward, self.reverse)):
            coulomb = curve.coulomb + sum(each[k].coulomb_torque for each in beside)
            ratios.append((coulomb + curve.rise) / coulomb if coulomb > 0.0 else math.inf)
        return max(ratios)

    def largest(self, velocity: tuple[float, float], load_factor: float = 1.0) -> float:
        """Largest friction from `velocity[0]` to `velocity[1]` [N·m] or [N]."""
        edges = ((self.forward, max(velocity[1], 0.0)), (self.reverse, max(-velocity[0], 0.0)))
        speeds = ((curve, top * np.arange(201) / 200) for curve, top in edges)
        return max(float(np.max(load_factor * curve.dry(s) + curve.viscous * s)) for curve, s in speeds)


def split_law(law: FrictionLaw) -> FrictionCurves:
    """Take `law` apart. Terms that share a kind of load scaling become one curve; the rest stays as extra terms.

    Raises:
        ParameterError: The law leaves nothing to compensate.
    """
    dry: list[tuple[StribeckCurve, StribeckCurve, LoadScaling]] = []
    viscous, smoothing, bristle, lag, extra = 0.0, 0.0, None, 0.0, []
    for term in law.terms:
        if isinstance(term, Viscous):
            viscous += term.viscous_coefficient
        elif dry or not _is_dry(term):
            extra.append(term)
        else:
            dry.append(_split_directions(term))
            smoothing = term.smoothing_velocity if isinstance(term, SmoothedCoulomb) else 0.0
            bristle = Bristle(term.sigma_0, getattr(term, "sigma_1", 0.0)) if isinstance(term, LuGre | Dahl) else None
            lag = term.lag if isinstance(term, LaggedStribeck | LaggedLuGre) else 0.0
    forward, reverse, load = dry[0] if dry else (_level(0.0), _level(0.0), LoadScaling())
    ahead, back = _make_curve(forward, viscous), _make_curve(reverse, viscous)
    curves = FrictionCurves(ahead, back, load, smoothing, bristle, lag, tuple(extra))
    if not extra and curves.largest((-1.0, 1.0)) <= 0.0:
        raise ParameterError("the model's friction is zero everywhere: there is nothing to compensate")
    return curves


def _is_dry(term: Term) -> bool:
    if isinstance(term, SmoothedCoulomb):
        return term.shape == "tanh"
    return isinstance(term, BidirectionalStribeck | Stribeck | LuGre | Dahl | Coulomb)


def _split_directions(term: Term) -> tuple[StribeckCurve, StribeckCurve, LoadScaling]:
    if isinstance(term, BidirectionalStribeck | LuGre):
        return term.forward, term.reverse, term.load
    if isinstance(term, Stribeck):
        return term.curve, term.curve, term.load
    assert isinstance(term, Coulomb | SmoothedCoulomb | Dahl)
    return _level(term.coulomb_torque), _level(term.coulomb_torque), term.load


def _level(torque: float) -> StribeckCurve:
    return StribeckCurve(torque, torque, 1.0, 0.0)


def _make_curve(curve: StribeckCurve, viscous: float) -> CurveParameters:
    return CurveParameters(
        curve.coulomb_torque,
        curve.static_torque - curve.coulomb_torque,
        curve.stribeck_velocity,
        curve.stribeck_exponent,
        curve.viscous_coefficient + viscous,
    )
