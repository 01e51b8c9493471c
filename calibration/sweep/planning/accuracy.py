"""What a plan can tell, before anything moves: the Cramér-Rao bound of the parameters for an assumed joint."""

from dataclasses import dataclass

import numpy as np

from fricomp.laws import BidirectionalStribeck, FloatArray, FrictionLaw, StribeckCurve

from ...identification.estimation.information import compute_log_deviations
from .plan import SweepPlan


@dataclass(frozen=True)
class Assumption:
    """What a joint is taken to be like.

    Attributes:
        law: Its friction.
        torque_noise: Of one sample, standard deviation [N·m] or [N].
        sample_rate: Of independent samples [Hz].
    """

    law: FrictionLaw
    torque_noise: float
    sample_rate: float


def assume_friction(top_speed: float, torque_limit: float, sample_rate: float) -> Assumption:
    """A joint of which nothing is known: Coulomb torque a twentieth of the limit, static torque 1.5 times that, the
    bend at a fiftieth of the top speed, viscous torque as large as Coulomb's at the top, noise 2 % of Coulomb's.

    Args:
        top_speed: Highest speed of the plan [rad/s] or [m/s].
        torque_limit: Of the drive [N·m] or [N].
        sample_rate: [Hz].
    """
    coulomb = 0.05 * torque_limit if np.isfinite(torque_limit) else 1.0
    curve = StribeckCurve(coulomb, 1.5 * coulomb, top_speed / 50.0, coulomb / top_speed)
    return Assumption(FrictionLaw((BidirectionalStribeck(curve, curve),)), 0.02 * coulomb, sample_rate)


def expected_deviations(plan: SweepPlan, assumption: Assumption) -> dict[str, float]:
    """Relative standard deviation of each Stribeck parameter that the plan cannot do better than [1].

    Infinite where no plateau of the plan says anything about a parameter.

    Plateau means scatter by the sample noise over the root of the number of samples; the bound is the inverse of
    the Fisher information of them all.
    """
    names = [n for n in assumption.law.parameters() if n.split(".")[-1] in _CURVE]
    velocity = np.array([plateau.velocity for plateau in plan.plateaus])
    samples = np.array([plateau.dwell for plateau in plan.plateaus]) * assumption.sample_rate
    deviation = assumption.torque_noise / np.sqrt(samples)
    scaled = _compute_relative_jacobian(assumption.law, names, velocity) / deviation[:, None]
    return dict(zip(names, compute_log_deviations(scaled.T @ scaled).tolist(), strict=True))


_CURVE = ("coulomb_torque", "static_torque", "stribeck_velocity", "viscous_coefficient")


def _compute_relative_jacobian(law: FrictionLaw, names: list[str], velocity: FloatArray) -> FloatArray:
    """Derivative of the torque by the logarithm of each parameter. Shape (n_plateaus, n_names)."""
    step, values = 1e-5, law.parameters()
    columns = []
    for name in names:
        up, down = (np.asarray(law.replace({name: values[name] * (1.0 + s)}).torque(velocity)) for s in (step, -step))
        columns.append((up - down) / (2.0 * step))
    return np.column_stack(columns)
