"""From the command to the torque: whether a drive follows its command late, where the joint's own motion cannot tell.

A joint that pushes against something unknown (a leg on the ground) does not obey any equation of its own motion. What
remains is the drive: what it was told, a torque or the errors of its control law, against the torque that was measured.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..inputs.delay import apply_lags
from ..inputs.track import FloatArray
from .fine_ripple import predict_left_out_blocks
from .settings import DRIVE

_Late = Callable[[FloatArray, float], FloatArray]


@dataclass(frozen=True)
class DrivePath:
    """How late the torque follows. Arrays of shape (n_samples,).

    Attributes:
        name: "drive_lag" or "torque_delay", whichever predicts better.
        value: Time constant or delay [s].
        deviation: Its standard deviation, from blocks left out [s].
        errors: Held-out RMS error [N·m] of each explanation by name: "law" for the law without any of them.
        before: Held-out error of the law alone.
        after: Held-out error with what was named.
    """

    name: str
    value: float
    deviation: float
    errors: dict[str, float]
    before: FloatArray
    after: FloatArray


def find_drive_path(recording: Recording) -> DrivePath | None:
    """Delay or lag between command and torque; None where there is no command, no law, or nothing is late."""
    inputs = _list_inputs(recording)
    torque = np.asarray(recording.torque)
    if not inputs or recording.metadata.torque_kind == "commanded" or len(recording) < DRIVE.fewest * DRIVE.folds:
        return None
    dt = recording.sample_period
    before = predict_left_out_blocks(_build_table(inputs), torque)
    tried = {name: _find_best(inputs, torque, dt, late) for name, late in _list_shapes(dt).items()}
    name = min(tried, key=lambda one: float(np.mean(tried[one][1] ** 2)))
    value, after = tried[name]
    errors = {"law": compute_rms(before), **{key: compute_rms(error) for key, (_, error) in tried.items()}}
    still = np.sign(recording.velocity) if recording.velocity is not None else np.zeros(torque.size)
    errors["coulomb"] = compute_rms(predict_left_out_blocks(np.column_stack([_build_table(inputs), still]), torque))
    history = _build_table([np.roll(one, k) for one in inputs for k in range(DRIVE.taps)])
    errors["history"] = compute_rms(predict_left_out_blocks(history, torque))
    falls = errors[name] <= (1.0 - DRIVE.least_fall) * errors["law"]
    if not falls or errors[name] ** 2 > (1.0 - DRIVE.explained) * np.var(torque):
        return None
    deviation = _estimate_deviation(inputs, torque, (dt, _list_shapes(dt)[name]))
    return DrivePath(name, value, deviation, errors, before, after)


def _list_inputs(recording: Recording) -> list[FloatArray]:
    """What the drive was told: a torque, or the errors its law works on."""
    if recording.torque_command is not None:
        return [np.asarray(recording.torque_command)]
    if recording.position_reference is None:
        return []
    error = np.asarray(recording.position_reference) - np.asarray(recording.position)
    if recording.velocity is None:
        return [error]
    wanted = 0.0 if recording.velocity_reference is None else np.asarray(recording.velocity_reference)
    return [error, wanted - np.asarray(recording.velocity)]


def _list_values(dt: float) -> FloatArray:
    """Delays or time constants that are tried [s]."""
    return np.linspace(0.0, max(DRIVE.longest, DRIVE.least_periods * dt), DRIVE.steps)


def _list_shapes(dt: float) -> dict[str, _Late]:
    def delay_signal(signal: FloatArray, delay: float) -> FloatArray:
        at = np.arange(signal.size) * dt
        shifted: FloatArray = np.interp(at - delay, at, signal)
        return shifted

    def lag_signal(signal: FloatArray, constant: float) -> FloatArray:
        return apply_lags(signal, (constant,), dt) if constant > 0.0 else signal

    return {"torque_delay": delay_signal, "drive_lag": lag_signal}


def _build_table(columns: list[FloatArray]) -> FloatArray:
    return np.column_stack([*columns, np.ones(columns[0].size)])


def _find_best(inputs: list[FloatArray], torque: FloatArray, dt: float, late: _Late) -> tuple[float, FloatArray]:
    """Value with the least held-out error, and that error."""
    grid = _list_values(dt)
    errors = [predict_left_out_blocks(_build_table([late(one, value) for one in inputs]), torque) for value in grid]
    best = int(np.argmin([compute_rms(error) for error in errors]))
    return float(grid[best]), errors[best]


def _estimate_deviation(inputs: list[FloatArray], torque: FloatArray, shape: tuple[float, _Late]) -> float:
    """Jackknife over blocks, with a parabola through the three best values of each."""
    dt, late = shape
    grid = _list_values(dt)
    tables = [_build_table([late(one, value) for one in inputs]) for value in grid]
    found = []
    for part in np.array_split(np.arange(torque.size), DRIVE.folds):
        kept = np.delete(np.arange(torque.size), part)
        left = [torque[kept] - t[kept] @ np.linalg.lstsq(t[kept], torque[kept], rcond=None)[0] for t in tables]
        found.append(_find_vertex(grid, np.array([compute_rms(one) for one in left])))
    return float(np.sqrt((DRIVE.folds - 1) * np.var(found)))


def _find_vertex(grid: FloatArray, values: FloatArray) -> float:
    k = int(np.clip(np.argmin(values), 1, grid.size - 2))
    low, middle, high = values[k - 1 : k + 2]
    bend = low - 2.0 * middle + high
    return float(grid[k] + (0.5 * (low - high) / bend if bend > 0.0 else 0.0) * (grid[1] - grid[0]))
