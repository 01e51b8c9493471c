"""The friction of a joint as a law can hold it: no level and no slope below zero, no more in a bristle than slides.

A fit is free to have a viscous slope of the wrong sign beside a term that makes up for it. Cut off at zero, such a
slope would leave a model that fits nothing; so the nearest parameters that a law can have are taken, nearest by what
the torques would change:

    minimise  (f - f_0)ᵀ H (f - f_0)   with  A f ≥ b
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from fricomp.laws import FloatArray

from .friction import column_names
from .identification import ArmIdentification
from .rigid.inertia import N_INERTIA

_LEAST_LEVEL = 1e-3
"""Of the Coulomb level, that a level of one direction has at least: a law has positive levels only."""

_POSITIVE = (
    "creep.level",
    "load_coulomb.coefficient",
    "load_quadratic.coefficient",
    "power_law_viscous.torque_at_top_speed",
    "presliding_hysteresis.level",
    "quadratic_drag.coefficient",
    "spring_torque.stiffness",
)


def fit_within_law(found: ArmIdentification, joint: int) -> dict[str, float]:
    """Friction parameters of a joint that a law can have, the fitted ones where they are such.

    Args:
        found: The identified arm.
        joint: Number of the joint.
    """
    fit, equations = found.fit, found.equations
    place, names = fit.find_friction(joint)
    values = fit.x[place]
    limits, least = _list_limits(names, values)
    if np.all(limits @ values >= least):
        return dict(zip(names, values.tolist(), strict=True))
    first = N_INERTIA * len(fit.arm.links) + 1
    columns = first + np.array([column_names().index(name) for name in names])
    scale = equations.weights.noise[joint] ** 2
    H = equations.sums[joint][np.ix_(columns, columns)] / scale + np.diag(fit.prior_deviation[place] ** -2.0)
    nearest = zip(names, _project(values, H, limits, least).tolist(), strict=True)
    return {name: max(one, 0.0) if name.startswith(_POSITIVE) else one for name, one in nearest}  # but for rounding


def _list_limits(names: tuple[str, ...], values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A and b of all that a law asks for. Shapes (n_limits, n_parameters) and (n_limits,)."""
    short = {name.rsplit(".", 1)[0] if "." in name else name: k for k, name in enumerate(names)}
    level = _LEAST_LEVEL * max(float(values[short["coulomb"]]), 1e-6)
    rows: list[tuple[dict[str, float], float]] = []
    for sign in (1.0, -1.0):
        slide = {"coulomb": 1.0, "offset": sign, "presliding_hysteresis.level": -1.0, "creep.level": -1.0}
        rows.append((slide, level))
        rows.append(({"viscous": 1.0, "viscous_difference": sign}, 0.0))
        if "stribeck.excess" in short:
            rows.append((slide | {"stribeck.excess": 1.0, "stribeck.excess_difference": sign}, level))
    rows += [({name: 1.0}, 0.0) for name in _POSITIVE if name in short]
    A = np.zeros((len(rows), len(names)))
    for row, (weights, _) in zip(A, rows, strict=True):
        for name, weight in weights.items():
            if name in short:
                row[short[name]] = weight
    return A, np.array([least for _, least in rows])


def _project(values: FloatArray, H: FloatArray, A: FloatArray, b: FloatArray) -> FloatArray:
    """The nearest point with A f ≥ b: least distance programming by non-negative least squares [lawson1974]."""
    root = np.linalg.cholesky(H)
    G, h = np.linalg.solve(root, A.T).T, b - A @ values
    E = np.vstack([G.T, h])
    goal = np.zeros(len(E))
    goal[-1] = 1.0
    weights, _ = nnls(E, goal)
    left = E @ weights - goal
    return np.asarray(values + np.linalg.solve(root.T, -left[:-1] / left[-1]))
