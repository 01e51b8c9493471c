"""Baselines: greedy selection by BIC, least squares with all terms, a sparse regression, parameters only, a network."""

import warnings
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from typing import Any

import numpy as np

from fricomp.root_mean_square import compute_rms

from ...kit.rigid_joint import Samples
from .data import BaselineAnswer, BaselineData, fit_columns
from .library import build_library

__all__ = ["METHODS", "fit_base"]

_LARGEST = 4  # effects that greedy selection may take
_NAMED = 0.1  # share of the largest contribution that counts as a name


def fit_base(data: BaselineData) -> BaselineAnswer:
    """The rigid joint with a bidirectional Stribeck curve, refitted."""
    return BaselineAnswer((), fit_columns(data, data.base))


def _whiten(data: BaselineData, columns: Samples) -> tuple[Samples, Samples]:
    """Training columns and torque with the base projected out."""
    train = ~data.held_out
    basis, _ = np.linalg.qr(data.base[train] / np.linalg.norm(data.base[train], axis=0).clip(1e-12))
    wanted, given = data.torque[train], columns[train]
    return given - basis @ (basis.T @ given), wanted - basis @ (basis.T @ wanted)


def _compute_bic(columns: Samples, wanted: Samples) -> float:
    left = wanted if columns.shape[1] == 0 else wanted - columns @ np.linalg.lstsq(columns, wanted, rcond=1e-8)[0]
    return float(wanted.size * np.log(np.mean(left**2)) + columns.shape[1] * np.log(wanted.size))


def greedy_bic(data: BaselineData) -> BaselineAnswer:
    """Add the effect that lowers BIC most, until none does."""
    library = build_library(data)
    projected = {name: _whiten(data, columns)[0] for name, columns in library.items()}
    wanted = _whiten(data, data.base)[1]
    chosen: list[str] = []
    current, best = np.empty((wanted.size, 0)), _compute_bic(np.empty((wanted.size, 0)), wanted)
    while len(chosen) < _LARGEST:
        trials = {n: _compute_bic(np.hstack([current, c]), wanted) for n, c in projected.items() if n not in chosen}
        name = min(trials, key=lambda n: trials[n])
        if trials[name] >= best:
            break
        chosen.append(name)
        current, best = np.hstack([current, projected[name]]), trials[name]
    return BaselineAnswer(tuple(chosen), fit_columns(data, np.hstack([data.base, *(library[n] for n in chosen)])))


def _sort_names_by_size(contributions: dict[str, float]) -> tuple[str, ...]:
    largest = max(contributions.values(), default=0.0)
    order = sorted(contributions, key=lambda name: -contributions[name])
    return tuple(name for name in order if contributions[name] > _NAMED * largest > 0.0)


def least_squares_all(data: BaselineData) -> BaselineAnswer:
    """All terms at once; named is what contributes at least a tenth of the largest."""
    library = build_library(data)
    columns = np.hstack(list(library.values()))
    projected, wanted = _whiten(data, columns)
    scale = np.linalg.norm(projected, axis=0).clip(1e-12)
    solution = np.linalg.lstsq(projected / scale, wanted, rcond=1e-8)[0] / scale
    names = _sort_names_by_size(_measure_contributions(library, projected, solution))
    return BaselineAnswer(names, fit_columns(data, np.hstack([data.base, columns])))


def _measure_contributions(library: dict[str, Samples], projected: Samples, solution: Samples) -> dict[str, float]:
    found, start = {}, 0
    for name, columns in library.items():
        part = slice(start, start + columns.shape[1])
        found[name], start = compute_rms(projected[:, part] @ solution[part]), part.stop
    return found


def sparse_regression(data: BaselineData) -> BaselineAnswer:
    """Lasso with its penalty from cross-validation on the torque that the rigid joint leaves."""
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.linear_model import LassoCV

    library = build_library(data)
    columns = np.hstack(list(library.values()))
    projected, wanted = _whiten(data, columns)
    scale = np.linalg.norm(projected, axis=0).clip(1e-12) / np.sqrt(wanted.size)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        model = LassoCV(cv=4, max_iter=2000, fit_intercept=False).fit(projected / scale, wanted)
    names = _sort_names_by_size(_measure_contributions(library, projected, model.coef_ / scale))
    kept = columns[:, model.coef_ != 0.0]
    return BaselineAnswer(names, fit_columns(data, np.hstack([data.base, kept])))


def sysid_parameters(data: BaselineData) -> BaselineAnswer:
    """`mujoco.sysid` on the parameters that MuJoCo's joint has: inertia, gravity, Coulomb and viscous friction."""
    import mujoco
    from mujoco import sysid

    library: Any = mujoco  # carries no types
    model = library.MjModel.from_xml_path(str(data.simulation))
    mass, place, inertia = float(model.body_mass[1]), model.body_ipos[1], float(model.body_inertia[1, 1])
    start = compute_rms(data.torque)
    parameters = sysid.ParameterDict()
    for name, nominal, low, high in (
        ("moment_x", mass * place[0], -20.0, 20.0),
        ("moment_z", mass * place[2], -20.0, 20.0),
        ("inertia", inertia + mass * float(place @ place), 1e-3, 20.0),
        ("frictionloss", 0.2 * start, 0.0, 100.0),
        ("damping", 0.2 * start, 0.0, 100.0),
    ):
        parameters.add(sysid.Parameter(name, nominal, low, high))
    train = ~data.held_out

    def residual(x: Samples, _: Any) -> tuple[list[Samples], None, None]:
        return [(_compute_joint_torque(data, x) - data.torque)[train]], None, None

    with redirect_stdout(StringIO()):  # it prints its iterations and takes no order not to
        fitted, _ = sysid.optimize(parameters, residual, optimizer="scipy", verbose=False)
    return BaselineAnswer(
        (), compute_rms((_compute_joint_torque(data, fitted.as_vector()) - data.torque)[data.held_out])
    )


def _compute_joint_torque(data: BaselineData, x: Samples) -> Samples:
    """Inverse dynamics of MuJoCo's hinge with moments, inertia, frictionloss and damping, in closed form."""
    gravity = -9.81 * (x[0] * np.cos(data.position) + x[1] * np.sin(data.position))
    friction = x[3] * np.sign(data.velocity) + x[4] * data.velocity
    return np.asarray(x[2] * data.acceleration + gravity + friction)


def network_residual(data: BaselineData) -> BaselineAnswer:
    """A network of 32 hidden units on what the rigid joint leaves; it names nothing."""
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.neural_network import MLPRegressor
    from sklearn.preprocessing import StandardScaler

    train = ~data.held_out
    solution = np.linalg.lstsq(data.base[train], data.torque[train], rcond=1e-10)[0]
    left = data.torque - data.base @ solution
    inputs = np.stack([data.position, data.velocity, data.acceleration, data.load, np.sign(data.velocity)], axis=1)
    scaler = StandardScaler().fit(inputs[train])
    size = compute_rms(left[train])
    model = MLPRegressor(hidden_layer_sizes=(32,), max_iter=200, early_stopping=True, random_state=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        model.fit(scaler.transform(inputs[train]), left[train] / size)
    predicted = model.predict(scaler.transform(inputs)) * size
    return BaselineAnswer((), compute_rms((left - predicted)[data.held_out]))


METHODS: dict[str, Callable[[BaselineData], BaselineAnswer]] = {
    "greedy BIC": greedy_bic,
    "least squares, all terms": least_squares_all,
    "sparse regression": sparse_regression,
    "mujoco.sysid, parameters only": sysid_parameters,
    "network on the residual": network_residual,
}
