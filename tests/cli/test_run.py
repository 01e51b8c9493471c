"""`fricomp run` with options that would divide by zero or move nothing."""

import json
import math
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

from fricomp.adapters import AdapterOptions
from fricomp.cli.main import app
from fricomp.cli.sine_loop import add_breakaway
from fricomp.control import JointLimits, ReferenceState, SineReference
from fricomp.errors import AdapterConfigurationError, AdapterError, ParameterError, SafetyTrip
from fricomp.joint import CommandMode
from fricomp.laws import Cogging, FrictionLaw, Stribeck, StribeckCurve, Viscous
from fricomp.model import FrictionModel, Provenance, Validity, save_model
from fricomp.recording import read_recording
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.stand_in import SimulatedJointAdapter


@pytest.fixture
def model(tmp_path: Path) -> Path:
    file = tmp_path / "friction.json"
    save_model(FrictionModel(FrictionLaw((Viscous(0.02),)), joint="joint"), file)
    return file


@pytest.mark.parametrize("command", ["run", "calibrate"])
@pytest.mark.parametrize("named", ["", 'backend = "sim"\n'])
def test_a_file_of_the_simulated_joint_serves_both_commands(
    tmp_path: Path, model: Path, command: str, named: str
) -> None:
    file = tmp_path / "joint.toml"
    file.write_text(f"{named}seed = 3\n")
    short = [str(model), "--frequency", "4", "--cycles", "1", "--amplitude", "0.01", "--out", str(tmp_path / "run")]
    arguments = short if command == "run" else ["--dry-run"]
    result = CliRunner().invoke(app, [command, *arguments, "--config", str(file)])
    assert result.exit_code == 0, result.output


@pytest.mark.parametrize("command", ["run", "calibrate"])
def test_a_file_of_another_backend_than_the_one_asked_for_is_refused(tmp_path: Path, model: Path, command: str) -> None:
    file = tmp_path / "drive.toml"
    file.write_text('backend = "canopen"\n')
    arguments = [str(model), "--out", str(tmp_path / "run")] if command == "run" else ["--dry-run"]
    result = CliRunner().invoke(app, [command, *arguments, "--backend", "mit", "--config", str(file)])
    assert isinstance(result.exception, AdapterConfigurationError), result.output
    assert "'canopen', but 'mit'" in str(result.exception)


@pytest.mark.parametrize("command", ["run", "calibrate"])
def test_the_file_of_a_drive_says_which_it_is(tmp_path: Path, model: Path, command: str) -> None:
    file = tmp_path / "drive.toml"
    file.write_text('backend = "canopne"\n')
    arguments = [str(model), "--out", str(tmp_path / "run")] if command == "run" else ["--dry-run"]
    result = CliRunner().invoke(app, [command, *arguments, "--config", str(file)])
    assert "unknown backend 'canopne'" in str(result.exception)


def run_and_see_limits(model: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> float | None:
    """The breakaway limit that the gate of `fricomp run` gets."""
    seen: list[float | None] = []
    configure = SimulatedJointAdapter._configure

    def noting(self: SimulatedJointAdapter, mode: CommandMode, period: float) -> None:
        seen.append(self._checked_options.limits[0].breakaway)
        configure(self, mode, period)

    monkeypatch.setattr(SimulatedJointAdapter, "_configure", noting)
    short = ["--frequency", "4", "--cycles", "1", "--amplitude", "0.01", "--out", str(out)]
    result = CliRunner().invoke(app, ["run", str(model), *short])
    assert result.exit_code == 0, f"{result.output} {result.exception}"
    assert len(set(seen)) == 1
    return seen[0]


def test_the_gate_gets_the_breakaway_torque_of_the_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "friction.json"
    law = FrictionLaw((Stribeck(StribeckCurve(0.4, 0.8, 0.05, 3.0)), Cogging(0.1, 0.0, 6)))
    save_model(FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0)), joint="joint"), file)
    found = run_and_see_limits(file, tmp_path / "run", monkeypatch)
    assert found == pytest.approx(1.5 * (0.8 + 0.1), rel=1e-6)


def test_a_model_without_static_friction_leaves_the_gate_as_it_is(
    model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run_and_see_limits(model, tmp_path / "run", monkeypatch) is None


def test_a_model_of_another_joint_is_told_as_what_stops_a_run(tmp_path: Path) -> None:
    file = tmp_path / "friction.json"
    law = FrictionLaw((Stribeck(StribeckCurve(0.02, 0.03, 0.05, 0.01)),))
    save_model(FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0)), joint="wrist"), file)
    result = CliRunner().invoke(app, ["run", str(file), "--cycles", "1", "--out", str(tmp_path / "run")])
    assert isinstance(result.exception, SafetyTrip), result.output
    assert "frozen" in str(result.exception)
    assert "0.045 of joint" in str(result.exception)
    assert "by the model of 'wrist'" in str(result.exception)


