"""Online adaptation: dry and viscous friction follow slowly, as temperature changes them; off unless asked for."""

import math
from dataclasses import dataclass

from fricomp.control.compensation.compensator import Compensator
from fricomp.control.compensation.extra_terms import build_steady
from fricomp.control.compensation.trust import trusted_curves
from fricomp.errors import ParameterError
from fricomp.laws import DynamicTerm

_SLIDING_SPEEDS = 4.0  # Stribeck velocities from which the falling branch no longer matters
_PRIOR_SHARE = 0.01  # information that the identified model always keeps, for what a motion leaves open
_LEAST_OWN = 1e-12  # of a share that the model says nothing of, such as the dry one of viscous friction alone
_LEAST_DETERMINANT = 1e-12  # of the product of both shares: what rounding may leave of two that cannot be told apart


@dataclass(frozen=True)
class AdaptationSettings:
    """How the scales of a compensator may move.

    Attributes:
        time_constant: Of the adaptation, while it is not frozen [s].
        dry_bounds: Lowest and highest scale of dry friction; None for the identified 95 % interval [1].
        viscous_bounds: The same for viscous friction [1].
        sliding_velocity: Speed from which it adapts; None for four Stribeck velocities [rad/s] or [m/s]. Speeds at
            which rests of the joint bring friction are never sliding.
        settling_time: Time of sliding in one direction before it adapts [s].

    Raises:
        ParameterError: A value is outside its domain.
    """

    time_constant: float = 20.0
    dry_bounds: tuple[float, float] | None = None
    viscous_bounds: tuple[float, float] | None = None
    sliding_velocity: float | None = None
    settling_time: float = 0.2

    def __post_init__(self) -> None:
        if not (0.0 < self.time_constant < math.inf and self.settling_time >= 0.0):
            raise ParameterError(
                f"time_constant must be positive and settling_time not negative, got {self.time_constant!r} and "
                f"{self.settling_time!r} s"
            )
        for bounds in (self.dry_bounds, self.viscous_bounds):
            if bounds is not None and not 0.0 < bounds[0] <= 1.0 <= bounds[1] < math.inf:
                raise ParameterError(f"bounds of a scale must be positive and hold 1, got {bounds!r}")


