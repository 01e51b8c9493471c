"""`identify`: friction points in, a friction model with its uncertainty out."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from fricomp.blas import one_blas_thread
from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray, LoadScaling
from fricomp.model import Covariance, FrictionModel, Provenance, Validity

from .doubt import refuse_impossible
from .estimation.form import SeparableLaw, separable_law
from .estimation.gathering import gather_points
from .estimation.likelihood import Noise, parse_noise
from .estimation.observation import Observations, observe
from .estimation.optimum import Optimum, fit_likelihood, optimum_at
from .estimation.pinn import StartKind, TrainedPinn, train_pinn
from .estimation.robust import fit_robust
from .estimation.start import project_start, scan_basins, starting_points
from .inference.verdict import CLOSE_ENOUGH, covariance_of, judge
from .options import DEFAULT_OPTIONS, IdentificationOptions
from .provenance import compute_provenance
from .result import IdentificationResult, NoiseEstimate

Method = Literal["pinn", "least_squares"]
Loss = Literal["gaussian", "robust"]
_BEHIND = 0.5 * CLOSE_ENOUGH**2
"""Likelihood [nats] that a training may end behind the optimum: it is then as close as counts as converged."""
_SENSITIVITY_EVIDENCE = 3.84
"""Twice the gain in likelihood (95 % of chi-square) that a load sensitivity other than 1 must bring."""


@one_blas_thread()
def identify(
    velocity: ArrayLike,
    torque: ArrayLike,
    normal_load: ArrayLike | None = None,
    method: Method = "pinn",
    noise: str | ArrayLike = "auto",
    seed: int = 0,
    *,
    law: str = "stribeck",
    loss: Loss = "gaussian",
    options: IdentificationOptions = DEFAULT_OPTIONS,
) -> IdentificationResult:
    """Identify a static friction law from friction points.

    Args:
        velocity: [rad/s] or [m/s]. Shape (n,).
        torque: Friction torque, with the sign of the velocity [N·m] or [N]. Shape (n,).
        normal_load: Normal load of each point or of all, where dry friction depends on it, in any unit that later
            loads share, such as [N]. Shape () or (n,).
        method: `pinn` trains the paper's network and the parameters together; `least_squares` maximises the
            likelihood of the closed form alone, which has the same optimum.
        noise: `relative` to the model's torque, `absolute`, `auto` (decided by likelihood), or one standard
            deviation a point [N·m] or [N].
        seed: Seed of the network's first weights.
        law: `stribeck` (eight parameters), `free_stribeck` (its two exponents too), `symmetric_stribeck`, `coulomb`,
            `coulomb_viscous`, `asymmetric_coulomb_viscous`, `tanh`, `arctan`. `lugre` and `dahl` have a state and
            need a time series with reversals: see `identify_dynamic`.
        loss: `gaussian`, or `robust` against outliers.
        options: Further settings.

    Raises:
        IdentificationError: The data or an argument cannot be used; the message says why.
    """
    refuse_dynamic(law)
    require_choice("method", method, ("pinn", "least_squares"))
    require_choice("loss", loss, ("gaussian", "robust"))
    points = observe(velocity, torque, normal_load)
    candidates = parse_noise(noise, points.kept, np.size(velocity))
    rows, form, fits = _fit_rows(law, points, candidates, loss, options.reference_load)
    kind = min(fits, key=lambda k: fits[k].negative_log_likelihood)
    reference = fits[kind]
    trained = _train(form, rows, reference, options, seed) if method == "pinn" else None
    found = trained.optimum if trained else reference
    covariance = covariance_of(found)
    verdict = judge(found, reference, covariance, form, rows, independent=options.independent)
    estimate = NoiseEstimate(
        kind, _describe_noise_level(kind, found, rows), {k: fit.negative_log_likelihood for k, fit in fits.items()}
    )
    largest = float(np.max(found.magnitude))
    provenance = compute_provenance(points, estimate, verdict, largest, method=method, seed=seed)
    freedom = max((options.measurements or points.size) - len(form.names), 1)
    result = IdentificationResult(
        model=_build_model(form, found, Covariance(form.names, covariance, freedom), points, options, provenance),
        status=verdict.status,
        message=verdict.message,
        method=method,
        parameter_names=form.names,
        covariance=covariance,
        freedom=freedom,
        noise=estimate,
        negative_log_likelihood=found.negative_log_likelihood,
        distance_to_optimum=verdict.distance,
        traces=trained.traces if trained else None,
        identifying_network=trained.network if trained else None,
        observations=points,
        rows=rows,
        form=form,
        optimum=found,
        seed=seed,
    )
    return refuse_impossible(result, points.speed)


def refuse_dynamic(law: str) -> None:
    """Raise `IdentificationError` for a law with a state, which friction points cannot show."""
    if law in ("lugre", "dahl"):
        raise IdentificationError(
            f"{law} has a bristle state, which points of velocity and torque do not show: use "
            "fricomp.identify_dynamic(time, velocity, torque) with a recorded motion that reverses"
        )


def require_choice(what: str, value: object, choices: tuple[str, ...]) -> None:
    """Raise `IdentificationError` unless `value` is one of `choices`."""
    if value not in choices:
        raise IdentificationError(f"unknown {what} {value!r}; use {', '.join(choices)}")


def _fit_rows(
    law: str, points: Observations, candidates: Sequence[Noise], loss: Loss, reference_load: float | None
) -> tuple[Observations, SeparableLaw, dict[str, Optimum]]:
    """The rows that stand for the points, the law's form, and its optimum by noise model.

    Many points are gathered about a first fit to what they show without one. Outliers, and points that are known each
    to its own deviation, are not the same for a mean: these stay as they are.
    """
    given = candidates[0].deviation
    alone = loss == "robust" or (given is not None and float(np.ptp(given)) > 0.0)
    rows = points if alone else gather_points(points)
    form, fits = _fit_forms(law, rows, [noise.counting(rows) for noise in candidates], loss, reference_load)
    if rows is points:
        return rows, form, fits
    logs = min(fits.values(), key=lambda fit: fit.negative_log_likelihood).logs
    rows = gather_points(points, lambda some: form.evaluate(logs, some)[0])
    return rows, *_fit_forms(law, rows, [noise.counting(rows) for noise in candidates], loss, reference_load)


def _fit_forms(
    law: str, points: Observations, candidates: Sequence[Noise], loss: Loss, reference_load: float | None
) -> tuple[SeparableLaw, dict[str, Optimum]]:
    """The law's form, load sensitivity free only where the data ask for it, and its optimum by noise model."""

    def fit(form: SeparableLaw) -> dict[str, Optimum]:
        solve = fit_robust if loss == "robust" else fit_likelihood
        scan = scan_basins(form, points, candidates[0], robust=loss == "robust")
        return {noise.kind: solve(form, points, noise, scan) for noise in candidates}

    known = points.normal_load
    if reference_load is not None and not 0.0 < reference_load < np.inf:
        raise IdentificationError(f"reference_load must be finite and above 0, got {reference_load!r}")
    reference = reference_load or (1.0 if known is None else float(np.average(known, weights=points.count)))
    form = separable_law(law, LoadScaling(1.0, reference))
    fits = fit(form)
    if known is None or np.ptp(known) == 0.0:
        return form, fits
    free = separable_law(law, LoadScaling(1.0, reference), free_sensitivity=True)
    free_fits = fit(free)
    gain = _get_least(fits) - _get_least(free_fits)
    return (free, free_fits) if 2.0 * gain > _SENSITIVITY_EVIDENCE else (form, fits)


