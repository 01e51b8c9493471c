"""Fisher information turned into a covariance, parameters that the data say nothing about included."""

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

UNDETERMINED = 1e6
"""Least standard deviation of a logarithm that the information says nothing about. A finite number in the place of
infinity: JSON has none, and a covariance with it still adds up; whatever weighs by it, such as `fricomp compare` or
the choice of the gain, gives such a parameter no weight."""
_NULL = 1e-14
"""Eigenvalues of the scaled information below this fraction of the largest are rounding."""
_INVOLVED = 1e-6
"""Component of a direction without information from which a parameter takes part in it."""
_LEAST = 1e-300


class _Directions(NamedTuple):
    """Directions in the space of the logarithms: with information, of unit variance; without, of any length."""

    known: FloatArray
    free: FloatArray


def invert_information(information: FloatArray) -> FloatArray:
    """Covariance of the logarithms of parameters.

    A pseudo-inverse would give directions without information the variance zero, as if they were known exactly; here
    each of their parameters has a standard deviation of `UNDETERMINED` or more.

    Args:
        information: Fisher information about the logarithms. Shape (n_parameters, n_parameters).
    """
    known, free = _split(information)
    least = np.min(np.where(free != 0.0, np.abs(free), np.inf), axis=0, initial=np.inf)
    free = free * (UNDETERMINED / least)
    return np.asarray(known @ known.T + free @ free.T)


def compute_log_deviations(information: FloatArray) -> FloatArray:
    """Standard deviations of the logarithms, infinite where nothing is known. Shape (n_parameters,)."""
    known, free = _split(information)
    return np.where(np.any(free != 0.0, axis=1), np.inf, np.linalg.norm(known, axis=1))


def with_least_variance(covariance: FloatArray, least: FloatArray) -> FloatArray:
    """`covariance` with variances of at least those of another, by added errors of their own. Shape (n, n).

    Args:
        covariance: Shape (n, n).
        least: The other covariance. Shape (n, n).
    """
    return np.asarray(covariance + np.diag(np.maximum(np.diag(least) - np.diag(covariance), 0.0)))


def _split(information: FloatArray) -> _Directions:
    diagonal = np.diag(information)
    scale = 1.0 / np.sqrt(np.maximum(diagonal, _LEAST))
    values, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    null = values < _NULL * max(float(values[-1]), _LEAST)
    null |= np.any(np.abs(vectors[diagonal <= _LEAST]) > 0.5, axis=0)  # a parameter that no reading depends on
    free = np.where(np.abs(vectors[:, null]) > _INVOLVED, vectors[:, null], 0.0)
    # A parameter that no reading depends on has no scale of its own.
    stretch = np.where(diagonal <= _LEAST, 1.0, scale)[:, None]
    return _Directions(stretch * vectors[:, ~null] / np.sqrt(values[~null]), stretch * free)
