"""The loop of a forward simulation answers at its rate and holds its torque."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.forward.forward_joint import Run
from fricomp.diagnosis.forward.forward_loop import Drive, Loop
from fricomp.diagnosis.inputs.controller import Controller
from fricomp.diagnosis.inputs.track import Track
from fricomp.diagnosis.joint.observer import Plant

_STEP = 2e-4
_TRACK = Track.build(1e-3, np.linspace(0.0, 0.1, 200), np.full(200, 3.0))
_REFERENCE = np.stack([np.linspace(0.01, 0.11, 200), np.full(200, 0.5)])


def test_a_loop_holds_its_torque_until_it_answers_again() -> None:
    loop = Loop(Controller(100.0, frequency=500.0), _TRACK, _REFERENCE, 0, _STEP)
    answers = [loop.compute_torque(step // 5, 1e-3 * step) for step in range(20)]
    assert answers[:10] == [pytest.approx(1.0)] * 10
    assert answers[10:] == [pytest.approx(100.0 * (_REFERENCE[0, 2] - 0.01))] * 10


def test_a_loop_of_no_known_rate_answers_in_every_step_and_sees_the_velocity() -> None:
    loop = Loop(Controller(0.0, 2.0), _TRACK, _REFERENCE, 0, _STEP)
    loop.compute_torque(0, 0.0)
    assert loop.compute_torque(0, 0.3 * _STEP) == pytest.approx(2.0 * (0.5 - 0.3))


def test_an_integral_begins_where_the_recorded_torque_is_and_stops_at_the_limit() -> None:
    gains = Controller(100.0, 2.0, 50.0, frequency=1000.0, torque_limit=3.5)
    loop = Loop(gains, _TRACK, _REFERENCE, 100, _STEP)
    assert loop.compute_torque(100, float(_TRACK.position[100])) == pytest.approx(3.0, abs=1e-2)
    assert Loop(gains, _TRACK, _REFERENCE, 100, _STEP).compute_torque(100, -1.0) == 3.5


def test_an_integral_begins_there_too_where_the_other_parts_alone_pass_the_limit() -> None:
    gains = Controller(1000.0, 0.0, 50.0, frequency=1000.0, torque_limit=5.0)
    loop = Loop(gains, _TRACK, _REFERENCE, 100, _STEP)
    assert loop.compute_torque(100, float(_TRACK.position[100])) == pytest.approx(3.0, abs=1e-2)


@pytest.mark.parametrize(
    ("frequency", "substeps"), [(None, 5), (500.0, 5), (1000.0, 5), (3000.0, 6), (4000.0, 8), (1e4, 10), (5e4, 10)]
)
def test_a_loop_answers_after_a_whole_number_of_steps(frequency: float | None, substeps: int) -> None:
    plant = Plant(0.3, (0.0, 0.0), 0.0, (2.0, 2.0, 0.05, 1.0), (2.0, 2.0, 0.05, 1.0), 1e9)
    run = Run(plant, _TRACK, _REFERENCE, Controller(100.0, frequency=frequency), 0, 200)
    assert run.substeps == substeps


def test_a_drive_follows_its_command_through_its_low_passes() -> None:
    drive = Drive((0.01,), 0.0, _STEP)
    torque = [drive.follow(1.0) for _ in range(50)]
    np.testing.assert_allclose(torque, 1.0 - np.exp(-np.arange(1, 51) * _STEP / 0.01))
    assert Drive((), 0.0, _STEP).follow(2.0) == 2.0
