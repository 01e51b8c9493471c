"""Which law the data ask for, by the likelihood of points that the fit did not see."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

from .estimation.form import separable_law, separable_law_names
from .estimation.gathering import gather_points
from .estimation.likelihood import Noise
from .estimation.observation import Observations, observe
from .estimation.optimum import fit_likelihood
from .estimation.start import scan_basins

_FOLDS = 5


@dataclass(frozen=True)
class LawChoice:
    """The outcome of a comparison.

    Attributes:
        law: Name of the law chosen.
        reason: Why, in a sentence.
        held_out: Mean negative log-likelihood of a held-out point by law [nats]; lower is better.
        uncertainty: Standard error of its difference to the best law's.
    """

    law: str
    reason: str
    held_out: dict[str, float]
    uncertainty: dict[str, float]


def choose_law(
    velocity: ArrayLike,
    torque: ArrayLike,
    normal_load: ArrayLike | None = None,
    *,
    laws: Sequence[str] | None = None,
    seed: int = 0,
) -> LawChoice:
    """Compare static laws by cross-validation: the simplest within one standard error of the best is chosen.

    Args:
        velocity: [rad/s] or [m/s]. Shape (n,).
        torque: Friction torque [N·m] or [N]. Shape (n,).
        normal_load: As for `identify`.
        laws: Names to compare; all static laws by default.
        seed: Seed of the folds.

    Raises:
        IdentificationError: The data cannot be used, or too few points for every law.
    """
    points = observe(velocity, torque, normal_load)
    fold = np.random.default_rng(seed).permutation(points.size) % _FOLDS
    scores: dict[str, FloatArray] = {}
    for name in laws or separable_law_names():
        try:
            scores[name] = _score_held_out(name, points, fold)
        except IdentificationError:
            continue
    if not scores:
        raise IdentificationError(f"too few points ({points.size}) to compare any law")
    mean = {name: float(np.mean(score)) for name, score in scores.items()}
    best = min(mean, key=lambda name: mean[name])
    error = {name: float(np.std(score - scores[best]) / np.sqrt(points.size)) for name, score in scores.items()}
    fair = [name for name in scores if mean[name] <= mean[best] + error[name]]
    chosen = min(fair, key=lambda name: (len(separable_law(name).names), mean[name]))
    return LawChoice(chosen, _describe_reason(chosen, best, mean, error), mean, error)


def _score_held_out(name: str, points: Observations, fold: np.ndarray[tuple[int], np.dtype[np.intp]]) -> FloatArray:
    """Negative log-likelihood of each point under the fit without its fold. Shape (n_points,)."""
    form = separable_law(name)
    score = np.empty(points.size)
    for k in range(_FOLDS):
        inside, outside = points.select(np.flatnonzero(fold != k)), points.select(np.flatnonzero(fold == k))
        inside = gather_points(inside)
        relative, absolute = Noise("relative").counting(inside), Noise("absolute").counting(inside)
        scan = scan_basins(form, inside, absolute, robust=False)
        fits = [fit_likelihood(form, inside, noise, scan) for noise in (relative, absolute)]
        fit = min(fits, key=lambda f: f.negative_log_likelihood)
        magnitude, _ = form.evaluate(fit.logs, outside)
        scaled = fit.noise.kind == "relative"
        error = inside.root_count * (inside.magnitude - fit.magnitude) / (fit.magnitude if scaled else 1.0)
        level = float(np.sqrt(np.sum(error**2) / max(inside.total - len(fit.logs), 1)))
        deviation = np.maximum(level * (magnitude if scaled else np.ones(outside.size)), 1e-9 * points.torque_scale)
        z = (outside.magnitude - magnitude) / deviation
        score[fold == k] = np.log(deviation) + 0.5 * z**2 + 0.5 * np.log(2.0 * np.pi)
    return score


def _describe_reason(chosen: str, best: str, mean: dict[str, float], error: dict[str, float]) -> str:
    others = {name: value for name, value in mean.items() if name not in (chosen, best)}
    if chosen != best:
        return (
            f"{chosen} predicts held-out points as well as {best} "
            f"({mean[chosen] - mean[best]:.3f} +- {error[chosen]:.3f} nats a point behind) with fewer parameters"
        )
    if not others:
        return f"{chosen} was the only law compared"
    runner = min(others, key=lambda name: others[name])
    return (
        f"{chosen} predicts held-out points better than {runner} by {mean[runner] - mean[chosen]:.3f} "
        f"+- {error[runner]:.3f} nats a point"
    )
