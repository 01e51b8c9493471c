"""Temperature of a joint over a recording."""

import numpy as np
from numpy.typing import NDArray

AMBIENT = 25.0  # [°C]


def warm_and_cool(time: NDArray[np.float64], rise: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Warm-up, a plateau and cooling within one recording [°C]; never a straight drift.

    Args:
        time: Since the start of the recording [s].
        rise: Of the plateau [K].
        rng: Draws when it is reached and left.
    """
    t, end = np.maximum(time, 0.0), time[-1]
    peak, tau = rng.uniform(0.45, 0.65) * end, rng.uniform(0.15, 0.3) * end
    warm = 1.0 - np.exp(-t / tau)
    cool = (1.0 - np.exp(-peak / tau)) * np.exp(-(t - peak) / (0.8 * tau))
    return np.asarray(AMBIENT + rise * np.where(t < peak, warm, cool))


def draw_temperature(time: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Temperature of a joint whose friction does not care [°C]: steady, still warming up, or warmed up and cooling."""
    kind, rise, settling = int(rng.integers(4)), rng.uniform(5.0, 25.0), rng.uniform(15.0, 60.0)
    if kind < 2:
        return warm_and_cool(time, rise, rng)
    climb = rise if kind == 2 else 0.0
    return np.asarray(AMBIENT - climb * np.expm1(-(time - time[0]) / settling) + 0.5 * np.sin(0.05 * time))
