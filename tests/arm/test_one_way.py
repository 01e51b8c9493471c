"""Joints that never go back: if all do not, nothing can be said of their friction; if some do not, they are listed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import examine_arm
from fricomp.arm.arm_recording import join_joints
from fricomp.errors import RecordingError
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata

from .moving_arm import JOINTS, write_arm

_TIME = np.arange(0.0, 12.0, 0.004)


def _go(joint: str, position: FloatArray) -> Recording:
    torque = np.sign(np.gradient(position, _TIME)) + 0.01 * np.random.default_rng(0).normal(size=_TIME.size)
    return Recording(time=_TIME, position=position, torque=torque, metadata=RecordingMetadata(joint=joint))


def _rise(overshoot: float = 0.0) -> FloatArray:
    share = _TIME / _TIME[-1]
    return np.asarray(share**2 * (3.0 - 2.0 * share) + overshoot * np.sin(np.pi * share) ** 2 * share**8)


def test_a_log_in_which_no_joint_goes_back_is_refused(tmp_path: Path) -> None:
    recordings = [_go(name, (1.0 - 2.0 * (k % 2)) * _rise()) for k, name in enumerate(JOINTS)]
    with pytest.raises(RecordingError, match="one way only: friction is then not told from gravity"):
        examine_arm(recordings, write_arm(tmp_path))


def test_joints_that_hardly_go_back_are_listed() -> None:
    swing = np.sin(0.5 * _TIME)
    found = join_joints([_go("swings", swing), _go("rises", _rise(0.03)), _go("turns", np.abs(swing))])
    assert found.one_way == ("rises",)
