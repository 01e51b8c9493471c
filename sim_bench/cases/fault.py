"""Faults of the signal itself, which a data check must find before any physics is named."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

Channels = dict[str, "NDArray[np.float64]"]


def apply_fault(channels: Channels, fault: str, rng: np.random.Generator) -> Channels:
    """The channels with a fault; `fault` is a key of `FAULTS`."""
    return FAULTS[fault]({name: values.copy() for name, values in channels.items()}, rng)


def _wrap(channels: Channels, rng: np.random.Generator) -> Channels:
    """The position counter overflows inside the range of the motion."""
    q = channels["position"]
    place, span = np.quantile(q, rng.uniform(0.6, 0.8)), np.ptp(q)
    channels["position"] = np.where(q > place, q - 1.5 * span, q)
    return channels


def _drop(channels: Channels, rng: np.random.Generator) -> Channels:
    """Bursts of 20 to 200 samples are lost, the time stamps with them."""
    n = channels["time"].size
    kept = np.ones(n, dtype=bool)
    for start in rng.integers(0, n - 200, 40):
        kept[start : start + int(rng.integers(20, 200))] = False
    return {name: values[kept] for name, values in channels.items()}


def _hold(name: str, channels: Channels, rng: np.random.Generator) -> Channels:
    """A channel repeats its last value for a third of the recording while the joint moves."""
    n = channels["time"].size
    start = int(rng.uniform(0.2, 0.5) * n)
    channels[name][start : start + n // 3] = channels[name][start]
    return channels


FAULTS: dict[str, Callable[[Channels, np.random.Generator], Channels]] = {
    "counter_wrap": _wrap,
    "dropped_samples": _drop,
    "stuck_torque": partial(_hold, "torque"),
    "frozen_position": partial(_hold, "position"),
}