def test_a_breakaway_limit_that_is_configured_stays() -> None:
    limits = (JointLimits(5.0, 250.0, 8.0, breakaway=2.5), JointLimits(5.0, 250.0, 8.0), JointLimits(5.0, 250.0, 8.0))
    joints = [SimpleNamespace(torque_unit=unit) for unit in ("N·m", "N·m", "A")]
    adapter: Any = SimpleNamespace(options=AdapterOptions(limits=limits), capabilities=SimpleNamespace(joints=joints))
    friction = FrictionModel(FrictionLaw((Stribeck(StribeckCurve(0.4, 0.8, 0.05, 3.0)),)))
    found = add_breakaway(adapter, [friction] * 3).limits
    assert [limit.breakaway for limit in found] == [2.5, pytest.approx(1.2), None]


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--rate", "0", "above 0"),
        ("--frequency", "0", "above 0"),
        ("--frequency", "nan", "above 0"),
        ("--cycles", "-1", "above 0"),
        ("--amplitude", "0", "above 0"),
        ("--inertia", "0", "above 0"),
        ("--bandwidth", "inf", "finite"),
        ("--delay", "-0.001", "at least 0"),
        ("--velocity-filter", "nan", "at least 0"),
    ],
)
def test_an_option_outside_its_range_is_refused_with_its_name(
    tmp_path: Path, option: str, value: str, words: str
) -> None:
    out = tmp_path / "run"
    result = CliRunner().invoke(app, ["run", str(tmp_path / "friction.json"), option, value, "--out", str(out)])
    assert isinstance(result.exception, ParameterError), result.output
    assert str(result.exception).startswith(option)
    assert words in str(result.exception)
    assert not out.exists()


