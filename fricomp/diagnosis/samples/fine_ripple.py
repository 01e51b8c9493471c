"""Ripple over position that is finer than the rows of the residual: harmonics found in the samples themselves.

The rows average over tens of milliseconds, so a motor that passes many poles in that time shows nothing in them. Here
the equation of motion is fitted to the samples, and orders over position are taken out of what is left, one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from fricomp.recording import Recording

from ..inputs.left_out import fit_without_blocks
from ..inputs.track import FloatArray
from .settings import RIPPLE


@dataclass(frozen=True)
class Harmonic:
    """One wave over position.

    Attributes:
        order: Waves in 2π of position [1/rad] or [1/m].
        level: Whether it is a wave of the friction level, which changes its sign with the velocity.
        sine: Amplitude of the sine [N·m] or [N].
        cosine: Amplitude of the cosine [N·m] or [N].
        amplitude_error: Standard deviation of the amplitude, from blocks left out.
        order_error: Standard deviation of the order, likewise.
    """

    order: float
    level: bool
    sine: float
    cosine: float
    amplitude_error: float
    order_error: float

    @property
    def amplitude(self) -> float:
        """[N·m] or [N]."""
        return float(np.hypot(self.sine, self.cosine))

    @property
    def is_known(self) -> bool:
        """Whether the blocks agree about its size and its order; what one of them alone shows is no ripple."""
        return self.amplitude > RIPPLE.sure * self.amplitude_error and self.order > RIPPLE.exact * self.order_error


@dataclass(frozen=True)
class FineRipple:
    """Harmonics, strongest first, and the samples they were found in. Arrays of shape (n_samples,).

    Attributes:
        harmonics: Strongest first.
        samples: Time, position, velocity, acceleration of the samples used, by name.
        before: What the equation of motion leaves, on blocks that were left out [N·m].
        after: The same with the harmonics.
        orders: Order and energy before and after, as in `Evidence.orders`.
    """

    harmonics: tuple[Harmonic, ...]
    samples: dict[str, FloatArray]
    before: FloatArray
    after: FloatArray
    orders: dict[str, FloatArray]

    @property
    def fall(self) -> float:
        """Part of the held-out energy that the harmonics take."""
        return 1.0 - float(self.after @ self.after) / float(self.before @ self.before)


def find_fine_ripple(recording: Recording, seed: int = 0) -> FineRipple | None:
    """Harmonics over position in the samples; None where they do not predict blocks that were left out.

    Args:
        recording: One recording.
        seed: Of the choice of samples, where there are too many.
    """
    best = _choose_samples(recording, seed)
    if best is None:
        return None
    samples, base = best
    orders = _list_orders(samples["position"], recording.metadata.continuous)
    if orders.size < RIPPLE.fewest_orders:
        return None
    chosen = _pursue(samples, base, orders)
    ripple = _judge(samples, base, chosen, orders)
    return ripple if ripple is not None and ripple.fall >= RIPPLE.least_fall else None


def measure_fall(recording: Recording, harmonics: Sequence[Harmonic], seed: int = 0) -> float:
    """Part of the held-out energy of `recording` that waves of the orders of `harmonics` take, at least 0."""
    best = _choose_samples(recording, seed)
    if best is None:
        return 0.0
    samples, base = best
    table = np.column_stack([base, *(_build_waves(samples, one.order, one.level) for one in harmonics)])
    before, after = (predict_left_out_blocks(one, samples["torque"]) for one in (base, table))
    return max(1.0 - float(after @ after) / float(before @ before), 0.0)


def _choose_samples(recording: Recording, seed: int) -> tuple[dict[str, FloatArray], FloatArray] | None:
    """Samples and base columns, with the derivative filter that leaves the least on blocks left out."""
    options = [
        _select_samples(recording, window, seed)
        for window in RIPPLE.windows
        if len(recording) > RIPPLE.shortest * window
    ]
    options = [one for one in options if one["time"].size > RIPPLE.fewest and np.ptp(one["position"]) > 0.0]
    if not options:
        return None
    bases = [_build_base(option, recording.metadata.continuous) for option in options]
    errors = [
        float(np.sum(predict_left_out_blocks(A, o["torque"]) ** 2) / o["time"].size)
        for A, o in zip(bases, options, strict=True)
    ]
    best = int(np.argmin(errors))
    return options[best], bases[best]


def _select_samples(recording: Recording, window: int, seed: int) -> dict[str, FloatArray]:
    """Channels and derivatives at the samples that slide, at most so many, drawn without an order of their own."""
    dt = recording.sample_period
    t = np.asarray(recording.time) - recording.time[0]
    grid = np.arange(int(t[-1] / dt) + 1) * dt
    q, torque = np.interp(grid, t, recording.position), np.interp(grid, t, recording.torque)
    degree = 2 if window < RIPPLE.cubic else 3
    v, a = (savgol_filter(q, window, degree, deriv=k, delta=dt) for k in (1, 2))
    keep = np.abs(v) > RIPPLE.slowest * np.quantile(np.abs(v), RIPPLE.top)
    keep[: window // 2] = keep[grid.size - window // 2 :] = False
    index = np.flatnonzero(keep)
    if index.size > RIPPLE.most_samples:
        index = np.sort(np.random.default_rng(seed).choice(index, RIPPLE.most_samples, replace=False))
    columns = {"time": grid, "position": q, "velocity": v, "acceleration": a, "torque": torque}
    return {name: values[index] for name, values in columns.items()}


def _build_base(samples: dict[str, FloatArray], wide: bool) -> FloatArray:
    """Columns of inertia, friction in each direction, and a smooth load. Shape (n_samples, n_columns)."""
    q, v, a = samples["position"], samples["velocity"], samples["acceleration"]
    s, top = np.sign(v), float(np.quantile(np.abs(v), RIPPLE.top))
    columns = [np.ones_like(q), a, v * (v > 0.0), v * (v < 0.0)]
    columns += [np.exp(-((v / (f * top)) ** 2)) * s for f in RIPPLE.stribeck] + ([s] if np.ptp(s) > 0.0 else [])
    x = 2.0 * (q - q.mean()) / np.ptp(q)
    columns += [np.cos(q), np.sin(q)] if wide else [x, x**2, x**3]
    table = np.column_stack(columns)
    size = np.linalg.norm(table, axis=0)
    result: FloatArray = table[:, size > 0.0] / size[size > 0.0]
    return result


def _list_orders(position: FloatArray, wide: bool) -> FloatArray:
    """Orders that the travel resolves and the samples can show."""
    span = float(np.ptp(position))
    lowest = 2.0 * np.pi * RIPPLE.waves / span
    step = 1.0 if wide else np.pi / span
    steps = np.abs(np.diff(position))
    finest = RIPPLE.finest * np.pi / max(float(np.median(steps)), 1e-12)
    highest = min(finest, lowest + step * RIPPLE.most_orders)
    return np.arange(np.ceil(lowest / step), max(highest, 0.0) / step) * step


def compute_spectrum(residual: FloatArray, position: FloatArray, orders: FloatArray) -> FloatArray:
    """Energy of `residual` that a wave of each evenly spaced order explains. Shape (n_orders,)."""
    turn: NDArray[np.complex128] = np.exp(1j * (orders[1] - orders[0]) * position)
    # The product of every so manieth wave with every step from there has all of them.
    steps = _multiply_powers(np.ones_like(turn), turn, RIPPLE.at_once)
    rows = -(-orders.size // RIPPLE.at_once)
    waves = _multiply_powers(np.exp(1j * orders[0] * position) * residual, steps[-1] * turn, rows)
    energy = np.abs((waves @ steps.T).ravel()[: orders.size]) ** 2
    result: FloatArray = 2.0 * energy / position.size
    return result


def _multiply_powers(
    first: NDArray[np.complex128], factor: NDArray[np.complex128], count: int
) -> NDArray[np.complex128]:
    """`first` times the powers of `factor` from 0 on. Shape (count, n)."""
    result = np.empty((count, first.size), dtype=np.complex128)
    result[0] = first
    for i in range(1, count):
        np.multiply(result[i - 1], factor, out=result[i])
    return result


def _build_waves(samples: dict[str, FloatArray], order: float, level: bool) -> FloatArray:
    angle = order * samples["position"]
    factor = np.sign(samples["velocity"]) if level else 1.0
    return np.column_stack([np.sin(angle) * factor, np.cos(angle) * factor])


def _pursue(samples: dict[str, FloatArray], base: FloatArray, orders: FloatArray) -> list[tuple[float, bool]]:
    """Orders and shapes, one at a time, each the strongest in what the others leave."""
    q, torque, sign = samples["position"], samples["torque"], np.sign(samples["velocity"])
    both, table = bool(np.ptp(sign) > 0.0), base
    chosen: list[tuple[float, bool]] = []
    for _ in range(RIPPLE.most_harmonics):
        left = torque - table @ np.linalg.lstsq(table, torque, rcond=RIPPLE.rank)[0]
        spectra = [compute_spectrum(left, q, orders)] + ([compute_spectrum(left * sign, q, orders)] if both else [])
        level = both and float(spectra[1].max()) > RIPPLE.preferred * float(spectra[0].max())
        order = _refine(left * sign if level else left, q, orders, int(np.argmax(spectra[int(level)])))
        if any(abs(order - known) < 0.5 * (orders[1] - orders[0]) and level == shape for known, shape in chosen):
            break
        chosen.append((order, level))
        table = np.column_stack([table, _build_waves(samples, order, level)])
    return chosen


def _refine(residual: FloatArray, position: FloatArray, orders: FloatArray, peak: int) -> float:
    step = orders[1] - orders[0]
    if step == 1.0:  # whole waves a turn
        return float(orders[peak])
    fine = np.linspace(orders[peak] - step, orders[peak] + step, RIPPLE.zoom)
    return float(fine[int(np.argmax(compute_spectrum(residual, position, fine)))])


def _judge(
    samples: dict[str, FloatArray], base: FloatArray, chosen: Sequence[tuple[float, bool]], orders: FloatArray
) -> FineRipple | None:
    """Keep the harmonics that help on blocks left out, and put errors on them."""
    torque = samples["torque"]
    tables = [base]
    for order, level in chosen:
        tables.append(np.column_stack([tables[-1], _build_waves(samples, order, level)]))
    left = [predict_left_out_blocks(table, torque) for table in tables]
    energy = np.array([float(one @ one) for one in left])
    count = 0
    while count < len(chosen) and energy[count + 1] < energy[count] - RIPPLE.worth * energy[0]:
        count += 1
    if count == 0:
        return None
    harmonics = _estimate_harmonics(samples, base, chosen[:count])
    if not harmonics[0].is_known:
        return None
    fitted = [
        torque - table @ np.linalg.lstsq(table, torque, rcond=RIPPLE.rank)[0] for table in (tables[0], tables[count])
    ]
    found = [compute_spectrum(one, samples["position"], orders) for one in fitted]
    noise = float(np.mean(fitted[1] ** 2))
    spectra = {"order": orders, "energy": found[0] / noise, "after": found[1] / noise}
    return FineRipple(harmonics, samples, left[0], left[count], spectra)


def predict_left_out_blocks(table: FloatArray, torque: FloatArray) -> FloatArray:
    """Error on each block of a fit to the others. Shape (n_samples,)."""
    result = np.empty(torque.size)
    least, most = RIPPLE.gap
    gap = max(least, min(torque.size // RIPPLE.samples_of_gap, most))
    for part, weights in fit_without_blocks(table, torque, RIPPLE.folds, rcond=RIPPLE.rank, gap=(gap, gap - 1)):
        result[part] = torque[part] - table[part] @ weights
    return result


def _estimate_harmonics(
    samples: dict[str, FloatArray], base: FloatArray, chosen: Sequence[tuple[float, bool]]
) -> tuple[Harmonic, ...]:
    """Amplitudes with errors from a jackknife over blocks; orders move by their first-order term."""
    torque, q = samples["torque"], samples["position"] - samples["position"].mean()
    waves = np.column_stack([_build_waves(samples, order, level) for order, level in chosen])
    table = np.column_stack([base, waves])
    weights = np.linalg.lstsq(table, torque, rcond=RIPPLE.rank)[0][base.shape[1] :]
    slopes = [
        q * (weights[2 * k] * waves[:, 2 * k + 1] - weights[2 * k + 1] * waves[:, 2 * k]) for k in range(len(chosen))
    ]
    table = np.column_stack([table, *slopes])
    drawn = fit_without_blocks(table, torque, RIPPLE.folds, rcond=RIPPLE.rank)
    values = np.array([weights[base.shape[1] :] for _, weights in drawn])
    amplitude = np.hypot(values[:, 0 : 2 * len(chosen) : 2], values[:, 1 : 2 * len(chosen) : 2])
    errors = np.sqrt((RIPPLE.folds - 1) * np.var(np.column_stack([amplitude, values[:, 2 * len(chosen) :]]), axis=0))
    harmonics = [
        Harmonic(order, level, *map(float, (weights[2 * k], weights[2 * k + 1], errors[k], errors[len(chosen) + k])))
        for k, (order, level) in enumerate(chosen)
    ]
    return tuple(sorted(harmonics, key=lambda one: -one.amplitude))
