"""The joint with parameters as the simulation has them: what the error is before a parameter is put right."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from fricomp.model import FrictionModel

from ..inputs.rigid import RigidJoint
from ..inputs.track import FloatArray
from ..joint.base import BASE_NAMES
from ..joint.solver import Fit, minimise
from ..search.preparation import Baseline
from .settings import PARAMETERS

_BODY = ("log_inertia", "gravity_cos", "gravity_sin")
_LIFTED = ("log_inertia", "offset")  # of a linear axis, whose weight is a constant force
_WEIGHING = ("payload_error", "torque_gain_error")
_UNEVEN = ("torque_offset", "direction_asymmetry")


def fit_as_given(
    baseline: Baseline, names: Collection[str], rigid: RigidJoint | None, friction: FrictionModel | None
) -> Fit | None:
    """The base fitted with the parameters of the effects `names` as given; None where these were not given.

    Everything else is refitted, so that the error of this fit is that of these parameters alone; inertia and gravity,
    where a simulation says them, stay where the refit found them.
    """
    theta = baseline.fit.theta
    offset = 0.0 if rigid is None else rigid.offset
    fixed = _list_rigid_values(names, rigid) | _list_uneven_values(names, theta, friction, offset)
    if not fixed:
        return None
    if rigid is not None:  # over a short range gravity would take up a constant torque
        fixed = dict(zip(_BODY, theta[: len(_BODY)].tolist(), strict=True)) | fixed
    at = [BASE_NAMES.index(name) for name in fixed]
    lower, upper, start = (values.copy() for values in (baseline.box.lower, baseline.box.upper, baseline.fit.theta))
    lower[at] = upper[at] = start[at] = list(fixed.values())
    evaluate = baseline.problem.build_residual(baseline.problem.add_nothing)
    box = replace(baseline.box, lower=lower, upper=upper)
    fit = minimise(evaluate, start, box, iterations=PARAMETERS.iterations, refresh=2)
    jacobian = fit.jacobian.copy()
    jacobian[:, at] = 0.0  # what is given stays so on every fold
    return replace(fit, jacobian=jacobian)


def _list_rigid_values(names: Collection[str], rigid: RigidJoint | None) -> dict[str, float]:
    if rigid is None:
        return {}
    given = dict(zip(BASE_NAMES, (float(np.log(rigid.inertia)), *rigid.gravity, rigid.offset), strict=False))
    whole = _BODY if rigid.rotary else _LIFTED
    slots = {"inertia_error": ("log_inertia",), **dict.fromkeys(_WEIGHING, whole)}
    return {slot: given[slot] for name in names for slot in slots.get(name, ())}


def _list_uneven_values(
    names: Collection[str], theta: FloatArray, friction: FrictionModel | None, offset: float
) -> dict[str, float]:
    """The given offset, and the given difference of the directions about the level that was found: a joint that slides
    shows the sum of both only, so that one of them alone would take up what the other is held at."""
    if friction is None or not set(_UNEVEN) & set(names):
        return {}
    forward, reverse = "forward.coulomb_torque", "reverse.coulomb_torque"
    level = 0.5 * float(theta[BASE_NAMES.index(forward)] + theta[BASE_NAMES.index(reverse)])
    odd = 0.5 * (friction.forward.coulomb_torque - friction.reverse.coulomb_torque)
    return {"offset": offset, forward: max(level + odd, 0.0), reverse: max(level - odd, 0.0)}
