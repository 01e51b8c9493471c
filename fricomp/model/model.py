"""A friction model: a law, and what one must know to use it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import BidirectionalStribeck, FloatArray, FrictionLaw, LuGre, Scalar, Stribeck, StribeckCurve
from fricomp.model.dynamics import JointDynamics
from fricomp.overview import Overview, OverviewTable, Shown, format_range, format_with_reach

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Covariance", "FrictionModel", "Motion", "Provenance", "Validity"]

Motion = Literal["rotary", "linear"]
Range = tuple[float, float]

_PLOTTED = (-1.0, 1.0)
"""Velocity that is drawn where no range of data is known [rad/s] or [m/s]."""


@dataclass(frozen=True)
class Covariance:
    """Covariance of identified parameters.

    Attributes:
        names: Dotted parameter names, in the order of the rows.
        matrix: Shape (n_names, n_names), products of the parameters' units.
        degrees_of_freedom: Of the residual that its size was estimated from; None where the size is known.

    Raises:
        ParameterError: The matrix is not finite, symmetric, of that shape, or has a negative variance; or the degrees
            of freedom are not positive.
    """

    names: tuple[str, ...]
    matrix: FloatArray
    degrees_of_freedom: float | None = None

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, dtype=np.float64)
        n = len(self.names)
        if matrix.shape != (n, n) or not np.all(np.isfinite(matrix)):
            raise ParameterError(f"covariance of {n} parameters must be a finite {n} x {n} matrix, got {matrix.shape}")
        if np.any(np.diag(matrix) < 0.0) or not np.allclose(matrix, matrix.T, rtol=1e-6, atol=0.0):
            raise ParameterError("a covariance must be symmetric with variances that are not negative")
        if self.degrees_of_freedom is not None and not 0.0 < self.degrees_of_freedom < np.inf:
            raise ParameterError(f"degrees of freedom must be positive and finite, got {self.degrees_of_freedom}")
        matrix.flags.writeable = False
        object.__setattr__(self, "matrix", matrix)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Covariance):
            return NotImplemented
        return self.names == other.names and np.array_equal(self.matrix, other.matrix)

    def __hash__(self) -> int:
        return hash(self.names)

    def standard_deviations(self) -> dict[str, float]:
        """Standard deviation of each parameter, in its own unit."""
        return dict(zip(self.names, np.sqrt(np.diag(self.matrix)).tolist(), strict=True))


@dataclass(frozen=True)
class Validity:
    """The range of the data that a model was identified from; None where nothing is known.

    Attributes:
        velocity: Lowest and highest velocity [rad/s] or [m/s].
        position: [rad] or [m].
        load_torque: [N·m] or [N].
        normal_load: In the unit of the law's reference load.
        temperature: [°C].
        acceleration: [rad/s²] or [m/s²].
    """

    velocity: Range | None = None
    position: Range | None = None
    load_torque: Range | None = None
    normal_load: Range | None = None
    temperature: Range | None = None
    acceleration: Range | None = None

    def __post_init__(self) -> None:
        for name, limits in vars(self).items():
            if limits is not None and not (np.all(np.isfinite(limits)) and limits[0] <= limits[1]):
                raise ParameterError(f"the range of {name} must be finite and ascending, got {limits}")


@dataclass(frozen=True)
class Provenance:
    """How a model came to be.

    Attributes:
        method: How it was identified, such as `pinn`.
        data_sha256: Hash of the data; empty for a model that was written by hand.
        created: Date and time, ISO 8601.
        fricomp_version: Version that identified it.
        seed: Seed of the identification.
        notes: Further facts, such as `noise` or `torque_source`.
        status: How the identification ended, such as `converged`; empty where nobody said so.
        message: The same in a sentence.
        largest_torque: Largest friction of the data, in the model's torque unit; None without data.
        slowest_speeds: Slowest speed of the data in reverse and forward [rad/s] or [m/s]; nothing is known below.

    Raises:
        ParameterError: A torque or a speed is not finite or negative.
    """

    method: str = "given"
    data_sha256: str = ""
    created: str = ""
    fricomp_version: str = ""
    seed: int | None = None
    notes: dict[str, str] = field(default_factory=dict)
    status: str = ""
    message: str = ""
    largest_torque: float | None = None
    slowest_speeds: Range | None = None

    def __post_init__(self) -> None:
        found = [self.largest_torque or 0.0, *(self.slowest_speeds or ())]
        if not (np.all(np.isfinite(found)) and min(found) >= 0.0):
            raise ParameterError(
                f"largest_torque and slowest_speeds must be finite and not negative, got {self.largest_torque} and "
                f"{self.slowest_speeds}"
            )


@dataclass(frozen=True, repr=False)
class FrictionModel(Shown):
    """A friction law of one joint, in the unit of its actuator.

    It holds what `fricomp.load_model` reads and `fricomp.save_model` writes. `torque` gives the torque that must be
    added to overcome friction: it has the sign of the velocity.

    Attributes:
        law: The friction law.
        joint: Name of the joint.
        motion: `rotary` (rad) or `linear` (m).
        torque_unit: Unit in which torque was recorded and will be commanded: `N·m`, `N`, `A`, ...
        validity: Range of the data behind it.
        covariance: Of the identified parameters, or None.
        provenance: How it was identified.
        dynamics: Inertia, gravity and what else moves with the joint; None where the model is of friction alone.
    """

    law: FrictionLaw
    joint: str = "joint"
    motion: Motion = "rotary"
    torque_unit: str = "N·m"
    validity: Validity = Validity()
    covariance: Covariance | None = None
    provenance: Provenance = field(default_factory=Provenance)
    dynamics: JointDynamics | None = None

    def __post_init__(self) -> None:
        if self.motion not in ("rotary", "linear"):
            raise ParameterError(f"motion must be 'rotary' or 'linear', got {self.motion!r}")
        if self.covariance is not None:
            unknown = sorted(set(self.covariance.names) - set(self.law.parameters()))
            if unknown:
                raise ParameterError(f"the covariance names parameters the law does not have: {', '.join(unknown)}")

    @property
    def position_unit(self) -> str:
        """`rad` or `m`."""
        return "rad" if self.motion == "rotary" else "m"

    @property
    def forward(self) -> StribeckCurve:
        """The curve for v > 0.

        Raises:
            ParameterError: The law has no Stribeck curve.
        """
        return self._curves()[0]

    @property
    def reverse(self) -> StribeckCurve:
        """The curve for v < 0; its parameters are positive numbers.

        Raises:
            ParameterError: The law has no Stribeck curve.
        """
        return self._curves()[1]

    def _curves(self) -> tuple[StribeckCurve, StribeckCurve]:
        for term in self.law.terms:
            if isinstance(term, BidirectionalStribeck | LuGre):
                return term.forward, term.reverse
            if isinstance(term, Stribeck):
                return term.curve, term.curve
        raise ParameterError(
            f"the law of joint {self.joint!r} has no Stribeck curve; its terms are "
            f"{', '.join(term.name for term in self.law.terms)}"
        )

    def torque(self, velocity: Scalar, **inputs: Scalar | None) -> Scalar:
        """Friction torque in `torque_unit`; see `FrictionLaw.torque`.

        Raises:
            ParameterError: The velocity is no number and holds none.
        """
        if isinstance(velocity, float | np.ndarray):
            return self.law.torque(velocity, **inputs)
        if velocity is None:  # which numpy takes for no number
            raise ParameterError("velocity is None: give numbers [rad/s] or [m/s]")
        try:
            numbers = np.asarray(velocity, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise ParameterError(f"velocity must be numbers [rad/s] or [m/s], got {velocity!r}") from error
        return self.law.torque(numbers if numbers.ndim else float(numbers), **inputs)

    def units(self) -> dict[str, str]:
        """The unit of each parameter, by dotted name."""
        return self.law.units(self.torque_unit, self.position_unit)

    def headline(self) -> str:
        """Joint, terms of the law, unit."""
        return f"of joint {self.joint}: {' + '.join(term.name for term in self.law.terms)} [{self.torque_unit}]"

    def overview(self) -> Overview:
        """Parameters with their standard deviations where they are known, range of the data, and how it came to be."""
        return Overview(
            f"Friction of joint {self.joint}, {self.motion}: {' + '.join(term.name for term in self.law.terms)}",
            (*self._said_of_data(), *self._said_of_identification()),
            (OverviewTable(("parameter", "value ± standard deviation", "unit"), tuple(self._parameter_rows())),),
        )

    def plot(self) -> Figure:
        """Draw the friction torque over the velocity, in the range of the data, with matplotlib.

        Raises:
            MissingExtraError: matplotlib is not installed.
        """
        from fricomp.model.chart import friction_chart
        from fricomp.report import draw_figure

        low, high = self.validity.velocity or _PLOTTED
        chart = friction_chart(self.torque, max(abs(low), abs(high)), (self.position_unit, self.torque_unit))
        return draw_figure(replace(chart, title=f"Friction of joint {self.joint}"))

    def _parameter_rows(self) -> Iterator[tuple[str, str, str]]:
        deviations = self.covariance.standard_deviations() if self.covariance is not None else {}
        for (name, value), unit in zip(self.law.parameters().items(), self.units().values(), strict=True):
            known = name in deviations
            yield name, format_with_reach(value, deviations[name]) if known else f"{value:.6g}", unit

    def _said_of_data(self) -> Iterator[str]:
        x = self.position_unit
        units = {"velocity": f"{x}/s", "position": x, "acceleration": f"{x}/s²", "temperature": "°C"}
        for name, limits in vars(self.validity).items():
            if limits is not None:
                unit = units.get(name, self.torque_unit if name == "load_torque" else "")
                yield f"Data: {name.replace('_', ' ')} {format_range(limits, unit)}."

    def _said_of_identification(self) -> Iterator[str]:
        made = self.provenance
        if made.status:
            yield f"Identified by {made.method}, {made.status}: {made.message}."
        else:
            yield f"Method: {made.method}."

    def with_law(self, law: FrictionLaw) -> FrictionModel:
        """This model with another law; the covariance does not carry over."""
        return replace(self, law=law, covariance=None)
