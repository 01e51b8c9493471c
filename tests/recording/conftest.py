"""A small healthy recording that the tests then damage."""

from collections.abc import Callable

import numpy as np
import pytest

from fricomp.recording import Recording, RecordingMetadata


@pytest.fixture
def make_recording() -> Callable[..., Recording]:
    """Return a function (n_samples, period) -> recording of a joint with friction in sinusoidal motion."""

    def make(n_samples: int = 4000, period: float = 1e-3) -> Recording:
        time = np.arange(n_samples) * period
        omega = 2 * np.pi * 0.5
        position, velocity = 0.8 * np.sin(omega * time), 0.8 * omega * np.cos(omega * time)
        noise = np.random.default_rng(1).normal(0.0, 0.01, n_samples)
        torque = 0.3 * np.sign(velocity) + 0.1 * velocity - 0.05 * omega**2 * position + noise
        metadata = RecordingMetadata(joint="elbow", encoder_resolution=2 * np.pi / 2**18)
        channels = {"time": time, "position": position, "torque": torque, "velocity": velocity}
        return Recording.from_channels(channels, metadata)

    return make
