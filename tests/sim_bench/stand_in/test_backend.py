"""The stand-in behind the adapter interface, in lock step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.adapters import JointAdapter, open_adapter
from fricomp.errors import AdapterConfigurationError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.laws import Coulomb, FrictionLaw
from fricomp.sim_bench.stand_in import (
    DEFAULT_LAW,
    NO_DISTURBANCE,
    SimulatedJointAdapter,
    StandIn,
    default_joint,
    packaged_model,
    two_link_arm,
)


def run(adapter: JointAdapter, seconds: float, **command: float) -> list[JointFeedback]:
    """Cycle at 1 kHz with a constant command to every joint; the feedback of every cycle."""
    joints, deadline, log = len(adapter.capabilities.joints), adapter.clock.now_ns(), []
    request = JointCommand(joints)
    for name, value in command.items():
        getattr(request, name)[:] = [value] * joints
    for _ in range(round(seconds * 1000)):
        feedback = JointFeedback(joints)
        adapter.read_into(feedback)
        log.append(feedback)
        assert adapter.write(request), adapter.gate.trip_record
        deadline += 1_000_000
        adapter.clock.sleep_until(deadline)
    return log


def opened(adapter: JointAdapter, mode: str = "torque") -> JointAdapter:
    adapter.open()
    adapter.configure(mode, 1e-3)  # type: ignore[arg-type]
    adapter.enable()
    return adapter


def test_sim_is_a_backend_by_name() -> None:
    adapter = open_adapter("sim")
    assert isinstance(adapter, SimulatedJointAdapter)
    capabilities = adapter.open()
    assert capabilities.simulated
    assert capabilities.joints[0].name == "joint"
    assert capabilities.joints[0].position_quantum == pytest.approx(2.0 * np.pi / 2**18)
    assert capabilities.joints[0].position_limits == (-3.0, 3.0)


def test_time_passes_only_while_the_loop_sleeps() -> None:
    adapter = opened(SimulatedJointAdapter())
    before = adapter.clock.now_ns()
    for _ in range(10):
        adapter.read_into(JointFeedback(1))
        adapter.write(JointCommand(1))
    assert adapter.clock.now_ns() == before
    adapter.clock.sleep_until(before + 2_500_000)
    assert adapter.clock.now_ns() == before + 3_000_000


def test_velocity_command_slides_at_the_commanded_speed_with_the_friction_of_the_law() -> None:
    adapter = opened(SimulatedJointAdapter(), "velocity")
    settled = run(adapter, 2.0, velocity=0.2)[1000:]
    assert np.mean([f.velocity[0] for f in settled]) == pytest.approx(0.2, rel=2e-3)
    offset = 0.005 * 0.175
    assert np.mean([f.torque[0] for f in settled]) == pytest.approx(DEFAULT_LAW.torque(0.2) + offset, rel=3e-3)
    adapter.close()


def test_two_runs_are_equal_to_the_last_bit_and_another_seed_is_not() -> None:
    def torques(seed: int) -> list[float]:
        return [f.torque[0] for f in run(opened(open_adapter("sim", {"seed": seed})), 0.3, torque=0.9)]

    assert torques(4) == torques(4)
    assert torques(4) != torques(5)


def test_feedback_is_as_old_as_the_sensors_delay() -> None:
    adapter = opened(SimulatedJointAdapter())
    adapter.clock.sleep_until(adapter.clock.now_ns() + 5_000_000)
    feedback = JointFeedback(1)
    assert adapter.read_into(feedback)
    assert adapter.clock.now_ns() - feedback.time_ns == 1_000_000
    assert not adapter.read_into(feedback)


def test_both_joints_of_the_arm_are_driven() -> None:
    adapter = opened(open_adapter("sim", {"model": "two_link_arm"}), "position")
    assert [joint.name for joint in adapter.capabilities.joints] == ["shoulder", "elbow"]
    last = run(adapter, 2.0, position=0.5)[-1]
    assert last.position == pytest.approx([0.5, 0.5], abs=0.01)
    adapter.close()
    assert adapter.stand_in.torque != [0.0, 0.0]  # type: ignore[attr-defined]
    adapter.clock.sleep_until(adapter.clock.now_ns() + 1_000_000)
    assert adapter.stand_in.torque == [0.0, 0.0]  # type: ignore[attr-defined]


def test_silence_beyond_the_watchdog_is_a_drive_fault_that_only_the_user_clears() -> None:
    adapter = opened(SimulatedJointAdapter())
    run(adapter, 0.3, torque=0.9)
    adapter.clock.sleep_until(adapter.clock.now_ns() + 200_000_000)
    feedback = JointFeedback(1)
    adapter.read_into(feedback)
    assert feedback.fault == [1]
    assert adapter.gate.tripped
    adapter.clear_faults()
    adapter.enable()
    run(adapter, 0.1, torque=0.1)


def test_external_disturbance_moves_the_arm_and_can_be_switched_off() -> None:
    free = FrictionLaw((Coulomb(0.0),))
    disturbed = StandIn(two_link_arm(laws=(free, free)))
    quiet = StandIn(two_link_arm(laws=(free, free), disturbances=NO_DISTURBANCE))
    for _ in range(300):
        disturbed.step()
        quiet.step()
    assert abs(disturbed.plant.position(0)) > 1e-5
    assert quiet.plant.position(0) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("configuration", "message"),
    [
        ({"modle": "default_joint"}, "modle"),
        ({"joints": [{"name": "knee"}]}, "is called joint, and not 'knee'"),
        (
            {"joints": [{"name": "joint", "servo": {"bandwith": 3.0}}]},
            "servo has no field bandwith; known: torque_limit",
        ),
        ({"joints": [{"name": "joint", "sensor": {"torque_noise": -1.0}}]}, "torque_noise"),
        ({"joints": [{"name": "joint", "normal_load": "heavy"}]}, "normal_load|heavy"),
        ({"model": "missing.xml"}, "missing.xml"),
        ({"model": "missing.xml", "joints": [{"name": "a"}]}, "missing.xml is not a model"),
        ({"period": 0.0}, "period"),
    ],
)
def test_a_wrong_configuration_names_the_key_and_what_is_valid(configuration: dict[str, object], message: str) -> None:
    with pytest.raises(AdapterConfigurationError, match=message):
        open_adapter("sim", configuration)


def test_configuration_reaches_sensors_servo_and_limits() -> None:
    table = {
        "seed": 3,
        "period": 5e-4,
        "joints": [
            {
                "name": "joint",
                "ideal_sensor": True,
                "sensor": {"encoder_counts": 4096},
                "servo": {"torque_limit": 2.0},
                "position": 0.25,
                "limits": {"torque": 1.0, "torque_rate": 50.0, "velocity": 3.0},
            }
        ],
    }
    adapter = open_adapter("sim", table)
    assert isinstance(adapter, SimulatedJointAdapter)
    joint = adapter.stand_in.settings.joints[0]
    assert (joint.sensor.encoder_counts, joint.sensor.delay, joint.servo.torque_limit) == (4096, 0.0, 2.0)
    assert adapter.options.limits[0].torque == 1.0
    assert adapter.stand_in.plant.position(0) == 0.25
    assert adapter.open().highest_rate == pytest.approx(2000.0)


def test_a_friction_model_file_becomes_the_joints_friction(tmp_path: Path) -> None:
    from fricomp.model import FrictionModel, save_model

    law = DEFAULT_LAW.replace({"stribeck.forward.static_torque": 0.9})
    save_model(FrictionModel(law, joint="joint"), tmp_path / "friction.json")
    adapter = open_adapter("sim", {"joints": [{"name": "joint", "friction": str(tmp_path / "friction.json")}]})
    assert isinstance(adapter, SimulatedJointAdapter)
    assert adapter.stand_in.settings.joints[0].law.parameters() == law.parameters()


def test_settings_default_to_the_papers_table_i() -> None:
    expected = (0.15, 0.6, 0.05, 0.02, 2.0), (0.2, 0.7, 0.05, 0.03, 2.0)
    law = default_joint().joints[0].law.parameters()
    names = ("coulomb_torque", "static_torque", "stribeck_velocity", "viscous_coefficient", "stribeck_exponent")
    for side, values in zip(("forward", "reverse"), expected, strict=True):
        assert tuple(law[f"stribeck.{side}.{name}"] for name in names) == values
    assert StandIn(default_joint()).plant.inertias == pytest.approx((0.1,))


def test_a_slide_of_the_model_is_a_linear_joint(tmp_path: Path) -> None:
    model = tmp_path / "slide.xml"
    model.write_text(packaged_model("default_joint").read_text().replace('type="hinge"', 'type="slide"'))
    with open_adapter("sim", {"model": str(model), "joints": [{"name": "joint"}]}) as adapter:
        joint = adapter.capabilities.joints[0]
    assert (joint.motion, joint.torque_unit) == ("linear", "N")


def test_a_model_of_ones_own_without_joints_to_drive_says_which_it_has_and_where_to_name_them(tmp_path: Path) -> None:
    model = tmp_path / "arm.xml"
    model.write_text(
        '<mujoco><worldbody><body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
        '<joint name="elbow" axis="0 1 0"/></body></worldbody></mujoco>'
    )
    with pytest.raises(AdapterConfigurationError, match=r"in the file of --config: .* it has elbow"):
        open_adapter("sim", {"model": str(model)})
