"""Where effects are looked for beside what was fitted: orders that stand out, and hypotheses narrowed by simulation."""

from __future__ import annotations

from collections.abc import Sequence

from .effects import Context
from .hypotheses import narrowed
from .order import order_hints
from .problem import Problem
from .screening import orthonormal, project_out
from .solver import Fit
from .structure import Structure

__all__ = ["hints_beside"]


def hints_beside(problem: Problem, contexts: Sequence[Context], fit: Fit) -> dict[str, tuple[float, ...]]:
    """Starting values of further effects, from what a fit of the base, alone or with effects, leaves."""
    basis = orthonormal(fit.jacobian)
    orders = order_hints(problem, contexts, project_out(fit.residual[:, None], basis)[:, 0], basis)
    return orders | narrowed(problem, Structure(tuple(contexts)), fit.residual, basis)
