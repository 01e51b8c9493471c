"""Newton metres from a hung weight: on made-up readings, on the stand-in, and through a servo that counts amperes."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.adapters import Transmission, open_adapter
from fricomp.calibration.sweep import SweepContext, SweepSettings
from fricomp.calibration.sweep.motion.log import CycleLog
from fricomp.calibration.sweep.motion.motion import MotionRunner
from fricomp.calibration.sweep.weight import HungWeight, identify_torque_constant, record_passes
from fricomp.cli.main import app
from fricomp.errors import IdentificationError, ParameterError, SweepAborted
from fricomp.joint import CommandMode, JointCommand
from fricomp.recording import Recording, RecordingMetadata
from fricomp.sim_bench.stand_in import SimulatedJointAdapter, default_joint, packaged_model
from fricomp.sim_bench.twins.weight import hang_weight

WEIGHT = HungWeight(0.5, 0.25)
ARM = {"model": "two_link_arm"}


def passes(constant: float, moment: float, n_pairs: int = 3, friction: float = 0.3) -> list[Recording]:
    """Readings [A] of a joint whose friction grows with its load, its own weight hanging obliquely."""
    generator = np.random.default_rng(round(1e6 * moment))
    made = []
    for number in range(2 * n_pairs):
        q = np.linspace(-1.2, 1.5, 2000)[:: 1 if number % 2 == 0 else -1]
        gravity = 0.7 * np.sin(q + 0.2) + moment * np.sin(q - 0.1)
        direction = 1.0 if number % 2 == 0 else -1.0
        torque = gravity + direction * (friction + 0.2 * np.abs(gravity))
        reading = torque / constant + 0.02 + 0.01 * generator.normal(size=len(q))
        metadata = RecordingMetadata(joint="joint", torque_unit="A")
        made.append(Recording(np.linspace(0.0, 4.0, len(q)), q, reading, metadata=metadata))
    return made


@pytest.mark.parametrize("constant", [0.05, 1.78])
def test_a_torque_constant_is_recovered_whatever_the_friction(constant: float) -> None:
    found = identify_torque_constant(passes(constant, 0.0), passes(constant, WEIGHT.moment), WEIGHT)
    assert found.value == pytest.approx(constant, rel=5e-3)
    assert found.unit == "A"
    assert found.added * constant == pytest.approx(WEIGHT.moment, rel=5e-3)


def test_a_weight_that_does_not_show_is_refused() -> None:
    with pytest.raises(IdentificationError, match="axis that is horizontal"):
        identify_torque_constant(passes(1.0, 0.0), passes(1.0, 1e-5), WEIGHT)


def test_one_pass_is_too_few() -> None:
    with pytest.raises(IdentificationError, match="too few"):
        identify_torque_constant(passes(1.0, 0.0, 1), passes(1.0, 1.0, 1), WEIGHT)


@pytest.mark.parametrize(("mass", "lever"), [(0.0, 0.25), (0.5, 0.0), (-1.0, 1.0)])
def test_a_weight_of_nothing_is_refused(mass: float, lever: float) -> None:
    with pytest.raises(ParameterError, match="--weight"):
        HungWeight(mass, lever)


def record(backend: str, table: dict[str, object], tmp_path: Path) -> list[tuple[Recording, ...]]:
    found = []
    for mass in (0.0, WEIGHT.mass):
        changed = hang_weight(backend, table, "elbow", (mass, WEIGHT.lever), tmp_path / f"{mass}.xml")
        with open_adapter(backend, changed) as adapter:
            found.append(record_passes(SweepContext(adapter, 1, SweepSettings()), 2))
            assert not adapter.enabled
    return found


@pytest.mark.slow
def test_a_sensor_that_reads_too_much_is_found_out(tmp_path: Path) -> None:
    joints = [{"name": "shoulder"}, {"name": "elbow", "sensor": {"torque_gain": 1.05}}]
    bare, loaded = record("sim", ARM | {"joints": joints}, tmp_path)
    found = identify_torque_constant(bare, loaded, WEIGHT)
    assert found.unit == "N·m"
    assert found.value == pytest.approx(1.0 / 1.05, rel=2e-3)


def test_behind_a_gear_the_constant_is_that_of_the_drive() -> None:
    found = identify_torque_constant(passes(9.45, 0.0), passes(9.45, WEIGHT.moment), WEIGHT, gear_ratio=3.0)
    assert found.value == pytest.approx(9.45, rel=1e-2)
    gear = Transmission(gear_ratio=3.0)
    # With it the drive's newton metres, which the transmission scales, are those that hang on the joint.
    assert found.at_drive * gear.torque_gain("N·m") == pytest.approx(found.value)


def test_no_loop_is_closed_here_over_a_torque_that_counts_the_other_way(monkeypatch: pytest.MonkeyPatch) -> None:
    largest = 0.0

    def inverted(adapter: SimulatedJointAdapter, command: JointCommand, mode: CommandMode) -> None:
        nonlocal largest
        largest = max(largest, abs(command.torque[0]))
        adapter.stand_in.command([-torque for torque in command.torque], command.velocity, command.position)

    monkeypatch.setattr(SimulatedJointAdapter, "_write", inverted)
    settings = SweepSettings(loop="host", inertia=0.1)
    with SimulatedJointAdapter(default_joint(seed=3)) as adapter:
        with pytest.raises(SweepAborted, match="opposite directions"):
            record_passes(SweepContext(adapter, 0, settings), 2)
        assert not adapter.enabled
        assert largest <= settings.check_torque * adapter.options.limits[0].torque


@pytest.mark.slow
def test_a_joint_that_falls_before_its_signs_are_checked_is_weighed_by_the_loop_on_the_host(tmp_path: Path) -> None:
    """The bar of the default joint on a horizontal axis, let go of at its highest lever."""
    model = tmp_path / "pendulum.xml"
    model.write_text(packaged_model("default_joint").read_text().replace('axis="0 0 1"', 'axis="0 1 0"'))
    table = {"model": str(model), "joints": [{"name": "joint"}]}
    found = []
    for mass in (0.0, WEIGHT.mass):
        changed = hang_weight("sim", table, "joint", (mass, WEIGHT.lever), tmp_path / f"{mass}.xml")
        with open_adapter("sim", changed) as adapter:
            found.append(record_passes(SweepContext(adapter, 0, SweepSettings(loop="host", inertia=0.1)), 2))
    bare, loaded = found
    assert identify_torque_constant(bare, loaded, WEIGHT).value == pytest.approx(1.0, rel=0.01)


def test_a_joint_that_never_comes_to_rest_is_not_pushed(monkeypatch: pytest.MonkeyPatch) -> None:
    def swinging(runner: MotionRunner, duration: float) -> CycleLog:
        log = CycleLog(runner.joint)
        log.position.extend([0.0, 0.1])
        return log

    monkeypatch.setattr(MotionRunner, "watch", swinging)
    with SimulatedJointAdapter(default_joint(seed=3)) as adapter:
        with pytest.raises(SweepAborted, match="come to rest"):
            record_passes(SweepContext(adapter, 0, SweepSettings(loop="host", inertia=0.1)), 2)
        assert not adapter.enabled


def test_another_joint_that_gives_way_is_told(tmp_path: Path) -> None:
    """The soft velocity mode of an MIT motor lets the shoulder sink while the elbow swings its weight."""
    with pytest.raises(SweepAborted, match="lock it"):
        record("twin-mit", {"sim": ARM}, tmp_path)


@pytest.mark.slow
def test_the_command_finds_the_torque_constant_of_a_servo_that_counts_amperes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fricomp.cli.calibration.torque_constant.N_PASSES", 2)
    config = tmp_path / "twin.toml"
    config.write_text('in_amperes = true\n[sim]\nmodel = "two_link_arm"\n')
    arguments = ["calibrate", "--torque-constant", "--weight", "0.5", "--lever", "0.25", "--backend", "twin-dynamixel"]
    arguments += ["--joint", "elbow", "--config", str(config), "--out", str(tmp_path / "run")]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert "torque_constant = 1.7" in result.output
    found = msgspec.json.decode((tmp_path / "run" / "torque_constant.json").read_bytes())
    assert found["unit"] == "A"
    assert found["value"] == pytest.approx(1.78, rel=5e-3)
