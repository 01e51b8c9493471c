"""How sure a model is of its friction: the gain that does not compensate more than is there."""

from dataclasses import replace

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray, FrictionLaw, trace_parts
from fricomp.model import Covariance, FrictionModel

_POINTS = 40
_NORMAL_95 = 1.645  # one-sided 95 % quantile of the normal distribution


def compute_friction_deviation(
    model: FrictionModel, velocity: FloatArray, normal_load: float | None = None
) -> FloatArray:
    """Standard deviation of the modelled friction, from the parameters' covariance to first order.

    Args:
        model: With a covariance.
        velocity: Shape (n,) [rad/s] or [m/s].
        normal_load: Normal load, or None.

    Returns:
        Shape (n,), in the model's torque unit.

    Raises:
        ParameterError: The model has no covariance.
    """
    if model.covariance is None:
        raise ParameterError(f"the model of joint {model.joint!r} has no covariance")
    law, values = model.law, model.law.parameters()
    base = np.asarray(law.torque(velocity, normal_load=normal_load))
    columns = []
    for name in model.covariance.names:
        step = 1e-6 * max(abs(values[name]), 1e-9)
        moved = law.replace({name: values[name] + step})
        columns.append((np.asarray(moved.torque(velocity, normal_load=normal_load)) - base) / step)
    jacobian = np.column_stack(columns)
    variance: FloatArray = np.einsum("ij,jk,ik->i", jacobian, model.covariance.matrix, jacobian)
    return np.sqrt(np.maximum(variance, 0.0))


def compute_confident_gain(model: FrictionModel, velocity_range: tuple[float, float]) -> float | None:
    """Smallest ratio of the lower 95 % bound of friction to friction, over velocities and identified loads.

    What holds a position, such as a spring, is no friction and does not count.

    Returns:
        The ratio [1], which may be negative where nothing is known, or None without a covariance.
    """
    if model.covariance is None:
        return None
    model = _drop_held_terms(model, model.covariance)
    top = min(abs(velocity_range[0]), velocity_range[1])
    speeds = np.geomspace(1e-3 * top, top, _POINTS)
    velocity = np.concatenate([speeds, -speeds])
    ratios = []
    for load in model.validity.normal_load or (None,):
        friction = np.abs(np.asarray(model.law.torque(velocity, normal_load=load)))
        ratios.append(
            1.0 - _NORMAL_95 * compute_friction_deviation(model, velocity, load) / np.maximum(friction, 1e-300)
        )
    return float(np.min(ratios))


def _drop_held_terms(model: FrictionModel, covariance: Covariance) -> FrictionModel:
    """`model` with the terms that resist a motion alone; as it is where there is no other, or none at all."""
    resisting = [term for term in model.law.terms if trace_parts(term).held is None]
    if len(resisting) in (0, len(model.law.terms)):
        return model
    law = FrictionLaw(tuple(resisting))
    kept = [k for k, name in enumerate(covariance.names) if name in law.parameters()]
    names = tuple(covariance.names[k] for k in kept)
    return replace(model, law=law, covariance=Covariance(names, covariance.matrix[np.ix_(kept, kept)]))