def _get_least(fits: Mapping[str, Optimum]) -> float:
    return min(fit.negative_log_likelihood for fit in fits.values())


def _train(
    form: SeparableLaw, points: Observations, reference: Optimum, options: IdentificationOptions, seed: int
) -> TrainedPinn:
    """Train from the start that was given, then from those of the projection, until one ends at the optimum.

    Where none does, training starts at the optimum of least squares; the traces say so.
    """
    best = optimum_at(reference.logs, form, points, reference.noise)  # a robust fit's likelihood is another
    for kind, logs in _propose_starts(form, points, reference.noise, options.start):
        start = optimum_at(np.minimum(logs, form.upper_logs(points)), form, points, reference.noise)
        trained = train_pinn(form, points, start, seed=seed)
        behind = trained.optimum.negative_log_likelihood - best.negative_log_likelihood
        if trained.optimum.is_exact() or (trained.converged and behind < _BEHIND):
            return trained._replace(traces=replace(trained.traces, start=kind))
    trained = train_pinn(form, points, best, seed=seed)
    return trained._replace(traces=replace(trained.traces, start="least_squares"))


def _propose_starts(
    form: SeparableLaw, points: Observations, noise: Noise, given: Mapping[str, float] | None
) -> Iterator[tuple[StartKind, FloatArray]]:
    if given is not None:
        if set(form.names) ^ set(given) or min(given.values()) <= 0.0:
            raise IdentificationError(f"start must give a positive value for each of {', '.join(form.names)}")
        yield "given", project_start(form, points, noise, np.log([given[name] for name in form.names]))
    for logs in starting_points(form, points, noise, robust=False):
        yield "projection", logs


def _describe_noise_level(kind: str, found: Optimum, points: Observations) -> float:
    error = points.root_count * (points.magnitude - found.magnitude)
    if kind == "relative":
        error = error / found.magnitude
    elif found.noise.kind == "given" and kind == "given":
        error = found.whitened.residual
    if found.noise.kind == "given" and kind != "given":
        return float(np.median(np.abs(error)) / 0.6745)
    return float(np.sqrt(np.sum(error**2) / max(points.total - len(found.logs), 1)))


def _build_model(
    form: SeparableLaw,
    found: Optimum,
    covariance: Covariance,
    points: Observations,
    options: IdentificationOptions,
    provenance: Provenance,
) -> FrictionModel:
    velocity, load = points.velocity, points.normal_load
    return FrictionModel(
        law=form.law(dict(zip(form.names, np.exp(found.logs).tolist(), strict=True))),
        joint=options.joint,
        motion=options.motion,
        torque_unit=options.torque_unit,
        validity=Validity(
            velocity=(float(velocity.min()), float(velocity.max())),
            normal_load=None if load is None else (float(load.min()), float(load.max())),
        ),
        covariance=covariance,
        provenance=provenance,
    )
