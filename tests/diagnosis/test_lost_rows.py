"""Recordings from which rows were lost in bursts, and whose stamps say so."""

from __future__ import annotations

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


@pytest.mark.slow
@pytest.mark.parametrize(("share", "longest", "bits"), [(0.03, 12, 17), (0.02, 12, 16), (0.03, 1, 14)])
def test_lost_rows_are_no_physics(share: float, longest: int, bits: int) -> None:
    joint = ToyJoint(resolution=2 * np.pi / 2**bits)
    found = diagnose(_lose(recording(joint, "fourier", 20.0, 3), share, longest, 2))
    assert found.verdict == "consistent"
    assert found.base_model is not None
    assert found.base_model.dynamics is not None
    assert found.base_model.dynamics.inertia == pytest.approx(joint.inertia, rel=0.03)
