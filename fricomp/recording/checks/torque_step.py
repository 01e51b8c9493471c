"""A torque that becomes another multiple of itself within the recording: inertia, gravity and friction grow with it.

Friction that warms up or a brake that drags changes friction alone; a payload changes inertia and gravity, and friction
by another factor, if at all. So each of these is fitted to means over blocks with a step at one time,

    torque = sum of body columns * d_b + sum of friction columns * d_f,    d = 1 before the step,

where a gain has d_b = d_f, a step of friction d_b = 1, a payload d_f = 1 and one d for each column of the body, and the
freest of them a factor of friction beside a payload. Friction may differ with direction, angle and speed and drift over
the recording in all of them, so that what changes slowly is no step.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.joint_fit import BlockMotion, average_motion
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_GRID = 48
"""Times at which a step is tried, and again between the two beside the best."""
_ROUNDS = 3
"""Times that the grid is made finer; 48 times 24 times 24 blocks are nine minutes at 50 blocks a second."""
_MOST = 16.0
"""Factor from which on one part has no torque to speak of: none was recorded there, or none was needed."""
_FACTORS = np.geomspace(1.0 / _MOST, _MOST, 33)
"""Factors that are tried first; each round tries them closer around the best."""
_BOUND = 0.99
"""Part of the way to the bound from which on a factor is at it."""
_CLOSER = 0.15
"""How much closer."""
_FEWEST = 120
"""Blocks that slide, some five for each parameter."""
_SHORTEST = 0.08
"""Part of the blocks that lie before and after a step at least."""
SHOWN = 30.0
"""Nats by which a step must explain more than none, of samples that do not go together."""
_TOLD = 10.0
"""Nats by which it must explain more than another kind of step."""
_MISSED = 0.15
"""Part of what the freest step explains, in nats, that another may miss."""
_LEAST = 1.1
"""Factor from which on a step matters: one curve for both parts is then off by five per cent in each."""
_COOLED = 1.7
"""Factor up to which friction may be larger after a rest: warming takes away two fifths, which a rest gives back."""
_APART = 0.05
"""Correlation below which what is left of two rows does not go together."""
_BINS, _IN_BIN = 8, 10
"""Ranges of speed in which the friction of both parts is compared, and rows of each that such a range has at least."""
_RIDGE = 1e-9
"""Added to the squares of columns of length one, so that those that are alike share what they explain."""
REST = 2.0
"""Time without sliding from which on friction may have cooled down [s]."""


class TorqueStep(NamedTuple):
    """A torque whose size, or whose friction, changes at one time.

    Attributes:
        before: Last time at which the joint slides in the first part [s].
        after: First one in the second [s].
        factor: Torque, or friction, of the second part over that of the first.
        is_gain: Whether inertia and gravity change with friction, which no payload, heat or brake does.
    """

    before: float
    after: float
    factor: float
    is_gain: bool


class _Joint(NamedTuple):
    """What the torque at the rows that slide is a sum of: body, friction, and what a payload adds after a step.

    Attributes:
        columns: Of all three, each of length one. Shape (n_rows, n_columns).
        target: The torque [N·m] or [N]. Shape (n_rows,).
        of_body: Which columns are the body's. Shape (n_columns,).
        of_friction: Which are friction's. Shape (n_columns,).
        of_payload: Which are a payload's. Shape (n_columns,).
        of_other: Which are the rest of the body's once more, for the freest step. Shape (n_columns,).
    """

    columns: Samples
    target: Samples
    of_body: NDArray[np.bool_]
    of_friction: NDArray[np.bool_]
    of_payload: NDArray[np.bool_]
    of_other: NDArray[np.bool_]


class _Kind(NamedTuple):
    """What a step changes: the body and friction by one factor each, or not; and whether a payload comes on."""

    body: bool
    friction: bool
    payload: bool
    other: bool = False


class _Fit(NamedTuple):
    """The best step of one kind: first row after it, its factor, and the mean square that it leaves."""

    row: int
    factor: float
    left: float


_GAIN, _FRICTION = _Kind(body=True, friction=True, payload=False), _Kind(body=False, friction=True, payload=False)
_PAYLOAD, _FREEST = (
    _Kind(body=False, friction=False, payload=True),
    _Kind(body=False, friction=True, payload=True, other=True),
)


def locate_torque_step(recording: Recording) -> TorqueStep | None:
    """Find the time at which the torque, or friction, becomes another multiple; None where nothing does."""
    motion = average_motion(recording)
    if motion is None or np.count_nonzero(motion.rows) < _FEWEST:
        return None
    joint = list_columns(motion, np.asarray(recording.torque), rotary=recording.metadata.motion == "rotary")
    without, apart = _measure_without(joint)
    if without <= _RIDGE * float(np.mean(joint.target**2)):  # nothing is left, or the torque is zero
        return None
    if joint.target.size * np.log(without / apart) < 2.0 * SHOWN:  # not even two joints that share nothing explain it
        return None
    gain, friction, payload, freest = (_fit_step(joint, kind) for kind in (_GAIN, _FRICTION, _PAYLOAD, _FREEST))
    nats = 0.5 * joint.target.size / count_alike(_list_left(joint, _FREEST, freest))
    is_gain = bool(nats * np.log(friction.left / gain.left) > _TOLD)
    best = gain if is_gain else friction
    shown, told = nats * np.log(without / best.left), nats * np.log(payload.left / best.left)
    missed = np.log(best.left / freest.left) / np.log(without / freest.left)
    if (
        shown < SHOWN
        or told < _TOLD
        or missed > _MISSED
        or not np.log(_LEAST) < abs(np.log(best.factor)) < _BOUND * np.log(_MOST)
    ):
        return None
    if not _is_borne_out(joint, _GAIN if is_gain else _FRICTION, best, motion.velocity[motion.rows]):
        return None
    before, after = motion.time[motion.rows][best.row - 1 : best.row + 1].tolist()
    if not is_gain and after - before > REST and 1.0 < best.factor < _COOLED:
        return None
    return TorqueStep(before, after, best.factor, is_gain)


def list_columns(motion: BlockMotion, torque: Samples, *, rotary: bool) -> _Joint:
    """What a joint's torque is made of, friction in any form that does not step."""
    q, v, a = (each[motion.rows] for each in (motion.position, motion.velocity, motion.acceleration))
    one, middle = np.ones(v.size), q - np.mean(q)
    payload = [a, np.sin(q), np.cos(q)] if rotary else [a, one]
    other = [one, middle] if rotary else [middle, middle**2]
    body = [*payload, *other]
    u, sign = v / np.percentile(np.abs(v), 98), np.sign(v)
    angle = q if rotary else np.pi * middle / max(float(np.ptp(q)), 1e-300)
    elapsed = np.linspace(0.0, 1.0, v.size)  # of motion: what a rest changes is a step
    drifts = (elapsed, np.exp(-4.0 * elapsed), np.exp(-16.0 * elapsed))
    friction = [sign, u, sign * u**2, sign * np.exp(-np.abs(u) / 0.15), np.abs(u), u**2]
    friction += [sign * wave(k * angle) for k in (1, 2) for wave in (np.sin, np.cos)]
    friction += [level * drift for level in (sign, u) for drift in drifts]
    columns = np.column_stack([*body, *friction, *payload, *other])
    part = np.repeat([0, 1, 2, 3], [len(body), len(friction), len(payload), len(other)])
    scaled = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    return _Joint(scaled, motion.average(torque), part == 0, part == 1, part == 2, part == 3)


