"""How many joints a second: all in one call, beside one after the other in one process."""

import os
import time
from dataclasses import dataclass

import numpy as np

from fricomp.calibration.batch.identification import identify_batch
from fricomp.calibration.identification import identify
from fricomp.laws import FloatArray

_SPEEDS = np.geomspace(0.01, 1.0, 40)  # [rad/s] of the plateaus in each direction


@dataclass(frozen=True)
class Throughput:
    """Joints a second, best of a few repetitions each.

    Attributes:
        joints: In the batch.
        single: Joints that were identified one after the other.
        batch_rate: Joints a second in one call.
        single_rate: Joints a second one by one, by `identify` with least squares.
        largest_difference: Of a parameter between the two, relative.
        device: Of the batch.
        threads: That torch uses.
        load: Load average of the last minute before the measurement.
    """

    joints: int
    single: int
    batch_rate: float
    single_rate: float
    largest_difference: float
    device: str
    threads: int
    load: float

    @property
    def ratio(self) -> float:
        """Batch over single."""
        return self.batch_rate / self.single_rate

    def __str__(self) -> str:
        return (
            f"{self.joints} joints of {2 * len(_SPEEDS)} points in one call on {self.device} ({self.threads} threads): "
            f"{self.batch_rate:.0f} joints/s; one by one in one process {self.single_rate:.1f} joints/s "
            f"({self.single} joints): {self.ratio:.1f} times as fast. Largest difference of a parameter "
            f"{self.largest_difference:.1e}. Load average {self.load:.2f}"
        )


def draw_parameters(count: int, seed: int) -> FloatArray:
    """Stribeck parameters of a fleet. Shape (count, 8)."""
    rng = np.random.default_rng([seed, 1])
    low, high = np.log([0.5, 0.7, 0.03, 0.1]), np.log([2.0, 2.5, 0.12, 1.0])
    values = np.exp(rng.uniform(low, high, (count, 2, 4)))
    values[:, :, 1] += values[:, :, 0]  # static above Coulomb torque
    return values.reshape(count, 8)


def draw_joints(count: int, *, seed: int, noise: float = 0.02) -> tuple[list[FloatArray], list[FloatArray]]:
    """Plateaus of a fleet: velocities [rad/s] and torques [N·m] with relative noise, one array a joint."""
    rng = np.random.default_rng([seed, 2])
    torques = []
    for forward, reverse in draw_parameters(count, seed).reshape(count, 2, 4):
        clean = np.concatenate([-_stribeck(reverse)[::-1], _stribeck(forward)])
        torques.append(clean * (1.0 + noise * rng.standard_normal(clean.size)))
    velocity = np.concatenate([-_SPEEDS[::-1], _SPEEDS])
    return [velocity] * count, torques


def _stribeck(p: FloatArray) -> FloatArray:
    g = np.exp(-((_SPEEDS / p[2]) ** 2))
    return np.asarray(p[0] * (1.0 - g) + p[1] * g + p[3] * _SPEEDS)


def measure_throughput(joints: int, *, single: int, seed: int, device: str = "cpu") -> Throughput:
    """Identify the same fleet both ways.

    Args:
        joints: In the batch.
        single: How many of them are identified one by one.
        seed: Of the fleet.
        device: Of torch for the batch.
    """
    import torch

    velocity, torque = draw_joints(joints, seed=seed)
    load, single = os.getloadavg()[0], min(single, joints)
    identify_batch(velocity[:2], torque[:2], device=device)  # libraries are loaded and kernels compiled
    batch_time = single_time = float("inf")
    for _ in range(3):  # the fastest counts
        start = time.perf_counter()
        found = identify_batch(velocity, torque, device=device)
        batch_time = min(batch_time, time.perf_counter() - start)
        start = time.perf_counter()
        alone = [identify(v, t, method="least_squares") for v, t in zip(velocity[:single], torque, strict=False)]
        single_time = min(single_time, time.perf_counter() - start)
    values = np.array([list(one.parameters.values()) for one in alone])
    return Throughput(
        joints=joints,
        single=single,
        batch_rate=joints / batch_time,
        single_rate=single / single_time,
        largest_difference=float(np.max(np.abs(found.values[:single] / values - 1.0))),
        device=device,
        threads=torch.get_num_threads(),
        load=load,
    )
