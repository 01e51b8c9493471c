"""The joint that a verdict is about: the base with the chosen effects, or alone, and what its numbers are worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..effects import EFFECTS
from ..effects.structure import N_BASE, Structure, fit_all
from ..inputs.track import FloatArray
from ..joint.base import BASE_NAMES
from ..joint.observer import Plant
from ..joint.solver import Fit
from ..record.result import Quantity
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from .confirmation import compute_covariance
from .settings import PARAMETERS

SPLIT_BY_PRESLIDING = ("offset", "forward.coulomb_torque", "reverse.coulomb_torque")
"""Parameters of the base that sliding shows as sums only."""

_NEVER_NEGATIVE = ("coulomb_torque", "viscous_coefficient", "damping_time", "sharpness")
_DELAY = BASE_NAMES.index("delay")
_LARGEST = 700.0
"""The largest exponent, nearly, whose power a double holds."""


@dataclass(frozen=True)
class RefittedJoint:
    """A structure at its joint minimum.

    Attributes:
        structure: Base with effects, or alone.
        fit: Its joint minimum.
        covariance: Of base and effects, in the solver's coordinates. Shape (p, p).
    """

    structure: Structure
    fit: Fit
    covariance: FloatArray

    @classmethod
    def refit(cls, baseline: Baseline, chosen: Explanation | None) -> RefittedJoint:
        """The base with the chosen effects, on the joint that was found; alone where none are. Derivatives are fresh: a
        descent updates its own."""
        one = baseline if chosen is None else chosen
        structure, theta = baseline.structure, one.fit.theta
        if chosen is not None:
            structure = chosen.settled_structure.move_to(chosen.structure.move_contexts(theta))
            theta = np.concatenate([theta[:N_BASE], structure.build_start()])
        descent = structure.start_descent(theta, one.box, iterations=0)
        (fit,) = fit_all(baseline.problem, [(structure, descent)])
        return cls(structure, fit, compute_covariance(fit, one.box.join(structure.build_known_box())))

    @cached_property
    def plant(self) -> Plant:
        """Its base."""
        return self.structure.unpack_plant(self.fit.theta)

    @cached_property
    def deviations(self) -> FloatArray:
        """Standard deviations of base and effects. Shape (p,).

        A number of an effect that ends where its domain does moves to one side at most, and no step of it can stand for
        the others: they are known as they are beside it.
        """
        own = np.diag(self.covariance)
        ended = [index for index in range(N_BASE, own.size) if self.is_ended(index)]
        kept = np.setdiff1d(np.arange(own.size), ended)
        result: FloatArray = np.sqrt(np.maximum(own, 0.0))
        result[kept] = np.sqrt(np.maximum(np.diag(condition(self.covariance, kept.tolist(), ended)), 0.0))
        return result

    def is_ended(self, index: int) -> bool:
        """Whether a number of an effect that is not linear stands where its domain ends."""
        _, parameter = self.structure.parameters[index - N_BASE]
        return not parameter.linear and parameter.touches_end(float(self.fit.theta[index]))

    def list_parameters(
        self, name: str, torque_unit: str, position_unit: str, *, fit_alone: bool = False
    ) -> dict[str, Quantity]:
        """Parameters of the effect `name`, with their intervals, which end where the parameter's domain does.

        What the recording does not reach is left out, such as a stop at the other end.

        Args:
            name: Of the effect.
            torque_unit: Of the recording.
            position_unit: Likewise.
            fit_alone: Whether the intervals are what this recording determines, without how far other forms of the
                effect have theirs elsewhere.
        """
        result = {}
        for index, (owner, parameter) in enumerate(self.structure.parameters, N_BASE):
            value, deviation = self.fit.theta[index], self.deviations[index]
            if owner != name or parameter.is_out_of_reach(float(value)):
                continue
            unit = _shorten_unit(parameter.unit.replace("{torque}", torque_unit).replace("{position}", position_unit))
            if parameter.with_delay:
                value, deviation = self._set_beside_usual_delay(index, parameter.with_delay)
            if parameter.name == "order":
                deviation = float(np.hypot(deviation, abs(value) * self._uneven_reading))
            form = 0.0 if fit_alone else parameter.compute_form_deviation(float(value))
            half = 1.96 * float(np.hypot(deviation, form))
            half = half if parameter.scale > 0.0 else 0.0
            low, high = max(float(value) - half, parameter.lower), min(float(value) + half, parameter.upper)
            at_bound = parameter.scale > 0.0 and parameter.touches_end(float(self.fit.theta[index]))
            result[parameter.name] = _describe_quantity(
                (low, float(value), high), unit, logarithmic=parameter.logarithmic, at_bound=at_bound
            )
        return result

    def _set_beside_usual_delay(self, index: int, change: float) -> tuple[float, float]:
        """A time that the base's own delay shares, and its standard deviation [s], were that delay a usual one.

        How the fit parts the two follows from how smooth the torque is, which what is left of the noise blurs.
        """
        usual, strays = self.structure.contexts[0].usual_delay
        line: FloatArray = np.zeros(self.fit.theta.size)
        line[index], line[_DELAY] = 1.0, -change
        known = float(np.sqrt(max(float(line @ self.covariance @ line), 0.0)))
        return float(line @ self.fit.theta) + change * usual, float(np.hypot(known, strays))

    def widen_deviations(self, known: float, strays: FloatArray) -> FloatArray:
        """Standard deviations of the base with what the fit does not know of. Shape (N_BASE,).

        Args:
            known: Factor on those that it does know of.
            strays: Further ones. Shape (N_BASE,).
        """
        return np.hypot(known * self.deviations[:N_BASE], strays)

    def measure_late_action(self, deviations: FloatArray) -> Quantity:
        """How long after its stamp the torque acts [s] in the mean. Where in its sample it begins is often not said.

        Args:
            deviations: Of the base. Shape (N_BASE,).
        """
        context = self.structure.contexts[0]
        value = context.acts_late - float(self.fit.theta[_DELAY])
        half = 1.96 * float(np.hypot(deviations[_DELAY], context.usual_delay[1]))
        return Quantity(value, "s", (max(value - half, 0.0), value + half))

    @property
    def _uneven_reading(self) -> float:
        """RMS of the slope of the encoder's error: ripples are counted over what it reads [1]."""
        values = self.structure.name_values(self.fit.theta[N_BASE:])
        disc = next((one for name, one in values.items() if EFFECTS[name].misreads_position), None)
        return 0.0 if disc is None else float(disc["order"] * np.hypot(disc["sine"], disc["cosine"]) / np.sqrt(2.0))

    def list_base(self, torque_unit: str, position_unit: str, deviations: FloatArray) -> dict[str, Quantity]:
        """Parameters of the base, with their intervals.

        Args:
            torque_unit: Of the recording.
            position_unit: Of the recording.
            deviations: Of them, in the solver's coordinates. Shape (N_BASE,).
        """
        units = {
            "inertia": _shorten_unit(f"{torque_unit}·s²/{position_unit}"),
            "delay": "s",
            "damping_time": "s",
            "viscous_coefficient": f"{torque_unit}·s/{position_unit}",
            "sharpness": "1",
            "spread": "1",
            "breakaway": position_unit,
            "creep_lead": "s",
            "creep_velocity": f"{position_unit}/s",
            "stribeck_velocity": f"{position_unit}/s",
        }
        deviation = deviations.copy()
        split = [BASE_NAMES.index(name) for name in SPLIT_BY_PRESLIDING]
        deviation[split] = np.hypot(deviation[split], PARAMETERS.split * self.plant.level)
        theta, result = self.fit.theta[:N_BASE].copy(), {}
        if any(parameter.with_delay for _, parameter in self.structure.parameters):
            theta[_DELAY], deviation[_DELAY] = self.structure.contexts[0].usual_delay
        theta[_DELAY] -= self.structure.contexts[0].acts_late
        for name, value, half in zip(BASE_NAMES, theta, 1.96 * deviation, strict=True):
            if name in ("creep_velocity", "creep_lead") and self.plant.creep_velocity == 0.0:
                continue
            plain = name.replace("log_", "")
            unit = units.get(plain.split(".")[-1], torque_unit)
            low = float(value - half)
            if plain.split(".")[-1] in _NEVER_NEGATIVE:
                low = max(low, 0.0)
            around = low, float(value), float(value + half)
            result[plain] = _describe_quantity(around, unit, logarithmic="log_" in name)
        return result


def condition(covariance: FloatArray, kept: Sequence[int], given: Sequence[int]) -> FloatArray:
    """Covariance of some numbers where others are given. Shape (n_kept, n_kept)."""
    own = covariance[np.ix_(kept, kept)]
    if not given:
        return np.asarray(own)
    across = covariance[np.ix_(kept, given)]
    among = np.linalg.pinv(covariance[np.ix_(given, given)], hermitian=True)
    return np.asarray(own - across @ among @ across.T)


def _shorten_unit(unit: str) -> str:
    """A unit by the name that it usually has."""
    return {"N·m·s²/rad": "kg·m²", "N·s²/m": "kg"}.get(unit, unit)


def _describe_quantity(
    around: tuple[float, float, float], unit: str, *, logarithmic: bool, at_bound: bool = False
) -> Quantity:
    """A number with the ends of its interval on both sides."""
    low, mid, high = (float(np.exp(min(x, _LARGEST))) for x in around) if logarithmic else around
    return Quantity(mid, unit, (low, high), at_bound)