def _measure_without(joint: _Joint) -> tuple[float, float]:
    """Mean square that is left without a step, and the least that is by two joints, one after the other."""
    one = joint._replace(columns=joint.columns[:, joint.of_body | joint.of_friction])
    count, width = one.columns.shape
    grams, moments = _sum_before(one, _list_rows(joint))
    square = float(one.target @ one.target)
    apart = _solve(grams[:-1], moments[:-1]) + _solve(grams[-1] - grams[:-1], moments[-1] - moments[:-1])
    without = square - float(_solve(grams[-1], moments[-1]))
    least = _RIDGE * square  # of which rounding leaves no less
    return without / (count - width), max(square - float(np.max(apart)), least) / (count - 2 * width)


def _fit_step(joint: _Joint, kind: _Kind) -> _Fit:
    """The step of a kind that leaves least: on a grid of rows and factors, which is then made finer around the best."""
    rows = _list_rows(joint)
    factors = _FACTORS if kind.body or kind.friction else np.ones(1)
    free = joint.target.size - int(np.count_nonzero(_scale(joint, kind, np.ones(1))[1])) - 2
    square = float(joint.target @ joint.target)
    for _ in range(_ROUNDS):
        explained = _explain(joint, kind, rows, factors)
        i, j = (int(k) for k in np.unravel_index(np.argmax(explained), explained.shape))
        best = _Fit(int(rows[i]), float(factors[j]), max(square - float(explained[i, j]), _RIDGE * square) / free)
        near = np.linspace(rows[max(i - 1, 0)], rows[min(i + 1, rows.size - 1)], _GRID // 2)
        rows, factors = np.unique(np.rint(near).astype(np.intp)), best.factor * (factors / factors[j]) ** _CLOSER
    return best


def _list_rows(joint: _Joint) -> NDArray[np.intp]:
    """Rows at which a step is tried first."""
    count = joint.target.size
    shortest = max(1, round(_SHORTEST * count))
    return np.linspace(shortest, count - shortest, _GRID).astype(np.intp)


def _explain(joint: _Joint, kind: _Kind, rows: NDArray[np.intp], factors: Samples) -> Samples:
    """Sum of squares of the torque that steps at these rows and of these factors explain. Shape (n_rows, n_factors)."""
    grams, moments = _sum_before(joint, rows)
    before, after = _scale(joint, kind, factors)
    first, second = grams[:-1, None], (grams[-1] - grams[:-1])[:, None]
    gram = before[:, None] * first * before + after[:, :, None] * second * after[:, None, :]
    moment = before * moments[:-1, None] + after * (moments[-1] - moments[:-1])[:, None]
    return _solve(gram, moment)


def _scale(joint: _Joint, kind: _Kind, factors: Samples) -> tuple[Samples, Samples]:
    """By what the columns count before and after a step. Shapes (n_columns,) and (n_factors, n_columns)."""
    stepped = (joint.of_payload & kind.payload) | (joint.of_other & kind.other)
    scaled = (joint.of_body & kind.body) | (joint.of_friction & kind.friction)
    always = joint.of_body | joint.of_friction
    return always.astype(np.float64), np.where(scaled, factors[:, None], (always | stepped).astype(np.float64))


def _list_left(joint: _Joint, kind: _Kind, fit: _Fit) -> Samples:
    """Torque that a step leaves [N·m] or [N]. Shape (n_rows,)."""
    before, after = _scale(joint, kind, np.array([fit.factor]))
    columns = joint.columns * np.where(np.arange(joint.target.size)[:, None] < fit.row, before, after[0])
    return np.asarray(joint.target - columns @ np.linalg.lstsq(columns, joint.target, rcond=None)[0])


def _is_borne_out(joint: _Joint, kind: _Kind, fit: _Fit, velocity: Samples) -> bool:
    """Whether friction at the speeds that both parts have is nearer to a step by this factor than to none.

    Curves that may take many forms, and an acceleration that is an encoder's noise in slow strokes and none in fast
    ones, make a step of what is none. Parts without a speed in common leave it open.

    Args:
        joint: What the torque is a sum of.
        kind: Of the step.
        fit: The step.
        velocity: Of the rows [rad/s] or [m/s].
    """
    before, after = _scale(joint, kind, np.array([fit.factor]))
    is_before = np.arange(velocity.size) < fit.row
    columns = joint.columns * np.where(is_before[:, None], before, after[0])
    solution = np.linalg.lstsq(columns, joint.target, rcond=None)[0]
    body = columns[:, joint.of_body] @ solution[joint.of_body]
    friction, speed = (joint.target - body) * np.sign(velocity), np.abs(velocity)
    edges = np.quantile(speed, np.linspace(0.0, 1.0, _BINS + 1))
    bins = np.clip(np.searchsorted(edges, speed, side="right") - 1, 0, _BINS - 1)
    levels = np.array(
        [
            [
                float(np.median(friction[rows & part])) if np.count_nonzero(rows & part) >= _IN_BIN else np.nan
                for part in (is_before, ~is_before)
            ]
            for rows in (bins == k for k in range(_BINS))
        ]
    )
    levels = levels[np.all(levels > 0.0, axis=1)]
    if not levels.size:
        return True
    ratio = float(np.median(np.log(levels[:, 1] / levels[:, 0])))
    return bool(abs(ratio - np.log(fit.factor)) < abs(ratio))


def count_alike(left: Samples) -> float:
    """How many rows count as one, because what is left of them goes together."""
    spectrum = np.abs(np.fft.rfft(left, 2 * left.size)) ** 2
    shared = np.fft.irfft(spectrum)[: left.size // 4]
    shared = shared / max(float(shared[0]), 1e-300)
    apart = np.flatnonzero(shared < _APART)
    return float(1.0 + 2.0 * np.sum(shared[1 : apart[0] if apart.size else shared.size]))


def _sum_before(joint: _Joint, rows: NDArray[np.intp]) -> tuple[Samples, Samples]:
    """Products of the columns with each other and with the torque, summed before each row, and over all rows last."""
    edges = [0, *rows.tolist(), joint.target.size]
    cells = [slice(start, stop) for start, stop in pairwise(edges)]
    grams = [joint.columns[cell].T @ joint.columns[cell] for cell in cells]
    moments = [joint.columns[cell].T @ joint.target[cell] for cell in cells]
    return np.cumsum(grams, axis=0), np.cumsum(moments, axis=0)


def _solve(gram: Samples, moment: Samples) -> Samples:
    """Sum of squares that least squares explain, by their normal equations."""
    held = gram + _RIDGE * np.eye(gram.shape[-1])
    solution = np.linalg.solve(held, moment[..., None])[..., 0]
    return np.asarray(2.0 * np.sum(solution * moment, axis=-1) - np.einsum("...i,...ij,...j", solution, gram, solution))
