"""Joints that MuJoCo makes: their torque is what inverse dynamics and friction by hand ask for."""

from collections.abc import Callable
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from fricomp.errors import DiagnosisError
from fricomp.sim_bench.studies.second_generator.effects import EFFECTS
from fricomp.sim_bench.studies.second_generator.hidden import Hidden
from fricomp.sim_bench.studies.second_generator.joint import PLAIN, write_mjcf
from fricomp.sim_bench.studies.second_generator.motion import MOTIONS, make_motion
from fricomp.sim_bench.studies.second_generator.record import FILTER_LAG, NOISE, RESOLUTION, Run, sense, simulate

_INERTIA = 4.0 * 0.22**2 + 0.02 + 0.15  # [kg·m²]
_GRAVITY = 4.0 * 9.81 * 0.22  # [N·m]
_MODELLING = 0.008  # [N·m] of samples of 1 ms whose position and speed are those at their start


def _asked(run: Run) -> np.ndarray:
    """Torque of the plain joint along the true motion [N·m]."""
    q, v = run.position, run.velocity
    friction = np.sign(v) * (2.0 + 0.5 * np.exp(-((v / 0.06) ** 2))) + 1.2 * v
    return _INERTIA * run.acceleration + _GRAVITY * np.sin(q) + friction


def _moved(name: str, kind: str = "fourier", duration: float = 8.0) -> tuple[Hidden, Run]:
    motion = make_motion(kind, duration, 4)
    hidden = EFFECTS[name].build(motion)
    return hidden, simulate(hidden, motion)


_EXTRA: dict[str, Callable[[Run], np.ndarray]] = {
    "nothing": lambda run: np.zeros_like(run.position),
    "spring_torque": lambda run: run.position - 0.17,
    "quadratic_drag": lambda run: 0.8 * run.velocity * np.abs(run.velocity),
    "power_law_viscous": lambda run: 1.2 * (np.sign(run.velocity) * np.abs(run.velocity) ** 0.6 - run.velocity),
    "payload_error": lambda run: 0.4 * 0.4 * 9.81 * np.sin(run.position) + 0.065 * run.acceleration,
    "inertia_error": lambda run: 0.1 * run.acceleration,
    "torque_gain_error": lambda run: (1.0 - 0.94) * run.command,
    "load_coulomb": lambda run: 0.1 * np.abs(_GRAVITY * np.sin(run.position)) * np.sign(run.velocity),
    "cogging": lambda run: 0.25 * np.sin(18.0 * run.position + 1.0),
    "torque_offset": lambda run: np.full_like(run.position, -0.5),
}


@pytest.mark.parametrize("name", sorted(_EXTRA))
def test_the_recorded_torque_is_inverse_dynamics_friction_and_the_effect_within_the_noise(name: str) -> None:
    hidden, run = _moved(name)
    sliding = np.abs(run.velocity) > 0.05
    left = (sense(run, hidden, 4).torque - _asked(run) - _EXTRA[name](run))[sliding]
    assert np.sum(sliding) > 5000
    assert abs(np.mean(left)) < 4.0 * NOISE / np.sqrt(left.size) + 0.25 * _MODELLING
    assert np.std(left) == pytest.approx(NOISE, abs=0.05 * NOISE + _MODELLING**2 / NOISE)


def test_the_link_behind_a_spring_moves_as_its_equation_says() -> None:
    hidden, run = _moved("joint_elasticity")
    stiffness, load = hidden.truth["stiffness"], hidden.truth["load_share"] * _INERTIA
    damping = 2.0 * hidden.truth["damping_ratio"] * np.sqrt(stiffness * load)
    angle, speed, steps, carried = 0.0, 0.0, 4, np.zeros(run.position.size)
    for k in range(run.position.size - 1):
        for share in (np.arange(steps) + 0.5) / steps:
            q, v = (x[k] + share * (x[k + 1] - x[k]) for x in (run.position, run.velocity))
            torque = stiffness * (q - angle) + damping * (v - speed)
            speed += 1e-3 / steps * (torque - _GRAVITY * np.sin(angle)) / load
            angle += 1e-3 / steps * speed
            carried[k] += torque / steps
    rigid = load * run.acceleration + _GRAVITY * np.sin(run.position)
    left = (run.command - _asked(run) + rigid - carried)[:-1][np.abs(run.velocity[:-1]) > 0.05]
    assert np.sqrt(np.mean(left**2)) < _MODELLING
    assert np.std(carried - rigid) > 20.0 * _MODELLING


