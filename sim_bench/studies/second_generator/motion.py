"""The two motions on which the joints are recorded."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import DiagnosisError

PERIOD = 1e-3
"""Of the loop and of the samples [s]."""

_REACH = 1.2  # [rad]
_RATE = round(1.0 / PERIOD)  # [1/s]


@dataclass(frozen=True)
class Motion:
    """A reference of the loop; arrays of shape (n_samples,).

    Attributes:
        time: [s]
        position: [rad]
        velocity: [rad/s]
    """

    time: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.time.size * PERIOD)


def make_motion(kind: str, duration: float, seed: int) -> Motion:
    """A motion from rest.

    Args:
        kind: A key of `MOTIONS`.
        duration: [s]
        seed: Of its phases, speeds and stops.

    Raises:
        DiagnosisError: There is no such motion.
    """
    if kind not in MOTIONS:
        raise DiagnosisError(f"no motion {kind!r}: valid are {', '.join(MOTIONS)}")
    time = np.arange(round(duration * _RATE)) / _RATE
    position = MOTIONS[kind](time, np.random.default_rng([seed, 1]))
    return Motion(time, position, np.gradient(position, time))


def _rich(time: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Ramps of many slow speeds with rests between them, and then a multisine."""
    half = time.size // 2
    ramps = _ramps(half, rng)
    late = time[half:] - time[half]
    swing = np.zeros_like(late)
    for frequency, share in zip((0.1, 0.23, 0.41, 0.8, 1.3), (0.8, 0.4, 0.25, 0.12, 0.06), strict=True):
        swing += 1.1 * share * np.sin(2.0 * np.pi * frequency * time[half:] + rng.uniform(0.0, 2.0 * np.pi))
    arrived = np.clip(late / 2.0, 0.0, 1.0)
    return _rounded(np.concatenate([ramps, swing * arrived + ramps[-1] * (1.0 - arrived)]), 101)


def _ramps(count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Shape (count,)."""
    pieces, length, place = [np.zeros(100)], 100, 0.0
    while length <= count:
        speed, target = float(rng.choice([0.02, 0.05, 0.1, 0.2, 0.4])), float(rng.uniform(-_REACH, _REACH))
        steps = min(max(round(abs(target - place) / speed * _RATE), 2), 6 * _RATE)  # a slow one ends before its target
        target = place + float(np.clip(target - place, -speed * steps / _RATE, speed * steps / _RATE))
        rest = round(float(rng.choice([0.1, 0.5, 1.5])) * _RATE)
        pieces += [np.linspace(place, target, steps), np.full(rest, target)]
        length, place = length + steps + rest, target
    return _rounded(np.concatenate(pieces)[:count], 401)


def _rounded(position: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Moving mean over `width` samples, an odd number; as long as before."""
    padded = np.pad(position, width // 2, mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), "valid")


def _fourier(time: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Eight harmonics of 0.1 Hz, as identification of robots uses them."""
    position = np.zeros_like(time)
    for harmonic in range(1, 9):
        sine, cosine = rng.normal(size=2) / harmonic
        angle = 0.2 * np.pi * harmonic * time
        position += sine * np.sin(angle) + cosine * np.cos(angle)
    position -= position[0]
    position *= _REACH / np.max(np.abs(position))
    position *= min(1.0, 2.5 / float(np.max(np.abs(np.gradient(position, time)))))
    return np.asarray(position * 0.5 * (1.0 - np.cos(0.5 * np.pi * np.minimum(time, 2.0))))


MOTIONS: dict[str, Callable[[NDArray[np.float64], np.random.Generator], NDArray[np.float64]]] = {
    "rich": _rich,
    "fourier": _fourier,
}
"""Position [rad] by the name of the motion."""
