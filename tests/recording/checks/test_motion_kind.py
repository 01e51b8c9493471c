"""What a motion can show is said with figures, and a good one is left alone."""

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording

from ..joint_log import joint_log

_CODES = {"one_way", "held_output", "hand_motion"}


def _kinds(recording: Recording) -> dict[str, str]:
    return {one.code: one.message for one in check_recording(recording) if one.code in _CODES}


@pytest.mark.parametrize("seed", [1, 2])
def test_a_motion_of_both_directions_is_no_special_one(seed: int) -> None:
    assert _kinds(joint_log(20.0, 400.0, seed)) == {}


def test_a_motion_in_one_direction_is_told_as_one() -> None:
    t = np.arange(0.0, 8.0, 2e-3)
    q = 0.4 * t + 0.05 * np.sin(2.0 * t)
    assert set(_kinds(Recording(t, q, 0.5 + 0.2 * np.gradient(q, t)))) == {"one_way"}


@pytest.mark.parametrize(("stiffness", "gap"), [(400.0, 0.03), (1500.0, 0.01)])
def test_a_held_output_shows_its_stiffness_and_its_lost_motion(stiffness: float, gap: float) -> None:
    t = np.arange(0.0, 60.0, 0.01)
    torque = 20.0 * np.sin(2.0 * np.pi * t / 12.0)
    play = np.zeros_like(t)
    for k in range(1, t.size):  # lost motion of which the middle lags behind the torque's sign
        play[k] = np.clip(play[k - 1], torque[k] / 2.0 * gap - gap / 2.0, torque[k] / 2.0 * gap + gap / 2.0)
        play[k] = np.clip(play[k], -gap / 2.0, gap / 2.0)
    noise = np.random.default_rng(0).normal(0.0, 1e-5, t.size)
    said = _kinds(Recording(t, torque / stiffness + play + noise, torque))
    assert set(said) == {"held_output"}
    words = said["held_output"].split()
    assert float(words[words.index("stiffness") + 1]) == pytest.approx(stiffness, rel=0.1)
    assert float(words[words.index("motion", 8) + 1]) == pytest.approx(1e3 * gap, rel=0.3)


def test_a_joint_that_is_moved_by_hand_shows_no_friction() -> None:
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 30.0, 2e-3)
    q = 1.2 * np.sin(2.0 * np.pi * 0.13 * t) + 0.5 * np.sin(2.0 * np.pi * 0.31 * t + 1.0)
    said = _kinds(Recording(t, q, 3.0 * np.sin(q) + rng.normal(0.0, 0.01, t.size)))
    assert set(said) == {"hand_motion"}
    assert "does not say that there is none" in said["hand_motion"]
