"""A torque sensor beside the motor's torque: the gain of the latter, and how far it saturates."""

from typing import NamedTuple

import numpy as np

from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_SLOW = 0.1
"""Part of the top speed below which the direction of friction is not sure: rows there say nothing, where others do."""
_FEWEST = 60
"""Rows that are compared at least."""
_CLEARER = 0.5
"""What sliding rows leave, over what all leave, below which they alone are compared: a held shaft gives its torque at
rest, where friction does not hide it."""
_ALIKE = 5.0
"""Rows that err alike: their variance counts so often."""
_ALIKE_ROWS = 3
"""Rows that are averaged where two torques are compared."""
_CERTAIN = 4.0
"""Standard deviations from a gain of one, or from no saturation, beyond which it is told."""
_MATTERS = 0.03
"""Relative error of a torque that matters."""
_OF_THE_REST = 0.5
"""What a saturation explains of the load torque over what is left of it: less may be what the law of friction lacks."""
_STEEPER = 5.0
"""Between the widths of the two changes of direction that stand for friction near zero speed."""
_RELATED = 0.8
"""Correlation of two torques below which one is not that of the other's joint."""


class TwoTorques(NamedTuple):
    """load torque = gain * torque, or = (small_gain + bend * torque²) * torque, beside inertia, friction and offset.

    Attributes:
        gain: Middle of the two regressions that it lies between [1].
        gain_deviation: Its standard deviation, for blocks that err alike, with half of what they differ by [1].
        small_gain: Gain at small torques [1].
        small_gain_deviation: Its standard deviation [1].
        bend: Change of the gain with the square of the torque [1 / torque²].
        bend_deviation: Its standard deviation.
        largest: Largest torque that occurs for long [as torque].
        unexplained: What is left, over the deviation of the load torque.
        straight_unexplained: The same without the bend.
    """

    gain: float
    gain_deviation: float
    small_gain: float
    small_gain_deviation: float
    bend: float
    bend_deviation: float
    largest: float
    unexplained: float
    straight_unexplained: float

    @property
    def loss(self) -> float:
        """Part of the torque that is lost at the largest one."""
        return -self.bend * self.largest**2 / self.small_gain if self.small_gain > 0.0 else 0.0

    @property
    def saturates(self) -> bool:
        """Whether a loss at large torques is sure, matters, and explains more than the law of friction may leave."""
        bent = self.straight_unexplained**2 - self.unexplained**2
        return (
            self.bend < -_CERTAIN * self.bend_deviation
            and self.loss > max(_MATTERS, self.unexplained)
            and bent > (_OF_THE_REST * self.unexplained) ** 2
        )

    @property
    def told_gain(self) -> tuple[float, float]:
        """The gain, at small torques where the motor saturates, and its standard deviation."""
        small = self.small_gain, self.small_gain_deviation
        return small if self.saturates else (self.gain, self.gain_deviation)

    @property
    def is_off(self) -> bool:
        """Whether this gain is not one: a smaller error may be a part of what friction leaves of the load torque."""
        gain, deviation = self.told_gain
        return abs(gain - 1.0) > max(_CERTAIN * deviation, _MATTERS, self.unexplained)


def find_torque_gain(recording: Recording) -> tuple[Finding, ...]:
    """A motor torque that is not what the sensor measures, beside the inertia and the friction between both."""
    fit = fit_two_torques(recording)
    if fit is None:
        return ()
    if not fit.is_off and not fit.saturates:
        return ()
    said = f"load_torque is {fit.gain:.3g} ± {fit.gain_deviation:.1g} times torque"
    if fit.saturates:
        said = (
            f"load_torque is {fit.small_gain:.3g} times torque at small torques and {100 * fit.loss:.0f} % less of it "
            f"at {fit.largest:.3g} {recording.metadata.torque_unit}: the motor saturates"
        )
    message = f"{said}, {100 * fit.unexplained:.2g} % of its deviation left"
    advice = f"write scale = {fit.gain:.4g} for torque in a mapping, or take load_torque for torque"
    return (Finding("torque_gain", "warning", message, advice, column="torque"),)


def fit_two_torques(recording: Recording) -> TwoTorques | None:
    """Compare the motor's torque with that of a sensor; None where there is none, or both are hardly related.

    Where rows that slide agree far better they alone are compared: in the others friction is anything between its two
    directions, and a joint that is held against gravity most of the time had a motor that loses a third of its torque.
    """
    if recording.load_torque is None or len(recording) < _FEWEST * _ALIKE_ROWS:
        return None
    count = len(recording) // _ALIKE_ROWS * _ALIKE_ROWS
    time, position, torque, load = (
        np.asarray(values)[:count].reshape(-1, _ALIKE_ROWS).mean(axis=1)
        for values in (recording.time, recording.position, recording.torque, recording.load_torque)
    )
    if np.std(torque) == 0.0 or np.std(load) == 0.0 or abs(np.corrcoef(torque, load)[0, 1]) < _RELATED:
        return None
    velocity = np.gradient(position, time)
    slow = max(float(np.percentile(np.abs(velocity), 98)) * _SLOW, 1e-300)
    friction = [np.tanh(velocity / slow), np.tanh(_STEEPER * velocity / slow), velocity, velocity * np.abs(velocity)]
    beside = np.column_stack([np.gradient(velocity, time), *friction, np.ones(time.size)])
    slides = np.abs(velocity) > slow
    every = _compare(torque, load, beside)
    if np.count_nonzero(slides) < _FEWEST:
        return every
    sliding = _compare(torque[slides], load[slides], beside[slides])
    return sliding if sliding.unexplained < _CLEARER * every.unexplained else every


def _compare(torque: Samples, load: Samples, beside: Samples) -> TwoTorques:
    """The load torque as a multiple of the motor's, straight and bent, beside other terms, shape (n, k).

    Both are measured: noise makes the multiple smaller where it is in the motor's torque, and larger where it is in the
    load's. It lies between those of the two regressions [frisch1934confluence].
    """
    size = max(float(np.std(load)), 1e-300)
    (least,), (least_deviation,), straight = _solve_first(np.column_stack([torque, beside]), load, 1)
    (inverse,), _, _ = _solve_first(np.column_stack([load, beside]), torque, 1)
    most = 1.0 / inverse if inverse * least > 0.0 else np.inf
    gain, gain_deviation = 0.5 * (least + most), float(np.hypot(least_deviation, 0.5 * (most - least)))
    solved, deviations, left = _solve_first(np.column_stack([torque, torque**3, beside]), load, 2)
    largest = float(np.quantile(np.abs(torque), 0.99))
    return TwoTorques(
        float(gain), gain_deviation, float(solved[0]), float(deviations[0]), float(solved[1]),
        float(deviations[1]), largest, left / size, straight / size,
    )  # fmt: skip


def _solve_first(table: Samples, target: Samples, count: int) -> tuple[Samples, Samples, float]:
    """The first parameters by least squares, their standard deviations, and what is left."""
    solution = np.asarray(np.linalg.lstsq(table, target, rcond=None)[0], dtype=np.float64)
    left = float(np.std(target - table @ solution))
    spread = left * np.sqrt(_ALIKE * np.diag(np.linalg.pinv(table.T @ table)))
    return solution[:count], spread[:count], left
