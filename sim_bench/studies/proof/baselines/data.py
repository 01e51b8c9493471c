"""What every baseline starts from: a smoothed trajectory, the columns of the rigid joint, and held-out blocks."""

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording import read_recording
from fricomp.root_mean_square import compute_rms

from ...kit.rigid_joint import N_BODY, Samples, build_joint_columns

_WINDOW, _DEGREE, _STEP = 21, 3, 10  # [samples] of the Savitzky-Golay filter, its degree, and between kept samples
_BLOCK = 4.0  # [s] of held-out blocks, every third
_SLOWEST = 5e-3  # [rad/s]


class BaselineAnswer(NamedTuple):
    """What a baseline says about a recording.

    Attributes:
        names: Effects, strongest first; empty for none, or for a method that names nothing.
        error: RMS error on held-out blocks [N·m].
    """

    names: tuple[str, ...]
    error: float


@dataclass(frozen=True)
class BaselineData:
    """Moving samples of one recording, thinned; arrays of shape (n,), columns of shape (n, k).

    Attributes:
        time: [s]
        position: [rad]
        velocity: [rad/s]
        acceleration: [rad/s²]
        torque: Low-passed like the rest [N·m].
        torque_rate: [N·m/s]
        torque_bend: Second derivative [N·m/s²].
        expected: Torque of the refitted rigid joint, for regressors that need a torque: the measured one would
            explain itself [N·m].
        load: Transmitted load torque, recorded, or inertia and gravity of the refitted joint [N·m].
        temperature: [°C]; None where it was not recorded.
        stribeck_velocity: That fits the rigid joint best [rad/s].
        base: Columns of the rigid joint.
        held_out: Samples that take no part in a fit.
        gear_ratio: Of the metadata.
        kept: Index of each sample in the recording.
        whole: Position [rad] and expected torque [N·m] of all samples, for what has a memory; shape (n_recording, 2).
        simulation: Path of the believed joint.
    """

    time: Samples
    position: Samples
    velocity: Samples
    acceleration: Samples
    torque: Samples
    torque_rate: Samples
    torque_bend: Samples
    expected: Samples
    load: Samples
    temperature: Samples | None
    stribeck_velocity: float
    base: Samples
    held_out: NDArray[np.bool_]
    gear_ratio: float
    kept: NDArray[np.intp]
    whole: Samples
    simulation: Path


def load_data(folder: Path) -> BaselineData:
    """Read a case's recording and smooth it."""
    from scipy.signal import savgol_filter

    recording = read_recording(folder / "recording.parquet")
    dt = float(np.median(np.diff(recording.time)))
    q, v, a = (savgol_filter(recording.position, _WINDOW, _DEGREE, deriv=d, delta=dt) for d in range(3))
    tau, rate, bend = (savgol_filter(recording.torque, _WINDOW, _DEGREE, deriv=d, delta=dt) for d in range(3))
    moving = np.convolve(np.abs(v) < _SLOWEST, np.ones(2 * _WINDOW + 1), mode="same") == 0.0
    kept = np.flatnonzero(moving)[::_STEP]
    width, base = _fit_stribeck(q[kept], v[kept], a[kept], tau[kept])
    held_out = (recording.time[kept] // _BLOCK).astype(int) % 3 == 1
    solution = np.linalg.lstsq(base[~held_out], tau[kept][~held_out], rcond=None)[0]
    everywhere = build_joint_columns(q, v, a, width)
    expected, body = everywhere @ solution, everywhere[:, :N_BODY] @ solution[:N_BODY]
    load = body if recording.load_torque is None else savgol_filter(recording.load_torque, _WINDOW, _DEGREE)
    temperature = recording.temperature
    return BaselineData(
        time=recording.time[kept],
        position=q[kept],
        velocity=v[kept],
        acceleration=a[kept],
        torque=tau[kept],
        torque_rate=rate[kept],
        torque_bend=bend[kept],
        expected=expected[kept],
        load=load[kept],
        temperature=None if temperature is None else temperature[kept],
        stribeck_velocity=width,
        base=base,
        held_out=held_out,
        gear_ratio=recording.metadata.gear_ratio or 100.0,
        kept=kept,
        whole=np.stack([recording.position, expected], axis=1),
        simulation=folder / "joint.xml",
    )


def _fit_stribeck(q: Samples, v: Samples, a: Samples, tau: Samples) -> tuple[float, Samples]:
    """The Stribeck velocity [rad/s] that leaves the least, and its columns."""
    tried = [(width, build_joint_columns(q, v, a, width)) for width in np.geomspace(0.01, 0.4, 12).tolist()]
    return min(tried, key=lambda one: compute_rms(tau - one[1] @ np.linalg.lstsq(one[1], tau, rcond=None)[0]))


def fit_columns(data: BaselineData, columns: Samples) -> float:
    """Held-out RMS error [N·m] of a least-squares fit of the torque by columns."""
    train = ~data.held_out
    scale = np.linalg.norm(columns[train], axis=0)
    columns = columns[:, scale > 0.0] / scale[scale > 0.0]
    solution = np.linalg.lstsq(columns[train], data.torque[train], rcond=1e-10)[0]
    return compute_rms((data.torque - columns @ solution)[data.held_out])
