"""What a format that knows less than the model loses: fits of its terms, and the error that stays."""

from dataclasses import dataclass

import numpy as np

from fricomp.control.compensation.choice import choose_settings
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

_POINTS = 200
_ROUNDING = 1e-12
"""Error over the largest friction that is rounding alone."""


@dataclass(frozen=True)
class Fidelity:
    """Loss of an export, in steady sliding over the model's range of velocity.

    Attributes:
        rms: Root mean square error, in the torque unit.
        largest: Largest error, in the torque unit.
        at_velocity: Where it is [rad/s] or [m/s].
        relative_rms: RMS error over the RMS of the friction [1].
        torque_unit: Unit of the errors.
        position_unit: `rad` or `m`.
        lost: What the format cannot say, in sentences.
    """

    rms: float
    largest: float
    at_velocity: float
    relative_rms: float
    torque_unit: str
    position_unit: str
    lost: tuple[str, ...] = ()

    def __str__(self) -> str:
        head = (
            f"steady friction is off by {self.rms:.3g} {self.torque_unit} RMS ({self.relative_rms:.1%}), at most "
            f"{self.largest:.3g} {self.torque_unit} at {self.at_velocity:.3g} {self.position_unit}/s"
        )
        return "; ".join([head, *self.lost])


def sample_friction(model: FrictionModel) -> tuple[FloatArray, FloatArray]:
    """Velocities of both directions, evenly over half of the range and dense near rest, and the friction there.

    Returns:
        Velocity [rad/s] or [m/s] and torque, each of shape (n,).
    """
    low, high = choose_settings(model).velocity_range
    steps = np.concatenate([np.geomspace(1e-3, 1.0, _POINTS // 2), np.linspace(1e-3, 1.0, _POINTS // 2)])
    velocity = np.unique(np.concatenate([high * steps, low * steps]))
    return velocity, np.asarray(model.torque(velocity), dtype=np.float64)


def compute_fidelity(
    model: FrictionModel, velocity: FloatArray, exported: FloatArray, lost: tuple[str, ...]
) -> Fidelity:
    """Error of `exported` torque against the model at `velocity`, each of shape (n,)."""
    friction = np.asarray(model.torque(velocity), dtype=np.float64)
    error = exported - friction
    error[np.abs(error) < _ROUNDING * np.max(np.abs(friction), initial=0.0)] = 0.0
    worst = int(np.argmax(np.abs(error)))
    rms, size = np.sqrt(np.mean(error**2)), np.sqrt(np.mean(friction**2))
    return Fidelity(
        rms=float(rms),
        largest=float(abs(error[worst])),
        at_velocity=float(velocity[worst]),
        relative_rms=float(rms / size) if size > 0.0 else 0.0,
        torque_unit=model.torque_unit,
        position_unit=model.position_unit,
        lost=lost,
    )


def fit_levels(velocity: FloatArray, torque: FloatArray) -> tuple[float, float]:
    """Coulomb level and viscous coefficient, neither negative, that come closest to `torque`.

    Returns:
        The level [N·m] or [N] and the coefficient [N·m·s/rad] or [N·s/m].
    """
    basis = np.column_stack([np.sign(velocity), velocity])
    level, slope = np.linalg.lstsq(basis, torque, rcond=None)[0].tolist()
    if slope < 0.0:
        return float(np.mean(np.abs(torque))), 0.0
    if level < 0.0:
        return 0.0, float(torque @ velocity / (velocity @ velocity))
    return float(level), float(slope)
