"""A loop that was given must explain what the recorded one commanded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.inputs.controller import Controller
from fricomp.diagnosis.inputs.controller_check import check_controller
from fricomp.recording import Recording

_P, _D, _I = 77.0, 4.0, 30.0


@pytest.fixture(scope="module")
def moved() -> Recording:
    """A joint with an encoder of 0.1 mrad behind its reference under a PID loop, which holds 2 N·m of gravity."""
    t = np.linspace(0.0, 7.999, 8000)
    reference, speed = 0.8 * np.sin(1.7 * t), 1.36 * np.cos(1.7 * t)
    late = 0.03 * np.sin(1.7 * t + 0.4) + 0.01 * np.sin(9.0 * t)
    position = np.asarray(1e-4 * np.round((reference - late) / 1e-4), dtype=np.float64)
    error, rate = reference - position, np.gradient(late, t)
    torque = 2.0 + _P * error + _D * rate + _I * np.cumsum(error) * 1e-3
    return Recording(t, position, torque, position_reference=reference, velocity_reference=speed)


@pytest.mark.parametrize("gain", [0.9, 1.0, 1.1])
def test_a_loop_that_is_about_right_is_believed(gain: float, moved: Recording) -> None:
    assert check_controller(Controller(gain * _P, gain * _D, gain * _I), [moved]) == []


@pytest.mark.parametrize(("gain", "says"), [(3.0, "explains only 7% of"), (-77.0, "explains nothing of")])
def test_a_wrong_gain_is_told_beside_that_of_the_recording(gain: float, says: str, moved: Recording) -> None:
    (said,) = check_controller(Controller(gain), [moved])
    assert f"proportional {gain:.4g} N·m/rad) {says}" in said
    assert "proportional 7" in said.partition("and one with ")[2]
    assert "--controller" in said


def test_a_torque_of_no_loop_speaks_against_any(moved: Recording) -> None:
    noise = replace(moved, torque=np.random.default_rng(0).standard_normal(len(moved)))
    (said,) = check_controller(Controller(_P, _D), [noise])
    assert "no PD or PID loop does" in said


def test_nothing_is_said_without_a_reference_and_each_recording_has_its_own(moved: Recording) -> None:
    assert check_controller(Controller(3.0), [replace(moved, position_reference=None)]) == []
    (said,) = check_controller(Controller(_P, _D, _I), [moved, replace(moved, torque=3.0 * np.asarray(moved.torque))])
    assert said.startswith("recording 2: ")
