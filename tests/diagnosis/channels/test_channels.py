"""What two channels show of each other is named whatever the motion allows, and nothing is where they agree."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from fricomp.diagnosis import diagnose
from fricomp.diagnosis.channels.held_output import read_held_output
from fricomp.diagnosis.channels.late_drive import find_late_drive
from fricomp.diagnosis.channels.measured_load import read_measured_load
from fricomp.diagnosis.channels.torque_sensor import compare_torques
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.recording import Recording, RecordingMetadata

_DT = 2e-3


def _command() -> FloatArray:
    kicks = np.random.default_rng(0).standard_normal(6000)
    return np.asarray(lfilter([1.0], [1.0, -1.9, 0.905], kicks), dtype=np.float64)


def _answer(command: FloatArray, late: int) -> Recording:
    torque = np.roll(command, late)
    time = np.arange(torque.size, dtype=np.float64) * np.float64(_DT)
    noise = 0.05 * np.std(torque) * np.random.default_rng(1).standard_normal(torque.size)
    return Recording(time, 0.3 * np.sin(2.0 * time), torque + noise, torque_command=command)


def _clamped(stiffness: float, gap: float, friction: float, stiffening: float = 0.0) -> Recording:
    """A held output that winds up behind friction, for five cycles of ±20 N·m."""
    t = np.arange(0.0, 60.0, 0.01)
    torque = 20.0 * np.sin(2.0 * np.pi * t / 12.0)
    passed = np.zeros_like(t)
    for k in range(1, t.size):
        passed[k] = np.clip(passed[k - 1], torque[k] - friction, torque[k] + friction)
    angle = passed / stiffness * (1.0 - stiffening * (passed / 20.0) ** 2) + 0.5 * gap * np.clip(passed, -1.0, 1.0)
    return Recording(t, angle + np.random.default_rng(0).normal(0.0, 1e-5, t.size), torque)


@pytest.mark.parametrize("late", [6, 10])
def test_a_drive_that_is_late_behind_its_command_is_named_with_its_delay(late: int) -> None:
    found = find_late_drive([_answer(_command(), late)])
    assert found is not None
    assert (found.name, found.kind) == ("torque_delay", "measurement")
    assert found.parameters["delay"].value == pytest.approx(late * _DT, abs=1.5e-3)


@pytest.mark.parametrize("late", [0, 1])
def test_a_drive_that_answers_within_a_cycle_is_not_late(late: int) -> None:
    assert find_late_drive([_answer(_command(), late)]) is None


def test_one_prompt_recording_says_that_the_drive_is_not_late() -> None:
    command = _command()
    assert find_late_drive([_answer(command, 8), _answer(command, 0)]) is None


@pytest.mark.parametrize(("stiffness", "gap", "friction"), [(400.0, 0.03, 1.0), (1500.0, 0.01, 3.0)])
def test_a_held_output_names_elasticity_and_backlash_with_their_sizes(
    stiffness: float, gap: float, friction: float
) -> None:
    diagnosis = diagnose(_clamped(stiffness, gap, friction))
    effects = {one.name: one.parameters for one in diagnosis.effects}
    assert diagnosis.verdict == "missing_physics"
    assert set(effects) == {"joint_elasticity", "backlash"}
    low, high = effects["joint_elasticity"]["stiffness"].ci95
    assert low < stiffness < high
    low, high = effects["backlash"]["gap"].ci95
    assert low < gap < high
    assert any("nothing slides" in one for one in diagnosis.sentences)
    assert diagnosis.base_model is None


@pytest.mark.parametrize("stiffening", [0.0, 0.2])
def test_a_held_output_without_a_gap_names_no_backlash(stiffening: float) -> None:
    names = [one.name for one in read_held_output(_clamped(600.0, 0.0, 2.0, stiffening))]
    assert names == ["joint_elasticity"]


def _beside_a_sensor(gain: float, bend: float) -> Recording:
    t = np.arange(0.0, 60.0, 0.01)
    torque = 8.0 * np.sin(0.9 * t) + 3.0 * np.sin(2.3 * t)
    load = gain * torque - bend * torque**3 + np.random.default_rng(2).normal(0.0, 0.05, t.size)
    return Recording(t, 0.01 * np.sin(3.0 * t), torque, load_torque=load)


def test_a_torque_sensor_names_saturation_and_gain() -> None:
    (saturation,) = compare_torques(_beside_a_sensor(1.0, 2e-3))
    low, high = saturation.parameters["coefficient"].ci95
    assert saturation.name == "torque_saturation"
    assert low < 2e-3 < high
    (gain,) = compare_torques(_beside_a_sensor(0.8, 0.0))
    low, high = gain.parameters["gain_error"].ci95
    assert gain.name == "torque_gain_error"
    assert low < 0.25 < high


def test_a_torque_that_agrees_with_its_sensor_names_nothing() -> None:
    assert compare_torques(_beside_a_sensor(1.0, 0.0)) == ()


def _pressed(grows: float, seed: int, *, slows: float = 0.0) -> list[Recording]:
    """A rod that a bench pushes to and fro against four loads, more slowly under the larger ones."""
    found = []
    for k, load in enumerate((50.0, 150.0, 250.0, 350.0)):
        rng = np.random.default_rng([seed, k])
        t = np.arange(0.0, 40.0, 0.01)
        speed = 0.012 * (1.0 - slows * k)
        q = speed * (2.5 - np.abs(t % 10.0 - 5.0)) + 2e-4 * np.sin(2.0 * t + k)
        pressed = load + rng.normal(0.0, 1.0, t.size)
        friction = (2.0 + grows * load) * np.sign(np.gradient(q)) + 120.0 * np.gradient(q, t)
        torque = 0.7 + pressed + friction + rng.normal(0.0, 0.5, t.size)
        meta = RecordingMetadata(motion="linear", torque_unit="N")
        found.append(Recording(t, q + rng.normal(0.0, 1e-6, t.size), torque, normal_load=pressed, metadata=meta))
    return found


@pytest.mark.parametrize("slows", [0.0, 0.15])
def test_friction_that_grows_with_a_measured_load_is_read_off_several_loads(slows: float) -> None:
    found = diagnose(_pressed(0.03, 1, slows=slows))
    (effect,) = found.effects
    low, high = effect.parameters["coefficient"].ci95
    assert effect.name == "load_coulomb"
    assert low < 0.03 < high < 0.04
    assert any("one offset and one level of friction" in one for one in found.sentences)


@pytest.mark.parametrize(("grows", "files"), [(0.0, 4), (0.03, 1)])
def test_one_load_or_friction_that_does_not_grow_shows_nothing(grows: float, files: int) -> None:
    assert read_measured_load(_pressed(grows, 2, slows=0.15)[:files]) is None