def test_the_commanded_torque_without_noise_is_inverse_dynamics_and_friction() -> None:
    _, run = _moved("nothing")
    left = (run.command - _asked(run))[np.abs(run.velocity) > 0.05]
    assert np.sqrt(np.mean(left**2)) < _MODELLING


def test_a_joint_at_rest_sticks() -> None:
    motion = make_motion("rich", 10.0, 4)
    run = simulate(Hidden(), motion)
    resting = np.convolve(np.abs(motion.velocity) < 1e-9, np.ones(300), "same") == 300
    assert np.sum(resting) > 300
    assert np.max(np.abs(run.velocity[resting])) < 5e-3
    assert np.std(run.command[resting]) > 0.0


def test_a_stop_and_a_force_range_act_at_the_end_only() -> None:
    hidden, stopped = _moved("end_stop")
    beyond = stopped.position > hidden.truth["edge"]
    assert 0.0 < np.mean(beyond) < 0.2
    free = ~np.convolve(beyond, np.ones(101), "same").astype(bool) & (np.abs(stopped.velocity) > 0.05)
    assert np.std((stopped.command - _asked(stopped))[free]) < _MODELLING
    _, saturated = _moved("torque_saturation")
    short = np.abs(saturated.command - _asked(saturated)) > 0.2
    assert 0.0 < np.mean(short & (np.abs(saturated.velocity) > 0.05)) < 0.1


@pytest.mark.parametrize("name", sorted(set(EFFECTS) - {"nothing", "torque_delay"}))
def test_each_effect_changes_what_the_loop_commands(name: str) -> None:
    hidden, run = _moved(name, "rich", 4.0)
    plain = simulate(Hidden(), run.motion)
    assert all(np.all(np.isfinite(values)) for values in (run.position, run.command, run.acceleration))
    assert np.max(np.abs(run.command - plain.command)) > 1e-3
    assert hidden != Hidden()


def test_the_torque_may_be_recorded_late() -> None:
    hidden, run = _moved("torque_delay", duration=2.0)
    late, prompt = sense(run, hidden, 3).torque, sense(run, replace(hidden, torque_delay=0), 3).torque
    noise = prompt - run.command
    np.testing.assert_allclose((late - noise)[4:], run.command[:-4], atol=1e-12)


def test_encoder_and_velocity_are_those_of_the_loop() -> None:
    hidden, run = _moved("nothing")
    recording = sense(run, hidden, 3)
    np.testing.assert_allclose(recording.position / RESOLUTION, np.round(recording.position / RESOLUTION), atol=1e-6)
    assert np.max(np.abs(recording.position - run.position)) < 0.51 * RESOLUTION
    assert recording.velocity is not None
    late = np.interp(run.motion.time - FILTER_LAG, run.motion.time, run.velocity)
    assert np.std((recording.velocity - late)[1000:]) < 0.01
    assert sense(run, hidden, 3, velocity=False).velocity is None


@pytest.mark.parametrize("kind", sorted(MOTIONS))
def test_a_seed_gives_one_recording_and_another_seed_another(kind: str) -> None:
    first, again, other = (make_motion(kind, 2.0, seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first.position, again.position)
    assert np.max(np.abs(first.position - other.position)) > 0.01
    one, two, three = (
        sense(simulate(Hidden(), motion), Hidden(), seed) for motion, seed in ((first, 5), (again, 5), (first, 6))
    )
    assert one.content_hash == two.content_hash
    assert one.content_hash != three.content_hash


def test_the_simulation_is_the_plain_joint() -> None:
    model = mujoco.MjModel.from_xml_string(write_mjcf(PLAIN, 1e-3, sticks=False))
    data = mujoco.MjData(model)
    data.qpos[0], data.qacc[0] = 0.7, 2.0
    mujoco.mj_inverse(model, data)
    inertial = data.qfrc_inverse[0] + data.qfrc_constraint[0]
    assert inertial == pytest.approx(2.0 * _INERTIA + _GRAVITY * np.sin(0.7), rel=1e-9)
    assert (model.dof_frictionloss[0], model.dof_damping[0]) == (2.0, 1.2)
    assert model.jnt_stiffness[0] == 0.0


def test_an_unknown_motion_is_answered_with_the_valid_ones() -> None:
    with pytest.raises(DiagnosisError, match="no motion 'sine': valid are rich, fourier"):
        make_motion("sine", 1.0, 0)
