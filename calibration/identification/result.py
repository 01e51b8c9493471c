"""What `identify` returns."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import t as student

from fricomp.control.compensation.trust import bound_friction
from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel
from fricomp.overview import Overview, OverviewTable, Shown, format_range, format_with_reach
from fricomp.report import draw_figure

from ..network import TanhNetwork
from ..network.distillation import Distillation, distil
from .curve import friction_curve
from .estimation.form import SeparableLaw
from .estimation.information import compute_log_deviations
from .estimation.likelihood import Noise
from .estimation.observation import Observations, observe
from .estimation.optimum import Optimum, optimum_at
from .estimation.pinn import Traces
from .inference.uncertainty import BENT, Interval, profile_interval
from .status import Status

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_WIDER = 1.5
"""The exported network follows the closed form up to this multiple of the fastest speed measured."""


_SHRUNK = 1e-6
"""A parameter whose logarithm moves the torque by less than this share of another's is none [1]."""

_OF_SPEED = ("velocity", "exponent")
"""How names end that shape the curve over speed, and do not scale a torque."""


@dataclass(frozen=True)
class NoiseEstimate:
    """The noise model used and how it was chosen.

    Attributes:
        kind: `relative`, `absolute` or `given`.
        level: Standard deviation as a fraction of the model's torque (relative), in [N·m] or [N] (absolute),
            or as a multiple of what was given.
        candidates: Negative log-likelihood of every noise model compared; each has one parameter, its level,
            so the likelihoods compare as they are.
    """

    kind: str
    level: float
    candidates: dict[str, float] = field(default_factory=dict)

    @property
    def evidence(self) -> float:
        """By how much the next best noise model is less likely [nats]; infinite without a choice."""
        ordered = sorted(self.candidates.values())
        return ordered[1] - ordered[0] if len(ordered) > 1 else np.inf


