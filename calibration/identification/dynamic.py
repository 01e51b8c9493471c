"""Dahl and LuGre from a time series with reversals: output error, the bristle simulated over the whole record."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from fricomp.errors import IdentificationError
from fricomp.laws import Dahl, FloatArray, FrictionLaw, LuGre, StribeckCurve
from fricomp.model import Covariance, FrictionModel, Provenance, Validity

from .estimation.correlated_fit import solve_correlated
from .estimation.form import separable_law
from .estimation.information import invert_information, with_least_variance
from .estimation.likelihood import Noise
from .estimation.observation import observe
from .estimation.optimum import fit_likelihood
from .options import DEFAULT_OPTIONS, IdentificationOptions
from .status import Status

_STEP = 1e-6
"""Step of the logarithms for the derivative; the output is smooth in them."""
_CURVE = ("coulomb_torque", "static_torque", "stribeck_velocity", "viscous_coefficient")
_STATIC = tuple(f"lugre.{d}.{p}" for d in ("forward", "reverse") for p in _CURVE)
_LUGRE = (*_STATIC, "lugre.sigma_0", "lugre.sigma_1")
_DAHL = ("dahl.coulomb_torque", "dahl.sigma_0")


@dataclass(frozen=True)
class DynamicIdentification:
    """A friction model with a bristle state, and how well it is known.

    Attributes:
        model: The friction model.
        status: Whether it can be trusted; see `message`.
        message: One sentence on the status.
        parameter_names: Dotted names, in the order of the covariance.
        parameters: Estimates by dotted name, in their own units.
        covariance: For errors that differ in size and are correlated. Shape (n_parameters, n_parameters).
        residual: Measured minus simulated torque [N·m] or [N]. Shape (n_samples,).
        negative_log_likelihood: Of white noise of unknown level.
    """

    model: FrictionModel
    status: Status
    message: str
    parameter_names: tuple[str, ...]
    parameters: dict[str, float]
    covariance: FloatArray
    residual: FloatArray
    negative_log_likelihood: float


def identify_dynamic(
    time: ArrayLike,
    velocity: ArrayLike,
    torque: ArrayLike,
    law: str = "lugre",
    *,
    options: IdentificationOptions = DEFAULT_OPTIONS,
) -> DynamicIdentification:
    """Identify `lugre` or `dahl` from a friction torque recorded over time, with reversals.

    Both laws have a state: a bristle of deflection z that stretches before the joint slips,

        z' = v - |v| z / g(v),    torque = sigma_0 z + sigma_1 z' + sigma_2 v,

    where g(v) sigma_0 is the friction of steady sliding [canudas1995lugre, dahl1968]. A table of velocity and torque
    cannot show it; a motion that turns round can. The bristle is simulated over the whole record, and the squares of
    what the simulation misses are made least.

    Args:
        time: Evenly spaced [s]. Shape (n,).
        velocity: At these times, smooth: differences of an encoder's counts need a low-pass without lag, for what they
            jump by passes for speed [rad/s] or [m/s]. Shape (n,).
        torque: Friction torque [N·m] or [N]. Shape (n,).
        law: `lugre` (ten parameters) or `dahl` (two): `dahl` where friction does not depend on speed, or where the
            record holds little steady sliding.
        options: Name, motion and torque unit of the joint; the others do not apply.

    Raises:
        IdentificationError: The samples are not evenly spaced, too few, never reverse, or the law is unknown.
    """
    t, v, tau = (np.asarray(a, dtype=np.float64) for a in (time, velocity, torque))
    dt = _check(t, v, tau, law)
    names = _LUGRE if law == "lugre" else _DAHL
    if law == "lugre":
        start = _start_lugre(v, tau, dt)
    else:
        level = float(np.median(np.abs(tau[v != 0.0])))
        start = _scan_stiffness(lambda s: np.log([level, s]), v, tau, dt)

    def residual(logs: FloatArray) -> FloatArray:
        return tau - simulate_bristle(np.exp(logs)[None], v, dt)[:, 0]

    def derivative(logs: FloatArray) -> FloatArray:
        shifted = np.exp(np.concatenate([logs[None], logs + _STEP * np.eye(len(logs))]))
        torques = simulate_bristle(shifted, v, dt)
        return np.asarray(-(torques[:, 1:] - torques[:, :1]) / _STEP)

    fit = least_squares(residual, start, derivative, method="lm", x_scale="jac", xtol=1e-10, ftol=1e-12, max_nfev=200)
    found = _make_result(np.asarray(fit.x), np.asarray(fit.fun), np.asarray(fit.jac), names, (v, tau), fit.status > 0)
    named = replace(found.model, joint=options.joint, motion=options.motion, torque_unit=options.torque_unit)
    return replace(found, model=named)


def simulate_bristle(values: FloatArray, velocity: FloatArray, dt: float) -> FloatArray:
    """Friction torque of several parameter sets at once, from a bristle at rest.

    Args:
        values: Rows of LuGre (ten values) or Dahl (two) parameters. Shape (n_sets, n_parameters).
        velocity: At each sample; over the step to it, the mean of both its ends [rad/s] or [m/s]. Shape (n_samples,).
        dt: Step [s].

    Returns:
        Torque [N·m] or [N]. Shape (n_samples, n_sets).
    """
    over_step = 0.5 * (velocity + np.concatenate([velocity[:1], velocity[:-1]]))
    mean = _build_bristle(values, over_step)
    target, keep = mean.steady * np.sign(over_step)[:, None], np.exp(-np.abs(over_step)[:, None] * dt / mean.steady)
    deflection = np.zeros_like(target)
    for k in range(1, len(velocity)):
        deflection[k] = target[k] + (deflection[k - 1] - target[k]) * keep[k]
    at, v = _build_bristle(values, velocity), velocity[:, None]
    rate = v - np.abs(v) * deflection / at.steady
    return np.asarray(at.stiffness * deflection + at.damping * rate + at.viscous * v)


class _Bristle(NamedTuple):
    """Deflection in steady sliding, viscous coefficient, sigma_0, sigma_1 at each velocity, of each set."""

    steady: FloatArray
    viscous: FloatArray
    stiffness: FloatArray
    damping: FloatArray


def _build_bristle(values: FloatArray, velocity: FloatArray) -> _Bristle:
    if values.shape[1] == len(_DAHL):
        nothing, stiffness = np.zeros(len(values)), values[:, 1]
        steady = np.broadcast_to(values[:, 0] / stiffness, (len(velocity), len(values)))
        return _Bristle(steady, nothing, stiffness, nothing)
    side = np.where((velocity >= 0.0)[:, None, None], values[:, :4], values[:, 4:8])
    falling = np.exp(-((velocity[:, None] / side[:, :, 2]) ** 2))
    dry = side[:, :, 0] + (side[:, :, 1] - side[:, :, 0]) * falling
    return _Bristle(dry / values[:, 8], side[:, :, 3], values[:, 8], values[:, 9])


def _check(t: FloatArray, v: FloatArray, tau: FloatArray, law: str) -> float:
    if law not in ("lugre", "dahl"):
        raise IdentificationError(f"unknown dynamic law {law!r}; use 'lugre' or 'dahl'")
    if not len(t) == len(v) == len(tau) or len(t) < 100:
        raise IdentificationError(
            f"time, velocity and torque need equal lengths of at least 100, got {len(t)}, {len(v)}, {len(tau)}"
        )
    if not np.all(np.isfinite(np.stack([t, v, tau]))):
        raise IdentificationError("time, velocity and torque must be finite; repair the recording first")
    steps = np.diff(t)
    dt = float(np.median(steps))
    if dt <= 0.0 or np.max(np.abs(steps - dt)) > 0.05 * dt:
        raise IdentificationError(f"samples must be evenly spaced; steps run from {steps.min():g} to {steps.max():g} s")
    if np.count_nonzero(np.diff(np.sign(v[v != 0.0]))) < 2:
        raise IdentificationError("a bristle shows at reversals only; record a motion that reverses at least twice")
    return dt


def _start_lugre(v: FloatArray, tau: FloatArray, dt: float) -> FloatArray:
    """Static curve from the samples that slide steadily, then a scan of the stiffness."""
    top = float(np.max(np.abs(v)))
    sliding = (np.abs(v) > 0.02 * top) & (np.sign(v) == np.sign(tau))
    points = observe(v[sliding], tau[sliding])
    static = fit_likelihood(separable_law("stribeck"), points, Noise("absolute")).logs
    return _scan_stiffness(lambda s: np.append(static, np.log([s, s * dt])), v, tau, dt)


def _scan_stiffness(build: Callable[[float], FloatArray], v: FloatArray, tau: FloatArray, dt: float) -> FloatArray:
    """The start whose stiffness suits best: bristles that slip after a millionth to the whole of the travel."""
    travel = max(float(np.ptp(np.cumsum(v) * dt)), 1e-12)
    stiffness = float(np.max(np.abs(tau))) / (travel * np.geomspace(1e-6, 1.0, 25))
    starts = [build(float(s)) for s in stiffness]
    errors = simulate_bristle(np.exp(np.array(starts)), v, dt) - tau[:, None]
    return starts[int(np.argmin(np.sum(errors**2, axis=0)))]


def _make_result(
    logs: FloatArray,
    residual: FloatArray,
    jacobian: FloatArray,
    names: tuple[str, ...],
    samples: tuple[FloatArray, FloatArray],
    done: bool,
) -> DynamicIdentification:
    values, (v, tau) = np.exp(logs), samples
    variance = float(residual @ residual) / max(len(residual) - len(logs), 1)
    covariance = invert_information(jacobian.T @ jacobian / max(variance, 1e-300))
    reach = round(len(residual) ** (1.0 / 3.0))  # grows slower than the record, as [newey1987] asks
    robust = solve_correlated(jacobian, residual, np.arange(len(residual)), reach).covariance
    robust = with_least_variance(robust, covariance)  # never surer than by independent, equal errors
    covariance = robust * np.outer(values, values)
    vague = [n for n, c, x in zip(names, np.diag(covariance), values, strict=True) if not c <= x**2]
    known = bool(np.all(np.isfinite(covariance)))  # a bristle that never shows has no slope at all
    status, message = Status.CONVERGED, "converged to a least-squares optimum of the simulated torque"
    if not done:
        status, message = Status.NOT_CONVERGED, "the search stopped at its limit of evaluations"
    elif vague:
        status, message = Status.NOT_IDENTIFIABLE, f"the data do not determine {', '.join(vague)}"
    model = FrictionModel(
        law=_build_law(values),
        validity=Validity(velocity=(float(v.min()), float(v.max()))),
        covariance=Covariance(names, 0.5 * (covariance + covariance.T), max(len(residual) - len(names), 1))
        if known
        else None,
        provenance=Provenance(
            method="output_error",
            status=str(status),
            message=message,
            largest_torque=float(np.max(np.abs(tau))),
        ),
    )
    n = len(residual)
    nll = 0.5 * n * (np.log(2.0 * np.pi * max(float(residual @ residual) / n, 1e-300)) + 1.0)
    parameters = dict(zip(names, values.tolist(), strict=True))
    return DynamicIdentification(model, status, message, names, parameters, covariance, residual, float(nll))


def _build_law(values: FloatArray) -> FrictionLaw:
    if len(values) == len(_DAHL):
        return FrictionLaw((Dahl(*values.tolist()),))
    v = values.tolist()
    return FrictionLaw((LuGre(StribeckCurve(*v[:4]), StribeckCurve(*v[4:8]), v[8], v[9]),))
