"""The paper's identification problem: its law, its grids, its noise in both readings, its limit."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fricomp.calibration.identification.estimation.form import SeparableLaw, separable_law
from fricomp.calibration.identification.estimation.observation import Observations, observe
from fricomp.laws import BidirectionalStribeck, FloatArray, FrictionLaw, LoadScaling, StribeckCurve

Reading = Literal["none", "relative", "absolute"]
NOISE_READINGS: tuple[Reading, Reading] = ("relative", "absolute")
PARAMETERS = ("f_c+", "f_s+", "v_s+", "f_v+", "f_c-", "f_s-", "v_s-", "f_v-")
UPPER_BOUNDS = np.array([1.0, 1.0, 0.1, 0.1, 1.0, 1.0, 0.1, 0.1])
"""Search bounds of PSO and GA in [luo2024pinn], section IV; the lower ones are 0."""
_NOISE = 0.05


@dataclass(frozen=True)
class Draw:
    """One set of data.

    Attributes:
        velocity: [rad/s]. Shape (n,), rest included.
        torque: [N·m]. Shape (n,).
        reading: How the noise was read.
        seed: Seed of the noise.
    """

    velocity: FloatArray
    torque: FloatArray
    reading: Reading
    seed: int

    @property
    def points(self) -> Observations:
        """The points in motion."""
        return observe(self.velocity, self.torque)


@dataclass(frozen=True)
class PaperProblem:
    """Table I of [luo2024pinn] and its two grids."""

    true_values: tuple[float, ...] = (0.15, 0.60, 0.05, 0.02, 0.20, 0.70, 0.05, 0.03)

    @property
    def form(self) -> SeparableLaw:
        """The law in separable form."""
        return separable_law("stribeck")

    @property
    def law(self) -> FrictionLaw:
        """The law with the true values."""
        return self.law_under(LoadScaling())

    def law_under(self, load: LoadScaling) -> FrictionLaw:
        """The law with the true values, its dry friction following the normal load."""
        values = self.true_values
        return FrictionLaw((BidirectionalStribeck(StribeckCurve(*values[:4]), StribeckCurve(*values[4:]), load),))

    def velocity(self, reading: Reading) -> FloatArray:
        """41 points without noise, 201 with it [rad/s]."""
        n, step = (20, 0.05) if reading == "none" else (100, 0.01)
        return step * np.arange(-n, n + 1, dtype=np.float64)

    def draw(self, reading: Reading, seed: int) -> Draw:
        """One set of data; 5 % of each value (`relative`) or of the standard deviation of all (`absolute`)."""
        velocity = self.velocity(reading)
        torque = np.asarray(self.law.torque(velocity))
        normal = np.random.default_rng([seed, NOISE_READINGS.index(reading) if reading != "none" else 2])
        if reading != "none":
            torque = np.asarray(torque + self.deviation(reading, torque) * normal.normal(size=len(torque)))
        return Draw(velocity, torque, reading, seed)

    def deviation(self, reading: Reading, torque: FloatArray) -> FloatArray:
        """Standard deviation of the noise of each point [N·m]. Shape (n,)."""
        return np.asarray(_NOISE * (np.abs(torque) if reading == "relative" else np.full_like(torque, torque.std())))

    def cramer_rao(self, reading: Reading, kept: FloatArray | None = None) -> FloatArray:
        """Least standard deviation of each parameter that an unbiased method can have. Shape (8,).

        The noise's standard deviation counts as known weights, as in weighted least squares.

        Args:
            reading: `relative` or `absolute`.
            kept: Share of the information that each point in motion gives, or None for all of it. Shape (n,).
        """
        velocity = self.velocity(reading)
        torque = np.asarray(self.law.torque(velocity))
        moving = velocity != 0.0
        deviation = self.deviation(reading, torque)[moving]
        _, jacobian = self.form.evaluate(np.log(self.true_values), observe(velocity, torque))
        scaled = jacobian / np.array(self.true_values) / deviation[:, None]
        share = np.ones(len(deviation)) if kept is None else kept
        return np.asarray(np.sqrt(np.diag(np.linalg.inv((scaled * share[:, None]).T @ scaled))))

    def error_percent(self, values: FloatArray) -> FloatArray:
        """|error| of each parameter [%]. Shape (8,)."""
        true = np.array(self.true_values)
        return np.asarray(100.0 * np.abs(values - true) / true)

    def compute_mean_error(self, values: Sequence[float] | FloatArray) -> float:
        """Mean of `error_percent` [%]."""
        return float(np.mean(self.error_percent(np.array(values))))
