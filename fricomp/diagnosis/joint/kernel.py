"""The compiled simulator: one joint with bristle friction, held to a recording by an observer.

    J w' = tau - F_v w - sigma_0 z - sigma_1 z' + u,   u = K (q - x) + D (v - w)
    z' = w - sigma_0 |w| z / g(w),   g(w) = F_c + (F_s - F_c) exp(-|w / v_s|^delta) + extra level

x, w, z are the model's own position, velocity and bristle deflection; q, v the recorded ones; u is the torque the
model lacks, seen through a second-order low pass. A share of the bristle (`sharpness`) yields abruptly at its level
instead of gradually, as the elements of Maxwell-slip models do [albender2005gms]. Both are advanced exactly over each
substep [dahl1968], [canudas1995lugre], so any stiffness is stable for them. Friction that creeps has no bristle; with
s = w + T w' it is g(w) f sign(s), where f is a hyperbola that turns over about v_c

    (1 - f) (|s| / v_c - f) = (1 - theta) f²,   1 - theta = (1 - sharpness)²,

solved for the velocity that it leaves itself. The sharpest is MuJoCo's friction loss, d (torque + b J w) cut off at its
level, with T = 1 / b and v_c = F_c (1 - d) / (d b J); the least sharp s / (|s| + v_c), and a hyperbolic tangent or an
arc tangent is within 3 % of one between. This is the only module that imports numba.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from fricomp.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable

try:
    import numba
except ImportError as error:  # pragma: no cover - depends on the installation
    raise MissingExtraError("numba", "diagnose") from error

_F = TypeVar("_F", bound="Callable[..., Any]")

# Order of the plant's numbers in the array that the kernel takes.
FRICTION_SLOTS = (
    "inertia",
    "forward.coulomb_torque",
    "forward.static_torque",
    "forward.stribeck_velocity",
    "forward.viscous_coefficient",
    "forward.stribeck_exponent",
    "reverse.coulomb_torque",
    "reverse.static_torque",
    "reverse.stribeck_velocity",
    "reverse.viscous_coefficient",
    "reverse.stribeck_exponent",
    "sigma_0",
    "sigma_1",
    "lag",
    "sharpness",
    "spread",
    "creep_velocity",
    "creep_lead",
)


LANES = (1, 8, 16)
"""Joints that the kernels run at a time. The sums of a substep wait for each other, and other joints are advanced in
the meantime: eight take 1.6 times as long as one, and sixteen 1.15 times as long as eight."""

# Rows of the lanes' state: the plant's numbers, what follows from them, the simulated joint, and the sample.
_N_SLOTS, _REVERSE = len(FRICTION_SLOTS), 5  # and the distance from a number of the forward curve to its reverse one
_INERTIA, _COULOMB, _STATIC, _SPEED, _VISCOUS, _EXPONENT = 0, 1, 2, 3, 4, 5
_SIGMA_0, _SIGMA_1, _LAG, _SHARPNESS, _SPREAD, _CREEP, _LEAD = 11, 12, 13, 14, 15, 16, 17
_MOBILITY, _SOFTNESS, _NARROW, _KEEP, _PER_SPEED, _PER_SPEED_REVERSE = 18, 19, 20, 21, 22, 23
_X, _W, _Z, _FELT, _MEAN, _FIRST, _SECOND, _THIRD = 24, 25, 26, 27, 28, 29, 30, 31
_Q, _V, _TAU, _LEVEL, _DQ, _DV, _DTAU, _DLEVEL = 32, 33, 34, 35, 36, 37, 38, 39
_RATIO, _POWER, _LEAK, _SUM_U, _SUM_BRISTLE, _BEFORE, _TOP = 40, 41, 42, 43, 44, 45, 46
_Q_NEXT, _V_NEXT, _TAU_NEXT, _LEVEL_NEXT, _CHANGE, _AHEAD, _GIVE, _GIVE_REVERSE = 47, 48, 49, 50, 51, 52, 53, 54
_REST, _REST_REVERSE, _DAMPING = 55, 56, 57
_N_STATE = 58


def compile_kernel(function: _F) -> _F:
    """Compile with numba, cached on disk, without holding the interpreter lock: two threads use two cores.

    Products may be fused with sums; nothing else that would depend on order or on special values.
    """
    return cast(_F, numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "nsz"})(function))


def _inline(function: _F) -> _F:
    """Compile into the caller, which knows the constant shape of the lanes' state: without it no vectors are formed.

    It stands in the caller's file: a change of another one would leave the caller's cache on disk as it is.
    """
    return cast(_F, numba.njit(inline="always")(function))


@compile_kernel
def _compute_fall(x: float) -> float:
    """exp(-x) for x >= 0 to 1e-9, without a branch or a call, so that all lanes take the same instructions."""
    y = -min(x, 40.0) * (1.0 / 128.0)
    square = y * y
    low = (1.0 + y) + square * (0.5 + y * (1.0 / 6.0))
    high = (1.0 / 24.0 + y * (1.0 / 120.0)) + square * (1.0 / 720.0 + y * (1.0 / 5040.0))
    power = low + square * square * high
    for _ in range(7):
        power *= power
    return power


@compile_kernel
def compute_creep_friction(driven: float, level: float, speed: float, sharpness: float, slip: float) -> float:
    """Torque of friction that creeps, where it acts on the velocity that it leaves itself [N·m].

    Args:
        driven: Velocity that would be without it [rad/s].
        level: g(w) [N·m].
        speed: v_c [rad/s].
        sharpness: As above, 0 to 1.
        slip: Velocity that a torque of 1 N·m takes away [rad/s per N·m]; 0 where the velocity is what it is.
    """
    bend = speed * sharpness * (2.0 - sharpness) + level * slip
    wide = abs(driven) + speed + level * slip
    friction: float = 2.0 * level * driven / (wide + np.sqrt(max(wide * wide - 4.0 * bend * abs(driven), 0.0)))
    return friction


@_inline
def _start(state: np.ndarray, plants: np.ndarray) -> tuple[bool, bool]:
    """Fill in the plants; returns whether any lane needs another Stribeck exponent than two, and whether any creeps.
    Such a lane has no bristle."""
    general, creeping = False, False
    for j in range(state.shape[1]):
        for i in range(_N_SLOTS):
            state[i, j] = plants[i, j]
        general = general or plants[_EXPONENT, j] != 2.0 or plants[_EXPONENT + _REVERSE, j] != 2.0
        state[_MOBILITY, j], state[_SOFTNESS, j] = 1.0 / plants[_INERTIA, j], 1.0 / plants[_SIGMA_0, j]
        state[_NARROW, j], state[_PER_SPEED, j] = 1.0 / plants[_SPREAD, j], 1.0 / plants[_SPEED, j]
        state[_PER_SPEED_REVERSE, j] = 1.0 / plants[_SPEED + _REVERSE, j]
        if plants[_CREEP, j] > 0.0:
            creeping = True
            state[_SIGMA_0, j], state[_SIGMA_1, j] = 0.0, 0.0
    return general, creeping


@_inline
def _shorten(state: np.ndarray, h: float, before: float) -> float:
    """Take substeps of `h` [s] from here on, after others of `before` [s], 0 for none; returns it.

    Friction acts at the middle of a substep, and what is felt is known where it begins: for that half of it the
    velocity is extrapolated. Left out, viscous friction comes half a substep late, which looks like a larger inertia.
    A low pass that takes the velocity for held since the last substep is ahead already, the more the longer its lag.

    Where viscous friction stops the joint within a substep, that half must be the substep's own, not the last one's:
    the joint gives way by the part of what it would that is exact for a steady torque, and the half that was
    extrapolated is given back, so that no friction is too large for a substep. Friction behind a longer low pass hardly
    follows within a substep. The damping of a bristle that sticks acts likewise.
    """
    for j in range(state.shape[1]):
        stops = h * state[_MOBILITY, j] * state[_SIGMA_1, j]
        state[_DAMPING, j] = state[_SIGMA_1, j] * (-np.expm1(-stops) / stops if stops > 0.0 else 1.0)
        lag = state[_LAG, j]
        state[_KEEP, j], state[_AHEAD, j] = 0.0, 0.5
        if lag > 0.0:
            state[_KEEP, j] = np.exp(-h / lag)
            state[_AHEAD, j] = 0.5 + 1.0 / np.expm1(h / lag) - lag / h
        follows = 1.0 - state[_KEEP, j] if lag < h else 0.0
        for back in (0, 1):
            stops = h * state[_MOBILITY, j] * follows * state[_VISCOUS + back * _REVERSE, j]
            give = -np.expm1(-stops) / stops if stops > 0.0 else 1.0
            state[_GIVE + back, j], state[_REST + back, j] = give, 0.5 * stops * give
        if before > 0.0:
            state[_CHANGE, j] *= h / before
    return h


@_inline
def _feel(state: np.ndarray, general: bool) -> None:
    """The speed that friction follows, at the middle of the substep, and the exponent of its fall."""
    for j in range(state.shape[1]):
        w, forth, back = state[_W, j], state[_PER_SPEED, j], state[_PER_SPEED_REVERSE, j]
        ahead = w + state[_AHEAD, j] * state[_CHANGE, j]
        felt = ahead + (state[_FELT, j] - ahead) * state[_KEEP, j]
        ratio = abs(felt) * (forth if w >= 0.0 else back)
        state[_FELT, j], state[_RATIO, j], state[_POWER, j] = felt, ratio, ratio * ratio
    if general:
        for j in range(state.shape[1]):
            exponent = state[_EXPONENT if state[_W, j] >= 0.0 else _EXPONENT + _REVERSE, j]
            if exponent != 2.0:
                state[_POWER, j] = state[_RATIO, j] ** exponent


@_inline
def _advance(
    state: np.ndarray, f: float, middle: float, h: float, gains: tuple[float, float], rest_speed: float
) -> None:
    """One substep of `h` [s] at the share `f` of the sample, with the torque at `middle` of the substep.

    The error is taken where the substep begins, so that its size leaves no trace in it.
    """
    for j in range(state.shape[1]):
        x, w, z = state[_X, j], state[_W, j], state[_Z, j]
        c_f, c_r = state[_COULOMB, j], state[_COULOMB + _REVERSE, j]
        s_f, s_r = state[_STATIC, j], state[_STATIC + _REVERSE, j]
        v_f, v_r = state[_VISCOUS, j], state[_VISCOUS + _REVERSE, j]
        give_f, give_r = state[_GIVE, j], state[_GIVE_REVERSE, j]
        rest_f, rest_r = state[_REST, j], state[_REST_REVERSE, j]
        forth = w >= 0.0
        c, top, viscous = c_f if forth else c_r, s_f if forth else s_r, v_f if forth else v_r
        q, v = state[_Q, j] + state[_DQ, j] * f, state[_V, j] + state[_DV, j] * f
        u = gains[0] * (q - x) + gains[1] * (v - w)
        g = c + (top - c) * _compute_fall(state[_POWER, j]) + state[_LEVEL, j] + state[_DLEVEL, j] * middle
        limit = max(g, 1e-9) * state[_SOFTNESS, j]
        steady = limit if forth else -limit
        z = steady + (z - steady) * _compute_fall(abs(w) * h / limit)
        first = min(max(state[_FIRST, j] + state[_SPREAD, j] * w * h, -limit), limit)
        second = min(max(state[_SECOND, j] + w * h, -limit), limit)
        third = min(max(state[_THIRD, j] + state[_NARROW, j] * w * h, -limit), limit)
        mean = z + state[_SHARPNESS, j] * ((1.0 / 3.0) * (first + second + third) - z)
        bristle = state[_SIGMA_0, j] * mean + state[_DAMPING, j] * (mean - state[_MEAN, j]) / h
        tau = state[_TAU, j] + state[_DTAU, j] * middle
        give, rest = give_f if forth else give_r, rest_f if forth else rest_r
        driven = h * (tau - viscous * state[_FELT, j] - bristle + u) * state[_MOBILITY, j]
        faster = w + give * driven + rest * state[_CHANGE, j]
        x += 0.5 * h * (w + faster)
        leak = state[_LEAK, j]
        x += h * (leak if abs(faster) < rest_speed else 0.0) * (q + v * h - x)
        state[_X, j], state[_W, j], state[_Z, j], state[_MEAN, j] = x, faster, z, mean
        state[_CHANGE, j] = faster - w
        state[_FIRST, j], state[_SECOND, j], state[_THIRD, j] = first, second, third
        state[_SUM_U, j] += u
        state[_SUM_BRISTLE, j] += bristle


@_inline
def _remember(state: np.ndarray, middle: float) -> None:
    """Velocity and friction level at the beginning of a substep, for the lanes that creep."""
    for j in range(state.shape[1]):
        w = state[_W, j]
        forth = w >= 0.0
        c, top = state[_COULOMB, j], state[_STATIC, j]
        c_r, top_r = state[_COULOMB + _REVERSE, j], state[_STATIC + _REVERSE, j]
        c, top = c if forth else c_r, top if forth else top_r
        level = c + (top - c) * _compute_fall(state[_POWER, j]) + state[_LEVEL, j] + state[_DLEVEL, j] * middle
        state[_BEFORE, j], state[_TOP, j] = w, max(level, 1e-9)


@_inline
def _creep(state: np.ndarray, h: float) -> None:
    """Dry friction of the lanes that creep, on top of a substep of `h` [s] without any.

    It depends on the velocity and acceleration that it leaves itself, so that no stiffness is too large for the step.
    """
    for j in range(state.shape[1]):
        speed, top, give_f, give_r = state[_CREEP, j], state[_TOP, j], state[_GIVE, j], state[_GIVE_REVERSE, j]
        mobility = state[_MOBILITY, j] * (give_f if state[_BEFORE, j] >= 0.0 else give_r)
        if speed > 0.0:
            free = (state[_W, j] - state[_BEFORE, j]) / h
            ahead = h + state[_LEAD, j]
            driven, slip = state[_BEFORE, j] + ahead * free, ahead * mobility
            friction = compute_creep_friction(driven, top, speed, state[_SHARPNESS, j], slip)
            state[_W, j] -= h * friction * mobility
            state[_X, j] -= 0.5 * h * h * friction * mobility
            state[_CHANGE, j] = state[_W, j] - state[_BEFORE, j]
            state[_SUM_BRISTLE, j] += friction


@_inline
def _take_substep(
    state: np.ndarray,
    how: tuple[bool, bool],
    at: tuple[float, float],
    h: float,
    gains: tuple[float, float],
    rest_speed: float,
) -> None:
    """One substep of `h` [s]: by what `_start` returned, between two shares of the sample."""
    _feel(state, how[0])
    if how[1]:
        _remember(state, at[1])
    _advance(state, at[0], at[1], h, gains, rest_speed)
    if how[1]:
        _creep(state, h)


@_inline
def _look_ahead(state: np.ndarray, signals: tuple[np.ndarray, ...], rows: np.ndarray, k: int) -> None:
    """Read the sample that ends the next step."""
    position, velocity, torque, level = signals
    for j in range(state.shape[1]):
        state[_Q_NEXT, j], state[_V_NEXT, j] = position[rows[0, j], k], velocity[rows[1, j], k]
        state[_TAU_NEXT, j], state[_LEVEL_NEXT, j] = torque[rows[2, j], k], level[rows[3, j], k]


@_inline
def _take(state: np.ndarray, leak: float, rest_speed: float) -> None:
    """Go on to the sample that was looked ahead to."""
    for j in range(state.shape[1]):
        state[_Q, j], state[_V, j] = state[_Q_NEXT, j], state[_V_NEXT, j]
        state[_TAU, j], state[_LEVEL, j] = state[_TAU_NEXT, j], state[_LEVEL_NEXT, j]
        # A joint that creeps returns by itself to where it is recorded.
        state[_LEAK, j] = leak if abs(state[_V, j]) < rest_speed and state[_CREEP, j] == 0.0 else 0.0
        state[_SUM_U, j], state[_SUM_BRISTLE, j] = 0.0, 0.0


@_inline
def _aim(state: np.ndarray) -> None:
    """How far each signal goes until the sample that was looked ahead to."""
    for j in range(state.shape[1]):
        state[_DQ, j], state[_DV, j] = state[_Q_NEXT, j] - state[_Q, j], state[_V_NEXT, j] - state[_V, j]
        state[_DTAU, j] = state[_TAU_NEXT, j] - state[_TAU, j]
        state[_DLEVEL, j] = state[_LEVEL_NEXT, j] - state[_LEVEL, j]


@compile_kernel
def observe(
    signals: tuple[np.ndarray, ...],
    rows: np.ndarray,
    plants: np.ndarray,
    observer: np.ndarray,
    substeps: np.ndarray,
    lanes: tuple[int, ...],
    out: np.ndarray,
) -> None:
    """Run observed joints side by side, each along its own samples; several may share a signal.

    Args:
        signals: Recorded q [rad], estimated v [rad/s], applied torque less gravity and offset [N·m] and torque added
            to the dry friction level [N·m]. Shapes (any number, n).
        rows: Which row of each signal is that of a lane. Shape (4, n_lanes).
        plants: Numbers in the order of `FRICTION_SLOTS`. Shape (18, n_lanes).
        observer: dt [s], K [N·m/rad], D [N·m·s/rad], rest speed [rad/s], leak [1/s].
        substeps: In how many steps each sample is taken. Shape (n,).
        lanes: A tuple with one number a lane, so that their count is known to the compiler: one of `LANES`.
        out: Filled with u [N·m], x [rad], w [rad/s], bristle torque [N·m]. Shape (4, n_lanes, n); or (1, n_lanes, n)
            for u alone. Position and velocity stand at the sample, torques are means until the next one.
    """
    dt, gains, rest_speed, leak = observer[0], (observer[1], observer[2]), observer[3], observer[4]
    n, state, taken, h = substeps.shape[0], np.zeros((_N_STATE, len(lanes))), 0, 0.0
    whole, how = out.shape[0] > 1, _start(state, plants)
    _look_ahead(state, signals, rows, 0)
    for j in range(state.shape[1]):
        state[_X, j], state[_W, j], state[_FELT, j] = state[_Q_NEXT, j], state[_V_NEXT, j], state[_V_NEXT, j]
    for k in range(n):
        if substeps[k] != taken:
            taken, h = substeps[k], _shorten(state, dt / substeps[k], h)
        _take(state, leak, rest_speed)
        _look_ahead(state, signals, rows, min(k + 1, n - 1))
        _aim(state)
        if whole:
            out[1, :, k], out[2, :, k] = state[_X], state[_W]
        for s in range(taken):
            _take_substep(state, how, (s / taken, (s + 0.5) / taken), h, gains, rest_speed)
        for j in range(state.shape[1]):
            out[0, j, k] = state[_SUM_U, j] / taken
        if whole:
            for j in range(state.shape[1]):
                out[3, j, k] = state[_SUM_BRISTLE, j] / taken


@compile_kernel
def close_loop(
    signals: np.ndarray,
    plants: np.ndarray,
    loop: tuple[float, float, float, float],
    encoders: np.ndarray,
    substeps: np.ndarray,
    lanes: tuple[int, ...],
    out: np.ndarray,
) -> None:
    """Run joints side by side under a loop that sees their positions in steps and answers to each.

    Args:
        signals: Where the joint would be without the steps [rad], how fast it would be, of which the first one counts
            [rad/s], torque that moves it so, less gravity and offset [N·m], and torque added to the dry friction level
            [N·m]. Shape (4, n).
        plants: Numbers in the order of `FRICTION_SLOTS`. Shape (18, n_lanes).
        loop: dt [s], P [N·m/rad], D [N·m·s/rad], what its velocity filter keeps from sample to sample.
        encoders: Step [rad], 0 for none, and origin [rad] of each encoder. Shape (2, n_lanes).
        substeps: In how many steps each sample is taken. Shape (n,).
        lanes: A tuple with one number a lane; its length is one of `LANES`.
        out: Filled with the loop's answer, held until the next sample [N·m], and the position that the encoder shows
            [rad]. Shape (2, n_lanes, n).
    """
    dt, stiffness, damping, filtered = loop
    position, velocity, torque, level = signals
    steps, origins = encoders[0], encoders[1]
    n, state, taken, h = position.size, np.zeros((_N_STATE, len(lanes))), 0, 0.0
    rate, before = np.zeros(len(lanes)), np.zeros(len(lanes))
    how = _start(state, plants)
    for j in range(state.shape[1]):
        state[_X, j], state[_W, j], state[_FELT, j] = position[0], velocity[0], velocity[0]
    for k in range(n):
        if substeps[k] != taken:
            taken, h = substeps[k], _shorten(state, dt / substeps[k], h)
        after = min(k + 1, n - 1)
        for j in range(state.shape[1]):
            x, step, origin = state[_X, j], steps[j], origins[j]
            seen = step * np.round((x - origin) / step) + origin if step > 0.0 else x
            error = position[k] - seen
            change = (error - before[j]) / dt if k > 0 else 0.0
            rate[j], before[j] = change + (rate[j] - change) * filtered, error
            answer = stiffness * error + damping * rate[j]
            state[_TAU, j], state[_DTAU, j] = torque[k] + answer, torque[after] - torque[k]
            state[_LEVEL, j], state[_DLEVEL, j] = level[k], level[after] - level[k]
            out[0, j, k], out[1, j, k] = answer, seen
        for s in range(taken):
            _take_substep(state, how, (s / taken, (s + 0.5) / taken), h, (0.0, 0.0), 0.0)
