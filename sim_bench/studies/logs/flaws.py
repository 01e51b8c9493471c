"""Twenty things that happen to logs, each a transform of a good one."""

from collections.abc import Callable

import numpy as np

from fricomp.recording import Recording

Flaw = Callable[[Recording, np.random.Generator], Recording]


def _stamps_in_ms(log: Recording, rng: np.random.Generator) -> Recording:
    stamps = np.round(log.time, 3)
    return log.with_channels(time=stamps) if np.all(np.diff(stamps) > 0.0) else log


def _jitter(log: Recording, rng: np.random.Generator) -> Recording:
    stamps = np.sort(log.time + rng.normal(0.0, 1e-4, len(log)))
    return log.with_channels(time=stamps + 1e-9 * np.arange(len(log)))


def _gap(log: Recording, rng: np.random.Generator) -> Recording:
    start = log.time[0] + log.duration * rng.uniform(0.4, 0.6)
    return log.rows((log.time < start) | (log.time > start + 2.0))


def _lost_rows(log: Recording, rng: np.random.Generator) -> Recording:
    return log.rows(rng.random(len(log)) > 0.05)


def _rest(log: Recording, rng: np.random.Generator) -> Recording:
    period, k = log.sample_period, len(log) // 2
    n = round(25.0 / period)

    def hold(name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        values = log.channels[name]
        return np.concatenate([values[:k], np.full(n, values[k] if name != "velocity" else 0.0), values[k:]])

    channels = {name: hold(name) for name in log.channels if name != "time"}
    time = np.concatenate([log.time[:k], log.time[k] + period * np.arange(n), log.time[k:] + n * period])
    return Recording.from_channels({"time": time, **channels}, log.metadata)


def _other_publisher(log: Recording, rng: np.random.Generator) -> Recording:
    others = rng.random(len(log)) < 0.02
    zeros = {name: np.where(others, 0.0, values) for name, values in log.channels.items() if name != "time"}
    return log.with_channels(**zeros)


def _outliers(log: Recording, rng: np.random.Generator) -> Recording:
    position = np.array(log.position)
    position[rng.choice(len(log), 6, replace=False)] = 55.0
    return log.with_channels(position=position)


def _torn(log: Recording, rng: np.random.Generator) -> Recording:
    position = np.array(log.position)
    start = int(rng.integers(1000, len(log) - 1500))
    position[start : start + 150] = 0.0
    return log.with_channels(position=position)


def _wrap(log: Recording, rng: np.random.Generator) -> Recording:
    moved = np.asarray(log.position) + np.pi - np.mean(log.position)
    return log.with_channels(position=np.mod(moved, 2.0 * np.pi))


def _coarse_encoder(log: Recording, rng: np.random.Generator) -> Recording:
    count = 2.0 * np.pi / 2**14
    return log.with_channels(position=np.round(log.position / count) * count)


def _coarse_torque(log: Recording, rng: np.random.Generator) -> Recording:
    return log.with_channels(torque=np.round(log.torque / 0.02) * 0.02)


def _velocity_without_zero(log: Recording, rng: np.random.Generator) -> Recording:
    step = 90.0 / 4095.0
    return log.with_channels(velocity=(np.floor(np.asarray(log.velocity) / step) + 0.5) * step)


def _velocity_of_another(log: Recording, rng: np.random.Generator) -> Recording:
    return log.with_channels(velocity=np.asarray(log.velocity)[::-1])


def _no_velocity(log: Recording, rng: np.random.Generator) -> Recording:
    return log.with_channels(velocity=None)


def _held(log: Recording, rng: np.random.Generator) -> Recording:
    index = np.arange(len(log)) // 4 * 4
    return log.with_channels(**{n: values[index] for n, values in log.channels.items() if n != "time"})


def _unsigned(log: Recording, rng: np.random.Generator) -> Recording:
    return log.with_channels(torque=np.mod(np.round(log.torque / 1e-3), 2**16) * 1e-3)


def _turned(log: Recording, rng: np.random.Generator) -> Recording:
    return log.with_channels(torque=-np.asarray(log.torque))


def _late(log: Recording, rng: np.random.Generator) -> Recording:
    return log.with_channels(torque=np.interp(log.time + 6e-3, log.time, log.torque))


def _offset(log: Recording, rng: np.random.Generator) -> Recording:
    return log.with_channels(torque=np.asarray(log.torque) + 0.05)


def _clock_start(log: Recording, rng: np.random.Generator) -> Recording:
    return log.with_channels(time=np.asarray(log.time) + 1.7e9)


FLAWS: dict[str, Flaw] = {
    one.__name__[1:]: one
    for one in (
        _stamps_in_ms, _jitter, _gap, _lost_rows, _rest, _other_publisher, _outliers, _torn, _wrap, _coarse_encoder,
        _coarse_torque, _velocity_without_zero, _velocity_of_another, _no_velocity, _held, _unsigned, _turned, _late,
        _offset, _clock_start,
    )
}  # fmt: skip
"""Twenty things that happen to logs."""

NAMED = {"unsigned": "signed_bits = 16", "turned": "sign = -1"}
"""Flaws that are refused, by the line that mends them."""


def put_into(log: Recording, flaws: tuple[str, ...], seed: int) -> Recording:
    """The log with these flaws, one after the other.

    Args:
        log: A good one.
        flaws: Their names.
        seed: Of what is random in them.
    """
    rng = np.random.default_rng(seed)
    for flaw in flaws:
        log = FLAWS[flaw](log, rng)
    return log
