"""Friction of the joints of a concealed arm, and the step that solves for it: what sticks truly sticks.

    M̂ v⁺ = M v + Δt (τ - bias - smooth) - Δt λ,   λ_i in level_i Sign(v_i⁺),   M̂ = M + Δt diag(viscous)

solved by Gauss-Seidel over the joints, each a soft threshold; M̂ is positive definite, so that it converges.
"""

import numpy as np
from numpy.typing import NDArray

from ..compiled import compile_cached

Floats = NDArray[np.float64]

FIELDS = (
    "coulomb_forward",
    "coulomb_reverse",
    "excess",
    "stribeck_velocity",
    "viscous",
    "load_coulomb",
    "load_quadratic",
    "position_cosine",
    "position_sine",
    "position_order",
    "breakaway",
    "drag",
    "power",
    "exponent",
    "stiffness",
    "middle",
    "ripple",
    "ripple_order",
    "ripple_phase",
    "warming",
)
"""Columns of the table of joints: N·m, rad/s, rad and what follows from them; `warming` is 1/K."""

PLACE = {name: k for k, name in enumerate(FIELDS)}
"""Column by its name."""

(_CF, _CR, _EX, _VS, _VI, _LC, _LQ, _PC, _PS, _PO, _BR, _DR, _PW, _EN, _ST, _MI, _RI, _RO, _RP, _WA) = range(20)
_SWEEPS = 60
_TOLERANCE = 1e-10  # [rad/s] between two sweeps


@compile_cached
def _level(p: Floats, q: float, v: float, load: float, heat: float) -> tuple[float, float]:
    """Dry friction of one joint in both directions [N·m]."""
    more = p[_EX] * np.exp(-((v / p[_VS]) ** 2)) + p[_LC] * abs(load) + p[_LQ] * load * load
    more += p[_PC] * np.cos(p[_PO] * q) + p[_PS] * np.sin(p[_PO] * q)
    if p[_PW] > 0.0:
        more += p[_PW] * abs(v) ** p[_EN]
    fall = max(1.0 + 0.5 * p[_WA] * heat, 0.2)
    return max(p[_CF] * fall + more, 0.0), max(p[_CR] * fall + more, 0.0)


@compile_cached
def _smooth(p: Floats, q: float, v: float) -> float:
    """Torques that do not jump at rest, viscous friction left out [N·m]."""
    result: float = p[_DR] * v * abs(v) + p[_ST] * (q - p[_MI])
    if p[_RI] != 0.0:
        result += p[_RI] * np.sin(p[_RO] * q + p[_RP])
    return result


@compile_cached
def _viscous(p: Floats, heat: float) -> float:
    result: float = p[_VI] * max(1.0 + p[_WA] * heat, 0.1)
    return result


@compile_cached
def solve_step(
    table: Floats,
    q: Floats,
    v: Floats,
    bristle: Floats,
    load: Floats,
    heat: Floats,
    M: Floats,
    force: Floats,
    step: float,
    out: Floats,
) -> Floats:
    """Velocities after a step, and the friction that acted in it.

    Args:
        table: Of the joints, as `FIELDS`. Shape (n, n_fields).
        q: Positions that friction sees [rad].
        v: Velocities [rad/s].
        bristle: Part of its level that presliding holds, -1 to 1; changed.
        load: Transmitted torques [N·m].
        heat: Temperatures over that of the start [K].
        M: Mass matrix [kg·m²]. Shape (n, n).
        force: Torques of motors less bias and all that is no friction [N·m].
        step: [s]
        out: Friction [N·m]; written.

    Returns:
        Velocities. Shape (n,).
    """
    n = q.size
    b, forward, reverse = np.empty(n), np.empty(n), np.empty(n)
    diagonal, new = np.empty(n), v.copy()
    for i in range(n):
        p = table[i]
        forward[i], reverse[i] = _level(p, q[i], v[i], load[i], heat[i])
        b[i] = step * (force[i] - _smooth(p, q[i], v[i]))
        for k in range(n):
            b[i] += M[i, k] * v[k]
        diagonal[i] = M[i, i] + step * _viscous(p, heat[i])
    _sweep(table, b, M, bristle, forward, reverse, diagonal, step, new)
    for i in range(n):
        total = b[i]
        for k in range(n):
            total -= M[i, k] * new[k]
        out[i] = total / step + _smooth(table[i], q[i], v[i])
        if table[i, _BR] > 0.0:
            d = table[i, _BR]
            bristle[i] = (bristle[i] + new[i] * step / d) / (1.0 + abs(new[i]) * step / d)
    return new


@compile_cached
def _sweep(
    table: Floats,
    b: Floats,
    M: Floats,
    bristle: Floats,
    forward: Floats,
    reverse: Floats,
    diagonal: Floats,
    step: float,
    new: Floats,
) -> None:
    """Gauss-Seidel over the joints until none changes any more; `new` is changed."""
    n = new.size
    for _ in range(_SWEEPS):
        change = 0.0
        for i in range(n):
            r = b[i]
            for k in range(n):
                if k != i:
                    r -= M[i, k] * new[k]
            there = _settle(table[i], r, new[i], bristle[i], forward[i], reverse[i], diagonal[i], step)
            change = max(change, abs(there - new[i]))
            new[i] = there
        if change < _TOLERANCE:
            break


@compile_cached
def _settle(
    p: Floats, r: float, before: float, bristle: float, forward: float, reverse: float, diagonal: float, step: float
) -> float:
    """Velocity of one joint while those of the others stand."""
    if p[_BR] > 0.0:  # Dahl's bristle z' = v (1 - z sign v) / d, implicit in v
        d, level = p[_BR], 0.5 * (forward + reverse)
        shrink = 1.0 + abs(before) * step / d
        there: float = (r - step * level * bristle / shrink) / (diagonal + step * step * level / (d * shrink))
        return there
    if r > step * forward:
        return (r - step * forward) / diagonal
    if r < -step * reverse:
        return (r + step * reverse) / diagonal
    return 0.0


@compile_cached
def compute_friction(table: Floats, q: Floats, v: Floats, load: Floats, heat: Floats) -> Floats:
    """Friction of all joints along a motion in which they slide, presliding left out [N·m]. Shapes (n, n_joints)."""
    result = np.empty_like(q)
    for k in range(q.shape[0]):
        for j in range(q.shape[1]):
            forward, reverse = _level(table[j], q[k, j], v[k, j], load[k, j], heat[k, j])
            level = forward if v[k, j] > 0.0 else -reverse if v[k, j] < 0.0 else 0.0
            result[k, j] = level + _smooth(table[j], q[k, j], v[k, j]) + _viscous(table[j], heat[k, j]) * v[k, j]
    return result