def test_ctrl_c_keeps_what_was_recorded(tmp_path: Path, model: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = SineReference.sample

    def interrupted(self: SineReference, time: float, state: ReferenceState) -> None:
        if time > 0.6:
            raise KeyboardInterrupt
        whole(self, time, state)

    monkeypatch.setattr(SineReference, "sample", interrupted)
    out = tmp_path / "run"
    log = tmp_path / "run.mcap"
    result = CliRunner().invoke(app, ["run", str(model), "--out", str(out), "--log", str(log)])
    assert result.exit_code == 130
    assert "the joints are at zero torque" in result.output
    kept = read_recording(out / "without_compensation_joint.csv")
    assert kept.duration == pytest.approx(0.6, abs=0.01)
    (logged,) = read_named_log(log).recordings
    assert logged.position == pytest.approx(kept.position)


def test_ctrl_c_claims_no_zero_torque_where_the_stop_did_not_get_through(
    tmp_path: Path, model: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(self: SineReference, time: float, state: ReferenceState) -> None:
        raise KeyboardInterrupt

    def dead(adapter: SimulatedJointAdapter) -> None:
        raise AdapterError("the bus is off")

    monkeypatch.setattr(SineReference, "sample", interrupted)
    monkeypatch.setattr(SimulatedJointAdapter, "_stop", dead)
    result = CliRunner().invoke(app, ["run", str(model), "--out", str(tmp_path / "run")])
    assert isinstance(result.exception, AdapterError), result.output
    assert "the bus is off: cut the power" in str(result.exception)
    assert "zero torque" not in result.output


def test_a_joint_that_is_stopped_by_the_gate_leaves_its_recording(tmp_path: Path, model: Path) -> None:
    file, out = tmp_path / "joint.toml", tmp_path / "run"
    limits = "limits = { torque = 4.0, torque_rate = 200.0, velocity = 0.02 }"
    file.write_text(f'[[joints]]\nname = "joint"\n{limits}\n')
    result = CliRunner().invoke(app, ["run", str(model), "--config", str(file), "--out", str(out)])
    assert isinstance(result.exception, SafetyTrip), result.output
    recording = read_recording(out / "without_compensation_joint.csv")
    assert recording.duration > 0.5
    assert recording.metadata.encoder_resolution == pytest.approx(2.0 * math.pi / 2**18)
    assert recording.metadata.source == "fricomp run"


@pytest.mark.parametrize(("limits", "words"), [((-0.3, 0.2), "moved to -0.4"), ((-0.2, 0.3), "moved to 0.4")])
def test_a_motion_that_would_leave_the_configured_range_is_refused_before_the_joint_is_energised(
    tmp_path: Path, model: Path, limits: tuple[float, float], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "joint.toml"
    joint = '[[joints]]\nname = "joint"\n[joints.limits]\ntorque = 2.0\ntorque_rate = 100.0\nvelocity = 10.0\n'
    file.write_text(f"{joint}position = [{limits[0]}, {limits[1]}]\n")
    enabled: list[SimulatedJointAdapter] = []
    monkeypatch.setattr(SimulatedJointAdapter, "_enable", enabled.append)
    options = ["--amplitude", "0.2", "--config", str(file), "--out", str(tmp_path / "run")]
    result = CliRunner().invoke(app, ["run", str(model), *options])
    assert isinstance(result.exception, ParameterError), result.output
    assert words in str(result.exception)
    assert not enabled


def test_a_run_is_shown_live_and_says_where(tmp_path: Path, model: Path) -> None:
    short = ["--frequency", "4", "--cycles", "1", "--amplitude", "0.01", "--out", str(tmp_path / "run")]
    result = CliRunner().invoke(app, ["run", str(model), *short, "--live", "--json"])
    assert result.exit_code == 0, result.output
    assert re.search(r"Live page, with a stop: http://127\.0\.0\.1:\d+/[\w-]{20,}/\n", result.stderr)
    answer = json.loads(result.stdout)
    assert answer["joints"] == ["joint"]
    assert answer["with"]["rms_error"][0] > 0.0
    assert "RMS tracking error" in (tmp_path / "run" / "run.html").read_text()


def test_the_log_of_a_run_is_read_by_its_library_and_by_convert(tmp_path: Path, model: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    log = tmp_path / "run.mcap"
    short = ["--frequency", "4", "--cycles", "1", "--amplitude", "0.01", "--out", str(tmp_path / "run")]
    result = CliRunner().invoke(app, ["run", str(model), *short, "--log", str(log)])
    assert result.exit_code == 0, result.output
    with log.open("rb") as stream:
        messages = [
            (schema, channel, json.loads(m.data)) for schema, channel, m in reader.make_reader(stream).iter_messages()
        ]
    assert len(messages) == 1500
    schema, channel, last = messages[-1]
    assert (channel.topic, schema.encoding) == ("/joint_states", "jsonschema")
    described = json.loads(schema.data)["properties"]["joint"]["properties"]
    assert (described["torque"]["description"], described["velocity"]["description"]) == ("[N·m]", "[rad/s]")
    assert last["joint"]["model"] == pytest.approx(0.02 * last["joint"]["velocity"])
    assert last["joint"]["residual"] == pytest.approx(last["joint"]["torque"] - last["joint"]["model"])
    again = CliRunner().invoke(
        app, ["convert", str(log), "--to", "0.7", "--out", str(tmp_path / "back.csv"), "--force"]
    )
    assert again.exit_code == 0, again.output
    back, kept = (
        read_recording(tmp_path / "back.csv"),
        read_recording(tmp_path / "run" / "without_compensation_joint.csv"),
    )
    assert back.position == pytest.approx(kept.position[: len(back)], abs=1e-9)
    assert len(back) == 700
    refused = CliRunner().invoke(app, ["run", str(model), *short, "--overwrite", "--log", str(tmp_path / "run.bag")])
    assert "ends in .mcap" in str(refused.exception)


def test_a_model_that_is_not_usable_moves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "friction.json"
    doubted = Provenance(status="not_identifiable", message="too few speeds")
    save_model(FrictionModel(FrictionLaw((Viscous(0.02),)), joint="elbow", provenance=doubted), file)
    opened: list[SimulatedJointAdapter] = []
    monkeypatch.setattr(SimulatedJointAdapter, "_open", opened.append)
    result = CliRunner().invoke(app, ["run", str(file), "--out", str(tmp_path / "run")])
    assert isinstance(result.exception, ParameterError), result.output
    assert "'elbow' is not usable (not_identifiable" in str(result.exception)
    assert not opened


def test_a_compensation_that_makes_the_motion_worse_is_told(tmp_path: Path) -> None:
    curve = StribeckCurve(3.0, 3.2, 0.1, 0.5)
    foreign = FrictionModel(FrictionLaw((Stribeck(curve),)), joint="joint", validity=Validity(velocity=(-2.0, 2.0)))
    save_model(foreign, tmp_path / "friction.json")
    short = ["--frequency", "0.5", "--cycles", "1", "--out", str(tmp_path / "run")]
    done = CliRunner().invoke(app, ["run", str(tmp_path / "friction.json"), *short])
    assert done.exit_code == 0, done.output
    assert "follows worse than without" in done.output
