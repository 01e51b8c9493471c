"""Orders over position: which ripple per radian stands out in the residual."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..effects import Context
from ..effects.two_masses import compute_uneven_running
from ..inputs.track import FloatArray
from ..joint.problem import Problem
from .settings import SEARCH

__all__ = ["OrderSpectrum", "compute_order_spectrum", "find_orders"]

ComplexArray = NDArray[np.complex128]

_SHAPES = {"order": "additive", "level_order": "level", "dynamic_order": "dynamic", "torque_order": "torque"}


class OrderSpectrum(NamedTuple):
    """Energy of the weighted residual that a ripple of each order explains, in units of the noise variance."""

    order: FloatArray
    energy: FloatArray


def find_orders(
    problem: Problem, contexts: Sequence[Context], residual: FloatArray, basis: FloatArray
) -> dict[str, tuple[float, ...]]:
    """The three strongest orders for ripples of the torque, of the friction level, of the gear's running, and of the
    torque constant."""
    hints = {}
    for key, shape in _SHAPES.items():
        hints[key] = _find_peaks(compute_order_spectrum(problem, contexts, residual, basis, shape))
    return hints


def compute_order_spectrum(
    problem: Problem, contexts: Sequence[Context], residual: FloatArray, basis: FloatArray, shape: str = "additive"
) -> OrderSpectrum:
    """Energy by order.

    Args:
        problem: Recordings and weights.
        contexts: Their motion.
        residual: Weighted residual. Shape (m,).
        basis: Orthonormal columns of the base model, which take no part. Shape (m, p).
        shape: "additive", "level" (times the sign of the velocity), "dynamic" (uneven running of a gear) or "torque"
            (times the torque).
    """
    span = max(float(np.ptp(c.position)) for c in contexts)
    top = max(float(np.quantile(np.abs(c.velocity), 0.3)) for c in contexts)
    lowest = 1.5 * 2.0 * np.pi / max(span, 1e-9)
    highest = max(30.0 / span, min(200.0 / max(top, 1e-3), 2500.0 / span))
    count = int(np.clip((highest - lowest) * span / 0.8, 20, SEARCH.most_orders))
    orders = np.linspace(lowest, highest, count)
    if contexts[0].rotary and shape == "level":
        orders = np.arange(1.0, 41.0)
    elif contexts[0].rotary:
        orders = np.unique(np.concatenate([np.arange(np.ceil(lowest), 41.0), orders]))
    size = int(np.clip(SEARCH.ripple_cells // residual.size, *SEARCH.ripple_block))
    blocks = np.array_split(orders, max(1, orders.size // size))
    energy = np.concatenate([_compute_energy(problem, contexts, residual, basis, block, shape) for block in blocks])
    return OrderSpectrum(orders, energy)


def _compute_energy(
    problem: Problem,
    contexts: Sequence[Context],
    residual: FloatArray,
    basis: FloatArray,
    orders: FloatArray,
    shape: str,
) -> FloatArray:
    ripple = build_ripple_rows(problem, contexts, orders, shape)
    if shape == "additive" and len(contexts) > 1:  # each recording has a phase of its own
        ends = np.cumsum([0, *(grid.centres.size for grid in problem.grids)])
        each = []
        for source in dict.fromkeys(context.source for context in contexts):
            alone = np.zeros_like(ripple)
            for context, (a, b) in zip(contexts, pairwise(ends), strict=True):
                if context.source == source:
                    alone[a:b] = ripple[a:b]
            each.append(_compute_explained(alone - basis @ (basis.T @ alone), residual))
        total: FloatArray = np.sum(each, axis=0)
        return total
    return _compute_explained(ripple - basis @ (basis.T @ ripple), residual)


def _compute_explained(ripple: ComplexArray, residual: FloatArray) -> FloatArray:
    """Energy of `residual` that cosine and sine of each ripple explain. Shape (n_orders,)."""
    C, S = ripple.real, ripple.imag
    cc, ss, cs = np.sum(C * C, axis=0), np.sum(S * S, axis=0), np.sum(C * S, axis=0)
    c, s = residual @ C, residual @ S
    guard = 1e-9 * (cc + ss) ** 2 + 1e-30
    result: FloatArray = (ss * c * c - 2.0 * cs * c * s + cc * s * s) / np.maximum(cc * ss - cs * cs, guard)
    return result


def build_ripple_rows(problem: Problem, contexts: Sequence[Context], orders: FloatArray, shape: str) -> ComplexArray:
    """Weighted rows of ripples, through window and observer as for steady motion. Shape (m, n_orders).

    The real part is the ripple's cosine, the imaginary part its sine.
    """
    assert problem.weights is not None
    K, D = problem.gains
    rows = []
    for context, grid, spread in zip(contexts, problem.grids, problem.weights.spread, strict=True):
        q, v = context.position[grid.centres, None], context.velocity[grid.centres, None]
        s = 1j * orders * v
        response = (D * s + K) / (context.plant.inertia * s**2 + D * s + K)
        x = np.abs(orders * v) * (grid.window.size + 1) * context.dt / (2 * np.pi)
        fall = 1 - x**2
        middle = np.abs(fall) < 1e-3
        hann = np.where(middle, 0.5, np.sinc(x) / np.where(middle, 1.0, fall))
        moving = np.abs(v) > 2.0 * problem.observer.rest_speed
        angle = orders * q
        ripple = response * (np.cos(angle) + 1j * np.sin(angle)) * (hann * (moving / spread[:, None]))
        if shape == "level":
            ripple = ripple * np.sign(v)
        elif shape == "torque":
            ripple = ripple * context.torque[grid.centres, None]
        elif shape == "dynamic":
            here = replace(context, position=q, velocity=v, acceleration=context.acceleration[grid.centres, None])
            ripple = ripple * compute_uneven_running(here, orders, SEARCH.usual_load_share) / orders
        rows.append(problem.weights.whiten(ripple))
    return np.concatenate(rows)


def _find_peaks(spectrum: OrderSpectrum) -> tuple[float, ...]:
    e = np.pad(spectrum.energy, 1, constant_values=-1.0)
    peak = (e[1:-1] >= e[:-2]) & (e[1:-1] > e[2:])
    ranked = sorted(np.flatnonzero(peak), key=lambda i: -spectrum.energy[i])
    return tuple(float(spectrum.order[i]) for i in ranked[:3])
