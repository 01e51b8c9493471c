"""One short part between two gaps does not decide how the others are filtered."""

from __future__ import annotations

import numpy as np
import pytest

import fricomp
from fricomp.calibration.motion.parts import read_motion_recording
from fricomp.errors import RecordingError
from fricomp.recording import Recording
from fricomp.sim_bench.studies.logs.good_log import INERTIA, joint_log


def _log(seed: int) -> Recording:
    """A coarse encoder, and a part of 0.39 s between two gaps of 0.3 s."""
    log = joint_log(30.0, 500.0, seed)
    count = 2.0 * np.pi / 2**12
    coarse = log.with_channels(position=np.round(log.position / count) * count)
    lost = ((log.time > 9.0) & (log.time < 9.3)) | ((log.time > 9.69) & (log.time < 9.99))
    return coarse.rows(~lost)


@pytest.mark.parametrize("seed", [4, 5])
def test_the_noise_of_a_coarse_encoder_is_kept_out_beside_a_short_part(seed: int) -> None:
    found = fricomp.identify(_log(seed), law="coulomb_viscous")
    assert found.motion is not None
    assert any(note.startswith("Low-pass: ") for note in found.notes)
    assert found.motion.rigid_body.inertia == pytest.approx(INERTIA, rel=0.05)


def test_a_log_of_nothing_but_short_stretches_is_refused_with_the_rate_to_give() -> None:
    log = joint_log(12.0, 1000.0, 3)
    rows = np.arange(len(log)) % 10 < 7  # bursts of ten, of which three have no later stamp
    held = np.arange(len(log)) // 10 * 10
    stamps = np.asarray(log.time)[held] + 2e-5 * (np.arange(len(log)) % 10)
    with pytest.raises(RecordingError, match=r"stretches of at most 7 between gaps.*--row-rate"):
        read_motion_recording(log.with_channels(time=stamps).rows(rows))
