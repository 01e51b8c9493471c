"""The joint truly sticks, friction never pushes, and sliding follows the law."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import ParameterError
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    Dahl,
    DwellStiction,
    FrictionLaw,
    LaggedLuGre,
    LaggedStribeck,
    LoadScaling,
    LuGre,
    SmoothedCoulomb,
    Stribeck,
    StribeckCurve,
    Viscous,
)
from fricomp.sim_bench.stand_in import DEFAULT_LAW, NormalLoad, Plant, ThermalSettings, packaged_model

from .hidden_effects import LoadFriction, Ripple, ThinningOil

FORWARD, REVERSE = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03)
BREAKAWAY = {1: 0.60, -1: 0.70}


def default_plant(
    law: FrictionLaw = DEFAULT_LAW,
    *,
    period: float = 1e-3,
    normal_load: NormalLoad = None,
    thermal: ThermalSettings | None = None,
) -> Plant:
    return Plant(
        packaged_model("default_joint"),
        ["joint"],
        [law],
        period=period,
        normal_load=[normal_load],
        thermal=[thermal or ThermalSettings()],
    )


def arm(laws: tuple[FrictionLaw, FrictionLaw] = (DEFAULT_LAW, DEFAULT_LAW)) -> Plant:
    return Plant(packaged_model("two_link_arm"), ["shoulder", "elbow"], laws)


def hold(plant: Plant, torque: list[float], duration: float) -> None:
    for _ in range(round(duration / plant.period)):
        plant.step(torque)


def slide(plant: Plant, velocity: float, duration: float = 1.0) -> None:
    """Bring the joint to a steady velocity with a proportional velocity loop."""
    plant.reset([-1.5 * np.sign(velocity)], [velocity])
    torque = plant.frictions[0].law.torque(velocity)
    for _ in range(round(duration / plant.period)):
        plant.step([float(torque) + 20.0 * (velocity - plant.velocity(0))])


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("period", [2.5e-4, 1e-3, 2e-3])
def test_creeps_below_a_ten_thousandth_rad_per_second_at_90_percent_of_breakaway(direction: int, period: float) -> None:
    plant = default_plant(period=period)
    hold(plant, [0.9 * direction * BREAKAWAY[direction]], 2.0)
    assert abs(plant.velocity(0)) < 1e-5
    assert abs(plant.position(0)) < 1e-5 * 2.0


@pytest.mark.parametrize("direction", [1, -1])
def test_breaks_away_at_the_static_torque_of_its_direction(direction: int) -> None:
    plant = default_plant()
    hold(plant, [0.995 * direction * BREAKAWAY[direction]], 1.0)
    assert abs(plant.velocity(0)) < 1e-5
    hold(plant, [1.005 * direction * BREAKAWAY[direction]], 1.0)
    assert plant.velocity(0) * direction > 1.0


def test_arm_held_by_friction_against_gravity_does_not_creep() -> None:
    plant = arm()
    plant.reset([0.1, -0.05])
    hold(plant, [0.0, 0.0], 2.0)
    assert 0.3 < abs(plant.friction_torque[0]) < 0.6
    assert max(abs(plant.velocity(joint)) for joint in (0, 1)) < 1e-5
    assert abs(plant.position(0) - 0.1) < 1e-5


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_friction_never_pushes_a_joint_in_random_motion(seed: int) -> None:
    generator, plant = np.random.default_rng(seed), default_plant()
    power = []
    for _ in range(500):
        torque = float(generator.normal(scale=1.5)) - 2.0 * plant.position(0)
        for _ in range(20):
            plant.step([torque])
            power.append(-plant.friction_torque[0] * plant.velocity(0))
    assert max(power) < 1e-5
    assert np.convolve(np.array(power) * plant.period, np.ones(10), "valid").max() <= 0.0
    assert min(power) < -0.1


def test_friction_never_pushes_an_arm_in_random_motion() -> None:
    generator, plant = np.random.default_rng(3), arm()
    power = []
    for _ in range(400):
        torque = generator.normal(scale=3.0, size=2).tolist()
        for _ in range(20):
            plant.step(torque)
            power.append([-plant.friction_torque[joint] * plant.velocity(joint) for joint in (0, 1)])
    assert np.max(power) < 1e-5
    for joint in (0, 1):
        assert np.convolve(np.array(power)[:, joint] * 1e-3, np.ones(10), "valid").max() <= 0.0


@pytest.mark.parametrize("velocity", [0.002, 0.01, 0.03, 0.05, 0.1, 1.0, -0.002, -0.03, -0.05, -0.1, -1.0])
def test_steady_sliding_is_on_the_stribeck_curve(velocity: float) -> None:
    plant = default_plant()
    slide(plant, velocity)
    assert plant.velocity(0) == pytest.approx(velocity, rel=1e-3)
    assert plant.friction_torque[0] == pytest.approx(DEFAULT_LAW.torque(plant.velocity(0)), rel=1e-6)


STATIC_LAWS = {
    "coulomb_viscous": FrictionLaw((Coulomb(0.3), Viscous(0.5))),
    "symmetric_stribeck": FrictionLaw((Stribeck(StribeckCurve(0.2, 0.4, 0.1, 0.05, 1.0)),)),
    "tanh": FrictionLaw((SmoothedCoulomb(0.3, 1e-3), Viscous(0.02))),
    "arctan": FrictionLaw((SmoothedCoulomb(0.3, 1e-3, "arctan"),)),
    "very_viscous": FrictionLaw((Viscous(400.0),)),
    "lugre": FrictionLaw((LuGre(FORWARD, REVERSE, 1e4, 5.0),)),
    "dahl": FrictionLaw((Dahl(0.3, 1e4), Viscous(0.02))),
    "lagged_stribeck": FrictionLaw((LaggedStribeck(FORWARD, REVERSE, lag=8e-3),)),
    "lagged_lugre": FrictionLaw((LaggedLuGre(FORWARD, REVERSE, 1e4, 5.0, lag=8e-3),)),
    "dwell": FrictionLaw((BidirectionalStribeck(FORWARD, REVERSE), DwellStiction(0.3, 0.5, 5e-3, 3e-3))),
}


@pytest.mark.parametrize("name", STATIC_LAWS)
@pytest.mark.parametrize("velocity", [0.2, -0.2])
def test_any_law_is_met_in_steady_sliding(name: str, velocity: float) -> None:
    law = STATIC_LAWS[name]
    plant = default_plant(law)
    slide(plant, velocity)
    assert plant.friction_torque[0] == pytest.approx(law.torque(plant.velocity(0)), rel=5e-3)


@pytest.mark.parametrize("direction", [1, -1])
def test_lagging_friction_holds_the_joint_still_and_lets_go_at_its_static_torque(direction: int) -> None:
    plant = default_plant(STATIC_LAWS["lagged_stribeck"])
    hold(plant, [0.995 * direction * BREAKAWAY[direction]], 1.0)
    assert abs(plant.velocity(0)) < 1e-5
    hold(plant, [1.005 * direction * BREAKAWAY[direction]], 1.0)
    assert plant.velocity(0) * direction > 1.0


def test_a_joint_that_has_rested_holds_more_until_it_is_reset() -> None:
    plant, pushed = default_plant(STATIC_LAWS["dwell"]), [0.60 + 0.25]
    hold(plant, [0.0], 3.0)
    hold(plant, pushed, 1.0)
    assert abs(plant.velocity(0)) < 1e-5
    hold(plant, [0.60 + 0.31], 1.0)
    assert plant.velocity(0) > 1.0
    plant.reset([0.0])
    hold(plant, pushed, 0.1)
    assert plant.velocity(0) > 0.1


@pytest.mark.parametrize("name", ["tanh", "arctan", "very_viscous"])
def test_steep_smooth_laws_come_to_rest_without_chatter(name: str) -> None:
    plant = default_plant(STATIC_LAWS[name])
    plant.reset([0.0], [0.5])
    velocities = []
    for _ in range(1000):
        plant.step([0.0])
        velocities.append(plant.velocity(0))
    assert min(velocities) > -1e-9
    assert np.all(np.diff(velocities) <= 1e-12)
    assert velocities[-1] < 1e-3


def test_bristles_give_way_elastically_and_return() -> None:
    plant = default_plant(FrictionLaw((LuGre(FORWARD, REVERSE, sigma_0=1e3, sigma_1=20.0),)))
    hold(plant, [0.2], 2.0)
    # z' = v - |v| z / z_ss integrated over the travel: x = -z_ss ln(1 - z / z_ss) out, z_ss ln(1 + z / z_ss) back.
    out = -0.6e-3 * np.log(1.0 - 0.2 / 0.6)
    assert plant.position(0) == pytest.approx(out, rel=0.02)
    hold(plant, [0.0], 2.0)
    assert plant.position(0) == pytest.approx(out - 0.7e-3 * np.log(1.0 + 0.2 / 0.7), rel=0.05)


def test_stiff_bristles_get_substeps_and_absurd_ones_are_refused() -> None:
    assert default_plant(FrictionLaw((LuGre(FORWARD, REVERSE, 1e3),))).substeps == 1
    assert default_plant(FrictionLaw((LuGre(FORWARD, REVERSE, 1e5),))).substeps > 1
    with pytest.raises(ParameterError, match="too stiff"):
        default_plant(FrictionLaw((LuGre(FORWARD, REVERSE, 1e9),)))


def test_ripple_turns_a_joint_that_sticking_does_not_hold() -> None:
    plant = default_plant(FrictionLaw((Coulomb(0.05), Ripple(0.2, 8.0))))
    plant.reset([0.15])
    hold(plant, [0.0], 3.0)
    assert abs(plant.velocity(0)) < 1e-5
    assert 0.2 * abs(np.sin(8.0 * plant.position(0))) <= 0.05
    assert plant.position(0) != pytest.approx(0.15, abs=0.01)


def test_ripple_is_part_of_the_friction_torque_in_both_directions() -> None:
    for velocity in (0.3, -0.3):
        law = FrictionLaw((BidirectionalStribeck(FORWARD, REVERSE), Ripple(0.05, 8.0)))
        plant = default_plant(law)
        plant.reset([-0.5 * velocity], [velocity])
        for _ in range(800):
            at = plant.position(0)
            plant.step([float(law.torque(velocity, position=at)) + 20.0 * (velocity - plant.velocity(0))])
            expected = law.torque(plant.velocity(0), position=at)
            assert plant.friction_torque[0] == pytest.approx(expected, abs=2e-3)


def test_load_friction_follows_the_gravity_that_the_joint_carries() -> None:
    laws = (FrictionLaw((Coulomb(0.15), LoadFriction(0.1))), DEFAULT_LAW)
    plant = arm(laws)
    plant.reset([0.8, 0.0])
    gravity = 0.8 * 0.0
    for _ in range(3000):
        error = 0.8 - plant.position(0)
        gravity = 4.03 * np.sin(plant.position(0))
        plant.step([gravity + 100.0 * error - 15.0 * plant.velocity(0), -10.0 * plant.position(1)])
    assert plant.load_torque[0] == pytest.approx(gravity, rel=0.15)
    held = plant.load_torque[0]
    plant.step([held + 0.9 * (0.15 + 0.1 * held), 0.0])
    hold(plant, [held + 0.9 * (0.15 + 0.1 * held), 0.0], 0.3)
    assert abs(plant.velocity(0)) < 1e-5
    hold(plant, [held + 1.2 * (0.15 + 0.1 * held), 0.0], 0.3)
    assert plant.velocity(0) > 0.01


@pytest.mark.parametrize(("normal_load", "factor"), [(None, 1.0), (10.0, 1.0), (20.0, 2.0)])
def test_dry_friction_scales_with_a_given_normal_load(normal_load: float | None, factor: float) -> None:
    law = FrictionLaw((BidirectionalStribeck(FORWARD, REVERSE, LoadScaling(1.0, 10.0)),))
    plant = default_plant(law, normal_load=normal_load)
    hold(plant, [0.99 * factor * 0.6], 0.5)
    assert abs(plant.velocity(0)) < 1e-5
    hold(plant, [1.01 * factor * 0.6], 0.5)
    assert plant.velocity(0) > 0.01


def test_friction_warms_the_joint_and_thins_its_oil() -> None:
    law = FrictionLaw((Coulomb(0.1), ThinningOil(0.5, 0.02)))
    plant = default_plant(law, thermal=ThermalSettings(heating=40.0, time_constant=0.5))
    slide(plant, 1.0, 2.5)
    assert plant.temperature[0] > 35.0
    expected = law.torque(plant.velocity(0), temperature=plant.temperature[0])
    assert plant.friction_torque[0] == pytest.approx(expected, rel=1e-3)


def test_sliding_into_an_end_stop_leaves_friction_within_its_level() -> None:
    plant = default_plant()
    plant.reset([2.8], [2.0])
    hold(plant, [2.0], 1.0)
    assert plant.position(0) == pytest.approx(3.0, abs=0.01)
    assert abs(plant.friction_torque[0]) <= 0.7 + 1e-9


def test_arm_obeys_its_equation_of_motion() -> None:
    """M q'' + C q' + G = tau - friction + tau_d, from MuJoCo's inverse dynamics of the bare model."""
    import mujoco

    plant, generator = arm(), np.random.default_rng(5)
    bare = mujoco.MjModel.from_xml_path(str(packaged_model("two_link_arm")))
    state = mujoco.MjData(bare)
    for _ in range(200):
        torque, disturbance = generator.normal(size=2).tolist(), generator.normal(scale=0.1, size=2).tolist()
        state.qpos[:] = [plant.position(0), plant.position(1)]
        state.qvel[:] = before = np.array([plant.velocity(0), plant.velocity(1)])
        plant.step(torque, disturbance)
        state.qacc[:] = (np.array([plant.velocity(0), plant.velocity(1)]) - before) / plant.period
        mujoco.mj_inverse(bare, state)
        expected = np.array(torque) + disturbance - plant.friction_torque
        np.testing.assert_allclose(state.qfrc_inverse, expected, atol=1e-9)


def test_the_model_files_own_friction_damping_and_actuators_are_replaced(tmp_path: Path) -> None:
    file = tmp_path / "motor.xml"
    file.write_text("""<mujoco><worldbody><body>
        <joint name="axis" type="slide" axis="1 0 0" damping="50" frictionloss="9"/>
        <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></worldbody>
        <actuator><position joint="axis" kp="100"/></actuator></mujoco>""")
    plant = Plant(file, ["axis"], [FrictionLaw((Coulomb(1.0),))])
    plant.reset([0.5])
    hold(plant, [3.0], 1.0)
    assert plant.velocity(0) == pytest.approx((3.0 - 1.0) / 2.0, rel=1e-6)


def test_names_the_joints_there_are_when_one_is_unknown() -> None:
    with pytest.raises(ParameterError, match="called shoulder, elbow, and not 'knee'"):
        Plant(packaged_model("two_link_arm"), ["knee"], [DEFAULT_LAW])


def test_refuses_what_is_not_a_model(tmp_path: Path) -> None:
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco><worldbody>")
    for file in (broken, tmp_path / "missing.xml"):
        with pytest.raises(ParameterError, match="not a model"):
            Plant(file, ["joint"], [DEFAULT_LAW])


def test_a_joint_with_several_axes_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "ball.xml"
    file.write_text("""<mujoco><worldbody><body><joint name="hip" type="ball"/>
        <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>""")
    with pytest.raises(ParameterError, match="single axis"):
        Plant(file, ["hip"], [DEFAULT_LAW])
