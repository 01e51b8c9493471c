"""What ends a diagnosis before its search."""

import sys
from typing import Any

import pytest

from fricomp.diagnosis import RigidJoint, diagnose

from .known import PLANT, known_baseline
from .toy_joint import ToyJoint, recording

_STAGES = sys.modules["fricomp.diagnosis.diagnose"]  # the package has a function of this name


class _SearchedError(Exception):
    """The search has begun."""


@pytest.mark.parametrize("loudness", [1.0, 3.0])
def test_an_inertia_far_from_the_simulation_ends_a_base_that_leaves_noise(
    loudness: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What leaves more may have bent the inertia: a stop that is met for half of the time did, by twenty times."""

    def search(*_: Any) -> None:
        raise _SearchedError

    monkeypatch.setattr(_STAGES, "_choose_base", lambda *_: lambda **_: known_baseline(loudness=loudness))
    monkeypatch.setattr(_STAGES, "_answer", search)
    simulation = RigidJoint(30.0 * PLANT.inertia, (0.0, 0.0), 0.0, 1.0, 2.0, True)
    recorded = recording(ToyJoint(), "fourier", 10.0, every=2)
    if loudness > 1.0:
        with pytest.raises(_SearchedError):
            diagnose(recorded, simulation)
    else:
        assert "inertia 30 or more times smaller" in " ".join(diagnose(recorded, simulation).sentences)
