"""The closed-loop plant: physics that must hold with and without effects."""

import numpy as np
import pytest

from fricomp.sim_bench.cases.dynamics import Motion, simulate
from fricomp.sim_bench.cases.excitation import EXCITATIONS, build_reference
from fricomp.sim_bench.cases.joint import Joint, draw_joint
from fricomp.sim_bench.cases.plant import CORES, NEUTRAL, build_plant
from fricomp.sim_bench.cases.sensing import Sensors, distort_torque, lag_signal


def _run(joint: Joint, excitation: str = "rich", duration: float = 12.0, **fields: float) -> Motion:
    reference = build_reference(excitation, duration, joint.speed, np.random.default_rng(1))
    outside = np.zeros((reference.shape[0], 3))
    outside[:, 1], outside[:, 2] = 25.0, 1.0
    return simulate(build_plant({**joint.fields, **fields}), reference, outside, joint.shares)


@pytest.mark.parametrize("core", CORES)
@pytest.mark.parametrize("family", ["harmonic", "quasi_direct"])
def test_without_effects_the_rigid_joint_explains_the_torque(core: str, family: str) -> None:
    joint = draw_joint(np.random.default_rng(5), family, core)
    motion = _run(joint)
    assert np.abs(motion.concealed).max() < 1e-6 * np.abs(motion.torque).max()


@pytest.mark.parametrize("core", CORES)
def test_the_loop_follows_its_reference(core: str) -> None:
    joint = draw_joint(np.random.default_rng(2), "harmonic", core)
    reference = build_reference("fourier", 12.0, joint.speed, np.random.default_rng(1))
    motion = _run(joint, "fourier")
    assert np.abs(motion.position - reference[:, 0]).max() < 0.2


def test_a_cogging_torque_comes_out_as_the_concealed_torque() -> None:
    joint = draw_joint(np.random.default_rng(3), "harmonic", "lugre")
    motion = _run(joint, cogging=0.8, cogging_order=50.0, cogging_phase=0.3)
    expected = 0.8 * np.sin(50.0 * motion.position + 0.3)
    slow = np.abs(motion.velocity) < 0.5
    assert np.sqrt(np.mean((motion.concealed - expected)[slow] ** 2)) < 0.01 * 0.8


def test_a_load_dependent_level_comes_out_as_the_concealed_torque() -> None:
    joint = draw_joint(np.random.default_rng(3), "harmonic", "dahl")
    motion = _run(joint, load_coulomb=0.1)
    steady = np.abs(motion.velocity) > 0.1
    residual = motion.concealed - 0.1 * np.abs(motion.load) * motion.sense
    assert np.std(residual[steady]) < 0.05 * np.std(motion.concealed[steady])


def test_a_joint_with_stiction_rests_where_gravity_cannot_move_it() -> None:
    joint = draw_joint(np.random.default_rng(3), "harmonic", "set_valued")
    motion = _run(joint, gravity=0.5 * joint.fields["coulomb_forward"])
    assert np.all(motion.velocity[:1000] == 0.0)


def test_elasticity_approaches_the_rigid_joint_as_it_stiffens() -> None:
    joint = draw_joint(np.random.default_rng(7), "harmonic", "dahl")
    rms = []
    for frequency in (100.0, 200.0, 400.0):
        stiffness = frequency**2 * joint.fields["inertia"]
        damping = 0.06 * np.sqrt(stiffness * joint.fields["inertia"])
        motion = _run(joint, "fourier", flexible=1.0, stiffness=stiffness, spring_damping=damping)
        rms.append(np.std(motion.concealed))
    assert rms[0] > 1.5 * rms[1] > 2.0 * rms[2]


def test_energy_is_only_lost_in_friction() -> None:
    """Power of the drive = change of kinetic and potential energy + what friction takes, which is never negative."""
    joint = draw_joint(np.random.default_rng(9), "quasi_direct", "dahl")
    motion = _run(joint, "fourier")
    f = joint.fields
    friction = (
        motion.torque - f["inertia"] * motion.acceleration - f["gravity"] * np.sin(motion.position + f["gravity_angle"])
    )
    power = friction * motion.velocity
    assert power[np.abs(motion.velocity) > 0.02].min() > 0.0


def test_an_unknown_field_of_the_plant_is_an_error() -> None:
    with pytest.raises(KeyError, match="stickiness"):
        build_plant({"stickiness": 1.0})


def test_neutral_values_switch_every_effect_off() -> None:
    joint = draw_joint(np.random.default_rng(5), "harmonic", "gms")
    plain = _run(joint, "rich", 6.0)
    neutral = {name: value for name, value in NEUTRAL.items() if name not in joint.fields}
    explicit = _run(joint, "rich", 6.0, **neutral)
    assert np.array_equal(plain.torque, explicit.torque)


@pytest.mark.parametrize("kind", EXCITATIONS)
def test_a_motion_is_smooth_and_no_faster_than_allowed(kind: str) -> None:
    reference = build_reference(kind, 30.0, 1.5, np.random.default_rng(4))
    acceleration = np.gradient(reference[:, 1], 1e-3)
    assert np.abs(reference[:, 1]).max() <= 1.5 * 1.001
    assert np.abs(acceleration).max() < 35.0
    assert np.abs(reference[:, 0] - np.mean([reference[:, 0].min(), reference[:, 0].max()])).max() < np.pi
    assert np.allclose(np.gradient(reference[:, 0], 1e-3)[50:-50], reference[50:-50, 1], atol=0.02)


def test_a_lagging_channel_is_late_by_its_time_constant() -> None:
    time = np.arange(4000, dtype=np.float64) * 1e-3
    for constant in (2e-4, 3e-3, 2e-2):
        ramp = lag_signal(np.asarray(2.0 * time, dtype=np.float64), constant)
        assert ramp[-1] == pytest.approx(2.0 * (time[-1] - constant), rel=1e-9)


def test_a_delayed_torque_is_late_by_any_fraction_of_a_sample() -> None:
    time = 1e-3 * np.arange(2000)
    seen = distort_torque(np.sin(9.0 * time), Sensors("white", 0.0, delay=3.4e-3))
    assert np.allclose(seen[20:], np.sin(9.0 * (time[20:] - 3.4e-3)), atol=1e-8)


@pytest.mark.parametrize("form", [0.0, 1.0])
def test_a_torque_cell_with_a_loop_takes_another_way_back(form: float) -> None:
    time = np.arange(4000, dtype=np.float64) * 1e-3
    torque = 10.0 * np.sin(2.0 * np.pi * 0.5 * time)
    sensors = Sensors("white", 0.0, hysteresis=0.1, hysteresis_width=3.0, hysteresis_form=form)
    seen = distort_torque(torque, sensors)
    up, down = (np.interp(0.0, *pair) for pair in _crossings(torque, seen))
    assert up - down == pytest.approx(-2.0 * 0.1 * 3.0, rel=0.15)


def _crossings(torque: np.ndarray, seen: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Torque and reading on the way up through zero and on the way down, once the loop is closed."""
    rising, falling = slice(1600, 2400), slice(2600, 3400)
    return [(torque[rising], seen[rising]), (torque[falling][::-1], seen[falling][::-1])]