@dataclass(frozen=True, repr=False)
class IdentificationResult(Shown):
    """A friction model and everything known about how well it is known.

    Attributes:
        model: The friction model, closed form.
        status: Whether it can be trusted; see `message`.
        message: One sentence on the status.
        method: `pinn` or `least_squares`.
        parameter_names: Dotted names, in the order of the covariance.
        covariance: Of the parameters, inverse of the Fisher information. Shape (n_parameters, n_parameters).
        freedom: Degrees of freedom that its size is known from.
        noise: Noise model and level.
        negative_log_likelihood: At the parameters returned.
        distance_to_optimum: From the likelihood optimum that projection and least squares find, the largest over
            the parameters, in standard deviations.
        traces: Course of the training; None for least squares.
        identifying_network: The network trained together with the parameters; None for least squares.
        observations: The points used.
        rows: What stands for them in the likelihood: the points, or of many of them fewer rows that say the same.
        form: The law's separable form.
        optimum: The likelihood at the parameters returned, from these rows.
        seed: Seed of the network's first weights.
    """

    model: FrictionModel
    status: Status
    message: str
    method: str
    parameter_names: tuple[str, ...]
    covariance: FloatArray
    freedom: int
    noise: NoiseEstimate
    negative_log_likelihood: float
    distance_to_optimum: float
    traces: Traces | None
    identifying_network: TanhNetwork | None
    observations: Observations
    rows: Observations
    form: SeparableLaw
    optimum: Optimum
    seed: int = 0

    @cached_property
    def at_points(self) -> Optimum:
        """The likelihood at the parameters, from the points themselves; worked out on first use."""
        if self.rows is self.observations:
            return self.optimum
        given = self.optimum.noise.deviation
        deviation = None if given is None else np.full(self.observations.size, given[0])
        return optimum_at(self.optimum.logs, self.form, self.observations, Noise(self.optimum.noise.kind, deviation))

    @property
    def parameters(self) -> dict[str, float]:
        """Estimated parameters by dotted name, in their own units."""
        return dict(zip(self.parameter_names, np.exp(self.optimum.logs).tolist(), strict=True))

    @property
    def standard_deviations(self) -> dict[str, float]:
        """Standard deviation of each estimated parameter, in its own unit; infinite where the data say nothing."""
        at = self.optimum
        unknown = np.isinf(compute_log_deviations(at.noise.information(at.whitened, at.magnitude, at.jacobian)))
        deviations = np.where(unknown, np.inf, np.sqrt(np.diag(self.covariance)))
        return dict(zip(self.parameter_names, deviations.tolist(), strict=True))

    @cached_property
    def at_bound(self) -> tuple[str, ...]:
        """Parameters that stand at their bound: shrunk to nothing, or as large as the fit lets dry friction be.

        The data ask for a value beyond, such as a negative viscous coefficient, so that no interval means anything.
        """
        at = self.optimum
        felt = np.sum(at.whitened.jacobian**2, axis=0)
        gone = felt <= _SHRUNK**2 * felt.max(initial=0.0)
        scale = np.array([not name.endswith(_OF_SPEED) for name in self.parameter_names])  # a scale of the torque
        ended = at.logs >= self.form.upper_logs(self.rows) - _SHRUNK
        return tuple(name for name, one in zip(self.parameter_names, (gone & scale) | ended, strict=True) if one)

    def headline(self) -> str:
        """Joint, law and status."""
        terms = " + ".join(term.name for term in self.model.law.terms)
        return f"of joint {self.model.joint}: {terms}, {self.status}, {self.observations.size} points"

    def overview(self) -> Overview:
        """Parameters with their 95 % intervals, the status, and what the points and their noise are like."""
        model, points, noise = self.model, self.observations, self.noise
        units, reach = model.units(), {name: self.interval(name).upper for name in self.parameter_names}
        rows = tuple(
            (name, format_with_reach(value, reach[name] - value, at_bound=name in self.at_bound), units[name])
            for name, value in self.parameters.items()
        )
        speeds = format_range((float(points.speed.min()), float(points.speed.max())), f"{model.position_unit}/s")
        level = {
            "relative": f"noise {noise.level:.3g} of the torque",
            "absolute": f"noise {noise.level:.3g} {model.torque_unit}",
        }.get(noise.kind, f"noise {noise.level:.3g} times what was given")
        return Overview(
            f"Friction of joint {model.joint}, identified by {self.method}",
            (f"{self.status}: {self.message}.", f"{points.size} points at {speeds}; {level}."),
            (OverviewTable(("parameter", "value ± 95 %", "unit"), rows),),
        )

    def plot(self) -> Figure:
        """Draw the points and the identified curve with its 95 % band, with matplotlib.

        Raises:
            MissingExtraError: matplotlib is not installed.
        """
        return draw_figure(friction_curve(self.model, self.observations, self.torque_deviation))

    def interval(self, name: str, level: float = 0.95) -> Interval:
        """Confidence interval of a parameter from the covariance; see `profile_interval` where that is too rough.

        Raises:
            IdentificationError: The law has no such parameter.
        """
        if name not in self.parameter_names:
            raise IdentificationError(f"unknown parameter {name!r}; estimated: {', '.join(self.parameter_names)}")
        reach = float(student.ppf(0.5 + level / 2.0, self.freedom)) * self.standard_deviations[name]
        return Interval(self.parameters[name] - reach, self.parameters[name] + reach)

    @cached_property
    def profiles(self) -> dict[str, Interval]:
        """95 % intervals by profile likelihood, of the parameters of a bend; worked out on first use (seconds).

        They need not be symmetric. Where one is far from that of the covariance, it is the one to trust.
        """
        bent = [name for name in self.parameter_names if name.endswith(BENT)]
        return {name: profile_interval(self, name) for name in bent} if self.form.basis.shape_index else {}

    def torque_deviation(self, velocity: FloatArray, normal_load: FloatArray | None = None) -> FloatArray:
        """Standard deviation of the closed form's torque [N·m] or [N] at each velocity, from the covariance."""
        moving = velocity != 0.0
        sign = np.sign(velocity)
        points = observe(velocity, sign, normal_load)
        _, jacobian = self.form.evaluate(self.optimum.logs, points)
        by_value = jacobian / np.exp(self.optimum.logs)
        deviation = np.zeros(len(velocity))
        variance = np.einsum("ij,jk,ik->i", by_value, self.covariance, by_value)
        deviation[moving] = np.sqrt(np.maximum(variance, 0.0))
        return deviation

    @cached_property
    def distillation(self) -> Distillation:
        """The exported network and how close it is to the closed form; trained on first use (a second or two).

        It differs from `identifying_network`, which follows the noise of the points it was trained on. This one is
        trained to the closed form on a grid of its own.
        """
        load = self.observations.normal_load
        several = load is not None and float(np.ptp(load)) > 0.0
        loads = (float(load.min()), float(load.max())) if several and load is not None else None
        constant = float(load[0]) if load is not None and not several else None
        top = _WIDER * float(self.observations.speed.max())

        model = bound_friction(self.model)  # a network is followed without a look at parameters

        def torque(velocity: FloatArray, normal_load: FloatArray | None) -> FloatArray:
            return np.asarray(model.torque(velocity, normal_load=constant if loads is None else normal_load))

        found = distil(torque, top, loads, bend=self._bend() / top, seed=self.seed)
        return found if constant is None else found._replace(network=replace(found.network, load_offset=constant))

    @property
    def network(self) -> TanhNetwork:
        """The network to export."""
        return self.distillation.network

    def _bend(self) -> float:
        """Speed at which the curve starts to bend [rad/s] or [m/s]."""
        shapes = [v for name, v in self.parameters.items() if name.endswith("_velocity")]
        return min(shapes) / 8.0 if shapes else 0.05 * float(self.observations.speed.max())
