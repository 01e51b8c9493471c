"""Recordings from which rows were lost in bursts, and whose stamps say so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis import diagnose
from fricomp.diagnosis.inputs.track import Track
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.recording import Recording
from tests.diagnosis.toy_joint import ToyJoint, recording


def _lose(whole: Recording, share: float, longest: int, seed: int) -> Recording:
    rng = np.random.default_rng(seed)
    keep = np.ones(len(whole), dtype=bool)
    for row in rng.integers(20, len(whole) - 20, int(2 * len(whole) * share / (1 + longest))):
        keep[row : row + rng.integers(1, longest + 1)] = False
    return whole.rows(keep)


def _load(share: float, longest: int) -> tuple[Track, Track]:
    """The track of a recording, and of the same with rows missing."""
    whole = recording(ToyJoint(), "fourier", 8.0)
    return build_tracks([whole])[0], build_tracks([_lose(whole, share, longest, 1)])[0]


@pytest.mark.parametrize("longest", [1, 12])
def test_a_track_knows_at_which_samples_no_row_was_recorded(longest: int) -> None:
    whole, lost = _load(0.03, longest)
    assert whole.missing.size == 0
    assert np.mean(lost.missing) == pytest.approx(0.03, rel=0.3)
    np.testing.assert_allclose(lost.position[~lost.missing], whole.position[~lost.missing])
    np.testing.assert_allclose(lost.fill_rows(whole.position), lost.position)


def test_what_lies_between_slow_rows_is_drawn_from_these_alone() -> None:
    """Nulls of a slow log had an encoder that was rounded anew at each point of the finer grid."""
    track = build_tracks([recording(ToyJoint(), "fourier", 8.0, every=10)])[0]
    assert track.dt == pytest.approx(2.5e-3)
    assert track.stamps == pytest.approx(0.01 * np.arange(800))
    rows = track.take_rows(track.position)
    np.testing.assert_allclose(rows, track.position[::4], atol=1e-12)
    np.testing.assert_allclose(track.fill_rows(rows), track.position, atol=1e-12)
    rounded = np.round(track.position / 1e-3) * 1e-3
    drawn = track.fill_rows(track.take_rows(rounded))
    np.testing.assert_allclose(drawn[::4], rounded[::4], atol=1e-12)
    assert np.max(np.abs(drawn - rounded)) > 2e-4


@pytest.mark.slow
def test_a_coarse_encoder_in_slow_rows_is_no_physics() -> None:
    """At 100 Hz and 1.5 mrad a joint with nothing missing was something unknown."""
    step = 2.0 * np.pi / 2**12
    slow = recording(ToyJoint(torque_noise=0.02), "rich", 60.0, seed=3, every=10)
    found = diagnose(replace(slow, position=np.round(slow.position / step) * step, velocity=None))
    assert found.record.verdict == "consistent"
    assert found.record.noise_ratio == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("share", "longest", "bits"), [(0.03, 12, 17), (0.02, 12, 16), (0.03, 1, 14)])
def test_lost_rows_are_no_physics(share: float, longest: int, bits: int) -> None:
    joint = ToyJoint(resolution=2 * np.pi / 2**bits)
    found = diagnose(_lose(recording(joint, "fourier", 20.0, 3), share, longest, 2))
    assert found.verdict == "consistent"
    assert found.base_model is not None
    assert found.base_model.dynamics is not None
    assert found.base_model.dynamics.inertia == pytest.approx(joint.inertia, rel=0.03)
