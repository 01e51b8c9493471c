"""Where a mismatch sits: excess energy over what the joint did, with bands, and intervals that hold most of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..inputs.track import FloatArray
from ..record.result import Interval, Location, RowSeries
from ..search.generic import measure_time_since_reversal
from ..search.preparation import Baseline
from .settings import LOCATION

__all__ = ["collect_rows", "find_change_points", "locate", "map_excess"]


def collect_rows(
    baseline: Baseline, before: Sequence[FloatArray], after: Sequence[FloatArray]
) -> tuple[RowSeries, ...]:
    """Residual rows of each recording with the state of the joint."""
    result = []
    for i, (track, grid, context) in enumerate(
        zip(baseline.problem.tracks, baseline.problem.grids, baseline.structure.contexts, strict=True)
    ):
        at = grid.centres
        temperature = context.channels.get("temperature")
        result.append(
            RowSeries(
                name=track.name,
                time=context.time[at],
                position=context.position[at],
                velocity=context.velocity[at],
                acceleration=context.acceleration[at],
                load_torque=context.load_torque[at],
                time_since_reversal=measure_time_since_reversal(context.velocity, context.dt)[at],
                temperature=None if temperature is None else temperature[at],
                before=before[i],
                after=after[i],
                spread=baseline.nulls.weights.spread[i],
            )
        )
    return tuple(result)


def map_excess(series: Sequence[RowSeries], seed: int) -> dict[str, dict[str, FloatArray]]:
    """Energy beyond the noise over bins of each quantity, with 95 % bands from a block bootstrap."""
    energy = np.concatenate([(s.before / s.spread) ** 2 for s in series])
    maps = {}
    for name in ("velocity", "position", "acceleration", "load_torque", "time_since_reversal", "temperature", "time"):
        parts = [getattr(s, name) for s in series]
        if any(part is None for part in parts):
            continue
        values = np.concatenate(parts)
        if np.ptp(values) > 0.0:
            maps[name] = _map_quantity(values, energy, seed)
    return maps


def _map_quantity(values: FloatArray, energy: FloatArray, seed: int) -> dict[str, FloatArray]:
    edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, LOCATION.bins + 1)))
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, edges.size - 2)
    count = np.bincount(index, minlength=edges.size - 1)
    starts = np.arange(0, values.size, LOCATION.block)
    rng = np.random.default_rng(seed)
    sums = np.stack(
        [
            np.bincount(index[s : s + LOCATION.block], energy[s : s + LOCATION.block] - 1.0, edges.size - 1)
            for s in starts
        ]
    )
    counts = np.stack([np.bincount(index[s : s + LOCATION.block], minlength=edges.size - 1) for s in starts])
    drawn = [rng.integers(0, starts.size, starts.size) for _ in range(LOCATION.bootstraps)]
    means = np.stack([sums[d].sum(axis=0) / np.maximum(counts[d].sum(axis=0), 1) for d in drawn])
    lower, upper = np.quantile(means, [0.025, 0.975], axis=0)
    return {"edges": edges, "excess": sums.sum(axis=0) / np.maximum(count, 1), "lower": lower, "upper": upper}


def _find_intervals(values: FloatArray, energy: FloatArray) -> list[Interval]:
    """Intervals of `values` that hold most of the excess energy, densest first until the share is reached."""
    edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, LOCATION.bins + 1)))
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, edges.size - 2)
    total = np.maximum(np.bincount(index, energy, edges.size - 1), 0.0)
    density = total / np.maximum(np.bincount(index, minlength=edges.size - 1), 1)
    chosen, held = np.zeros(total.size, dtype=bool), 0.0
    for i in np.argsort(-density):
        if held >= LOCATION.share * total.sum():
            break
        chosen[i], held = True, held + total[i]
    return merge([(float(edges[i]), float(edges[i + 1])) for i in np.flatnonzero(chosen)], 1e-12)


def merge(intervals: Sequence[Interval], gap: float) -> list[Interval]:
    """Neighbouring intervals joined."""
    result: list[Interval] = []
    for low, high in sorted(intervals):
        if result and low <= result[-1][1] + gap:
            result[-1] = (result[-1][0], max(high, result[-1][1]))
        else:
            result.append((low, high))
    return result


def locate(
    series: Sequence[RowSeries],
    energy: Sequence[FloatArray],
    *,
    rows: int = 1,
    samples: tuple[FloatArray, FloatArray] | None = None,
) -> Location:
    """Intervals of each quantity that hold most of `energy`; a quantity that singles nothing out is left out.

    First comes the quantity whose intervals hold the smallest part of the recording: it says most about where.

    Args:
        series: Rows of each recording.
        energy: Of each row. Shapes (n_rows,).
        rows: Neighbouring rows that are averaged where the energy is noisy.
        samples: Time [s] and energy of every sample of the first recording, where they are known. Shapes (n,).
    """
    time, over_time = (series[0].time, energy[0]) if samples is None else samples
    location: Location = {"time": _find_times(time, over_time, rows)}
    parts_of = {"time": sum(high - low for low, high in location["time"]) / max(float(np.ptp(time)), 1e-12)}
    pooled = np.concatenate(list(energy))
    for name in ("velocity", "position", "load_torque", "acceleration", "time_since_reversal", "temperature"):
        parts = [getattr(s, name) for s in series]
        if any(part is None for part in parts):
            continue
        values = np.concatenate(parts)
        found = _find_intervals(values, pooled) if np.ptp(values) > 0.0 else []
        inside = np.zeros(values.size, dtype=bool)
        for low, high in found:
            inside |= (values >= low) & (values <= high)
        if found and inside.mean() < LOCATION.widest:
            location[name], parts_of[name] = found, float(inside.mean())
    return {name: location[name] for name in sorted(location, key=lambda name: parts_of[name])}


def _find_times(time: FloatArray, energy: FloatArray, rows: int) -> list[Interval]:
    """The shortest time that carries most of the energy of rows or samples at `time`."""
    e = np.maximum(energy, 0.0)
    smooth = np.convolve(e, np.ones(rows) / rows, mode="same")
    order = np.argsort(-smooth)
    held = np.cumsum(e[order]) / max(float(e.sum()), 1e-30)
    chosen = np.sort(order[: int(np.searchsorted(held, LOCATION.share)) + 1])
    half = 0.5 * float(np.median(np.diff(time)))
    return merge([(float(time[i] - half), float(time[i] + half)) for i in chosen], (rows - 1 + 1e-6) * half)


def find_change_points(series: Sequence[RowSeries]) -> tuple[tuple[float, ...], ...]:
    """Times at which the size of the residual changes [s]."""
    import ruptures

    result: list[tuple[float, ...]] = []
    for one in series:
        size = np.log((one.before / one.spread) ** 2 + LOCATION.floor)
        rows = LOCATION.coarse
        coarse = size[: size.size // rows * rows].reshape(-1, rows).mean(axis=1)
        if coarse.size < LOCATION.fewest:
            result.append(())
            continue
        search = ruptures.KernelCPD(kernel="linear", min_size=LOCATION.between_changes).fit(coarse[:, None])
        found = search.predict(pen=LOCATION.penalty * np.log(coarse.size))
        result.append(tuple(float(one.time[rows * i]) for i in found[:-1]))
    return tuple(result)