class OnlineAdaptation:
    """Adapts the scales of one compensator by recursive least squares with forgetting on the friction it is shown.

    It moves only while the joint slides fast in one direction, never at reversals or at rest, and only within its
    bounds, so that a wrong torque can do no more than the identification left open. It starts as if it had seen one
    time constant of data that agrees with the model.

    Friction counts as that of steady sliding, in which nothing is left of what rests brought (`dwell_stiction`); a lag
    is left out too: while a joint speeds up it takes as much from viscous friction as it adds while it slows down.

    Attributes:
        dry_scale: Present scale of dry friction [1].
        viscous_scale: Present scale of viscous friction [1].

    Args:
        compensator: Whose scales move.
        settings: How.

    Raises:
        ParameterError: No bounds are given and the model has no covariance to take them from.
    """

    def __init__(self, compensator: Compensator, settings: AdaptationSettings | None = None) -> None:
        self._settings = settings or AdaptationSettings()
        self._compensator = compensator
        self._curves = trusted_curves(compensator.model)
        terms = self._curves.extra
        self._extra = build_steady(terms, compensator.settings) if terms else None
        self._dry_bounds = self._settings.dry_bounds or _find_interval(compensator, "coulomb_torque")
        self._viscous_bounds = self._settings.viscous_bounds or _find_interval(compensator, "viscous_coefficient")
        known = self._settings.sliding_velocity
        fast = known if known is not None else _SLIDING_SPEEDS * (self._curves.stribeck_velocity or 0.01)
        self._fast = max([fast, *(term.sliding_speed for term in terms if isinstance(term, DynamicTerm))])
        self._rate = compensator.period / self._settings.time_constant
        self._ahead = True
        self._start()

    def _start(self) -> None:
        curve, self._slid = self._curves.forward, 0.0
        self._own = max(curve.dry(self._fast) ** 2, _LEAST_OWN), max((curve.viscous * self._fast) ** 2, _LEAST_OWN)
        # Information matrix (dry, viscous, cross) and its product with the scales, all means over the time constant.
        self._information = (*self._own, 0.0)
        self._product = self._own
        self.dry_scale = self.viscous_scale = 1.0

    @property
    def frozen(self) -> bool:
        """Whether the last update changed nothing: at rest, slow, or just after a reversal."""
        return self._slid < self._settings.settling_time

    def update(
        self,
        velocity: float,
        friction_torque: float,
        position: float = 0.0,
        load_torque: float = 0.0,
        temperature: float | None = None,
        acceleration: float = 0.0,
        normal_load: float | None = None,
    ) -> None:
        """Take one sample, once a period. One that cannot be reckoned with changes nothing.

        Args:
            velocity: Measured, or the reference of a joint that follows well [rad/s] or [m/s].
            friction_torque: Torque applied minus that of the rigid body, in the model's torque unit.
            position: [rad] or [m]; used by terms over position.
            load_torque: Torque the joint transmits to its load; used by terms over load torque.
            temperature: [°C]; used by terms over temperature.
            acceleration: [rad/s²] or [m/s²]; used by terms over acceleration.
            normal_load: In the unit of the law's reference load; dry friction follows it where the model does. Without
                one, it counts as the reference load.
        """
        speed, ahead = abs(velocity), velocity >= 0.0
        given = (velocity, friction_torque, position, load_torque, acceleration, temperature or 0.0, normal_load or 0.0)
        if not all(map(math.isfinite, given)) or speed < self._fast or ahead != self._ahead:
            self._slid, self._ahead = 0.0, ahead
            return
        self._slid += self._compensator.period
        if self.frozen:
            return
        try:
            dry, viscous, held = self._evaluate_model(
                velocity, position, load_torque, temperature, acceleration, normal_load
            )
        except (ArithmeticError, ValueError):  # of inputs far beyond the model, from which a power runs over
            return
        level = friction_torque - held if ahead else held - friction_torque
        keep, rate = 1.0 - self._rate, self._rate
        dd, vv, dv = self._information
        information = (
            keep * dd + rate * dry * dry,
            keep * vv + rate * viscous * viscous,
            keep * dv + rate * dry * viscous,
        )
        d, v = self._product
        product = keep * d + rate * dry * level, keep * v + rate * viscous * level
        if math.isfinite(sum(information) + sum(product)):
            self._information, self._product = information, product
            self._solve()

    def _evaluate_model(
        self,
        velocity: float,
        position: float,
        load_torque: float,
        temperature: float | None,
        acceleration: float,
        normal_load: float | None,
    ) -> tuple[float, float, float]:
        """Dry and viscous friction of the model along the motion, and what it holds whatever the direction."""
        speed, ahead = abs(velocity), velocity >= 0.0
        curve = self._curves.forward if ahead else self._curves.reverse
        loaded = max(float(self._curves.load.factor(normal_load)), 0.0)
        dry, viscous = loaded * curve.dry(speed), curve.viscous * speed
        if self._extra is None:
            return dry, viscous, 0.0
        extra = self._extra(velocity, position, load_torque, temperature, acceleration)
        return max(dry + extra.dry, 0.0), viscous + (extra.drag if ahead else -extra.drag), extra.held

    def _solve(self) -> None:
        """Scales from the data and the model's own share of the information."""
        own_dry, own_viscous = _PRIOR_SHARE * self._own[0], _PRIOR_SHARE * self._own[1]
        dd, vv, dv = self._information
        dd, vv = dd + own_dry, vv + own_viscous
        d, v = self._product[0] + own_dry, self._product[1] + own_viscous
        determinant = max(dd * vv - dv * dv, _LEAST_DETERMINANT * dd * vv)  # positive: both own shares are
        dry_scale = _clip((vv * d - dv * v) / determinant, self._dry_bounds)
        # Given a scale at its bound the other one is best elsewhere; away from the bounds this changes nothing.
        viscous_scale = _clip((v - dv * dry_scale) / vv, self._viscous_bounds)
        dry_scale = _clip((d - dv * viscous_scale) / dd, self._dry_bounds)
        if math.isfinite(dry_scale + viscous_scale):  # products of the largest numbers run over
            self.dry_scale, self.viscous_scale = dry_scale, viscous_scale
            self._compensator.set_scale(dry_scale, viscous_scale)

    def reset(self) -> None:
        """Back to the model as it was identified."""
        self._start()
        self._compensator.set_scale(1.0, 1.0)


def _find_interval(compensator: Compensator, parameter: str) -> tuple[float, float]:
    """Widest relative 95 % interval of the parameters of this name."""
    model = compensator.model
    if model.covariance is None:
        raise ParameterError(
            f"the model of joint {model.joint!r} has no covariance to bound the adaptation by: give dry_bounds and "
            "viscous_bounds"
        )
    values, deviations = model.law.parameters(), model.covariance.standard_deviations()
    ratios = [
        1.96 * deviation / values[name]
        for name, deviation in deviations.items()
        if name.endswith(parameter) and values[name] > 0.0
    ]
    widest = min(max(ratios, default=0.0), 0.9)
    return 1.0 - widest, 1.0 + widest


def _clip(value: float, bounds: tuple[float, float]) -> float:
    return min(max(value, bounds[0]), bounds[1])
