"""Every adapter on its twin with a MuJoCo joint behind it, in lock step: the trial of a drive, and what torque does."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from fricomp.adapters import JointAdapter
from fricomp.adapters import trial as trial_module
from fricomp.adapters.canopen import CanOpenAdapter
from fricomp.adapters.canopen.configuration import CanOpenConfiguration
from fricomp.adapters.configuration import convert
from fricomp.adapters.dynamixel import DynamixelAdapter
from fricomp.adapters.dynamixel.configuration import DynamixelConfiguration
from fricomp.adapters.link import CanLink
from fricomp.adapters.mit import MitAdapter
from fricomp.adapters.mit.configuration import MitConfiguration
from fricomp.adapters.moteus import MoteusAdapter
from fricomp.adapters.moteus.adapter import MoteusConfiguration
from fricomp.adapters.odrive import OdriveAdapter
from fricomp.adapters.odrive.configuration import OdriveConfiguration
from fricomp.adapters.trial import LARGEST_SHARE, TrialSettings, TrialStep, try_drive
from fricomp.cli.main import app
from fricomp.errors import AdapterError, DriveHeld, ParameterError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.sim_bench.stand_in import StandIn
from fricomp.sim_bench.stand_in.packaged import default_joint
from fricomp.sim_bench.twins import DriveAxis, DriveTwin, TwinClock, twin_stand_in
from fricomp.sim_bench.twins.can_twin import CanDevice, CanTwin
from fricomp.sim_bench.twins.canopen.cia402 import Cia402Drive, Cia402Settings
from fricomp.sim_bench.twins.dynamixel.line import DynamixelServo, DynamixelTwin
from fricomp.sim_bench.twins.memory import MemoryCanLine, MemorySerialLine
from fricomp.sim_bench.twins.mit.damiao import MitMotor
from fricomp.sim_bench.twins.moteus.bus import MoteusController, MoteusTwin
from fricomp.sim_bench.twins.odrive import ENDPOINTS, ODriveNode, ODriveSettings
from tests.adapters.peers.rig import joint_tables

SMOOTH = FrictionLaw(
    (BidirectionalStribeck(StribeckCurve(0.04, 0.08, 0.05, 0.02), StribeckCurve(0.05, 0.09, 0.05, 0.02)),)
)

Made = tuple[JointAdapter, DriveTwin]


def make_stand_in() -> StandIn:
    return twin_stand_in(default_joint(law=SMOOTH))


def can_twin(make: Callable[[DriveAxis], CanDevice]) -> tuple[CanLink, DriveTwin]:
    line, stand_in = MemoryCanLine(), make_stand_in()
    twin = CanTwin(line, stand_in, [make(DriveAxis(stand_in))])
    line.on_sent = twin.pump
    return line.link, twin


def can_table(**extra: Any) -> dict[str, Any]:
    return {"bus": {"interface": "virtual"}, "joints": joint_tables(1, 4.0, 8.0, **extra)}


def make_canopen(_: Path) -> Made:
    link, twin = can_twin(lambda axis: Cia402Drive(axis, Cia402Settings(rated_torque=5.0)))
    made = convert(can_table(), CanOpenConfiguration)
    return CanOpenAdapter(made, lambda: link, TwinClock(twin)), twin


def make_mit(_: Path) -> Made:
    link, twin = can_twin(MitMotor)
    made = convert(can_table(model="damiao/DM4310"), MitConfiguration)
    return MitAdapter(made, lambda: link, TwinClock(twin)), twin


def make_odrive(folder: Path) -> Made:
    link, twin = can_twin(lambda axis: ODriveNode(axis, ODriveSettings(node=1)))
    endpoints = {name: {"id": number, "type": kind} for number, (name, kind) in ENDPOINTS.items()}
    path = folder / "flat_endpoints.json"
    path.write_text(json.dumps({"fw_version": "0.6.9", "endpoints": endpoints}))
    made = convert(can_table() | {"endpoints": str(path)}, OdriveConfiguration)
    return OdriveAdapter(made, lambda: link, TwinClock(twin)), twin


def make_moteus(_: Path) -> Made:
    line, stand_in = MemorySerialLine(), make_stand_in()
    twin = MoteusTwin(line, stand_in, [MoteusController(DriveAxis(stand_in))])
    line.on_sent = twin.pump
    table = {"serial": {"port": "loop://"}, "joints": joint_tables(1, 4.0, 8.0)}
    return MoteusAdapter(convert(table, MoteusConfiguration), lambda: line.link, TwinClock(twin)), twin


def make_dynamixel(_: Path) -> Made:
    line, stand_in = MemorySerialLine(), make_stand_in()
    twin = DynamixelTwin(line, stand_in, [DynamixelServo(DriveAxis(stand_in))])
    line.on_sent = twin.pump
    table = {"serial": {"port": "loop://"}, "joints": joint_tables(1, 4.0, 8.0, torque_constant=1.78)}
    return DynamixelAdapter(convert(table, DynamixelConfiguration), lambda: line.link, TwinClock(twin)), twin


MAKERS = {
    "canopen": make_canopen,
    "dynamixel": make_dynamixel,
    "mit": make_mit,
    "moteus": make_moteus,
    "odrive": make_odrive,
}


@pytest.fixture(params=sorted(MAKERS))
def made(request: pytest.FixtureRequest, tmp_path: Path) -> Made:
    return MAKERS[request.param](tmp_path)


def test_the_trial_of_a_healthy_drive_finds_nothing_wrong(made: Made) -> None:
    adapter, twin = made
    steps = list(try_drive(adapter, TrialSettings(), lambda: True))
    assert [step for step in steps if step.passed is False] == []
    assert not [step for step in steps if " inf" in step.detail or "steps 0" in step.detail]
    names = {step.name: step for step in steps}
    assert names["push joint 0 forward"].passed
    assert names["push joint 0 backward"].passed
    assert names["stop"].passed
    assert not twin.stand_in.servos[0].enabled or abs(twin.stand_in.torque[0]) < 1e-9


def test_the_trial_clears_what_its_own_silence_has_latched(made: Made) -> None:
    adapter, _ = made
    steps = list(try_drive(adapter, TrialSettings(), lambda: True))
    assert (steps[-1].name, steps[-1].passed) == ("clear", True)
    assert (steps[-2].name, steps[-2].passed) == ("fall silent at zero torque", True)
    assert "stopped by themselves" in steps[-2].detail
    with adapter:
        adapter.configure("torque", 0.005)
        adapter.enable()  # as `fricomp calibrate` does after `fricomp adapter check`


@pytest.mark.parametrize("protocol", sorted(MAKERS))
def test_the_trial_clears_nothing_but_what_it_has_caused(protocol: str, tmp_path: Path) -> None:
    adapter, _ = MAKERS[protocol](tmp_path)
    names = []
    for step in try_drive(adapter, TrialSettings(), lambda: True):
        names.append(step.name)
        if step.name == "stop":
            adapter.watchdog_faults = frozenset()  # as if it were another fault
    assert names[-1] == "clear"
    assert step.passed is False
    assert "fricomp adapter clear" in step.detail


def test_a_drive_that_another_process_holds_is_left_alone(made: Made) -> None:
    """Another adapter on the same line holds the drive: its torque and its watchdog stay what they are."""
    holder: Any
    holder, twin = made
    adapter = type(holder)(holder._configuration, None, holder.clock)
    holder.open()
    holder.configure("torque", 0.005)
    holder.enable()
    command, feedback, line = JointCommand(1), JointFeedback(1), holder._link
    command.torque[0] = 0.02
    for _ in range(50):
        assert holder.write(command)
        holder.clock.sleep_until(holder.clock.now_ns() + 5_000_000)
        holder.read_into(feedback)
    feeding = Feeding(line, lambda: holder._write(holder._drive.command_from_joint(), "torque"))
    adapter._open_link = lambda: feeding
    with pytest.raises(DriveHeld, match=r"energised by somebody else: joint 0; nothing was written"):
        adapter.open()
    assert twin.stand_in.servos[0].enabled
    assert twin.stand_in.torque[0] == pytest.approx(0.02, abs=0.005)


class Feeding:
    """A line on which the holder goes on commanding whenever the other one looks at it."""

    def __init__(self, line: Any, go_on: Callable[[], object]) -> None:
        self._line, self._go_on, self._busy = line, go_on, False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._line, name)

    def receive(self) -> Any:
        received = self._line.receive()
        self._go_on()
        return received

    def close(self) -> None:
        """The line is the holder's."""


def test_the_trial_energises_nothing_without_leave(made: Made) -> None:
    adapter, twin = made
    steps = list(try_drive(adapter, TrialSettings(), lambda: False))
    told = "not tried: not allowed to; the drives say that nothing is energised"
    assert steps[-1] == TrialStep("energise", None, told)
    assert not twin.stand_in.servos[0].enabled


def test_the_trial_never_commands_more_than_its_share(made: Made) -> None:
    adapter, twin = made
    largest = 0.0
    for step in try_drive(adapter, TrialSettings(), lambda: True):
        largest = max(largest, abs(twin.stand_in.torque[0]))
        if step.name not in ("open", "configuration"):
            assert adapter.gate.limits[0].torque <= LARGEST_SHARE * 4.0 * (1.0 + 1e-9)
    assert largest <= 1.05 * LARGEST_SHARE * 4.0  # and a step of the drive's counting
    with pytest.raises(AdapterError, match="not open"):
        _ = adapter.capabilities  # closed at the end


def test_torque_accelerates_the_joint_as_its_inertia_says(made: Made) -> None:
    """1 N·m on 0.1 kg·m² gives 10 rad/s², friction aside; far less, or the other way, would be a scaling error."""
    adapter, twin = made
    with adapter:
        adapter.configure("torque", 0.005)
        adapter.enable()
        command, feedback = JointCommand(1), JointFeedback(1)
        command.torque[0] = 1.0
        for _ in range(80):
            assert adapter.write(command)
            adapter.clock.sleep_until(adapter.clock.now_ns() + 5_000_000)
            adapter.read_into(feedback)
            if feedback.position[0] > 0.3:
                break
        velocity = twin.stand_in.plant.velocity(0)
        assert velocity > 0.5
        assert feedback.velocity[0] == pytest.approx(velocity, rel=0.1, abs=0.05)
        assert feedback.torque[0] == pytest.approx(1.0, abs=0.05)


def test_the_wrong_sign_is_found(tmp_path: Path) -> None:
    adapter, _ = make_mit(tmp_path)
    codec = adapter._motors[0].codec  # type: ignore[attr-defined]
    plain = codec.encode_torque
    codec.encode_torque = lambda torque: plain(-torque)
    steps = list(try_drive(adapter, TrialSettings(), lambda: True))
    assert steps[-1].passed is False
    assert "wrong way" in steps[-1].detail


@pytest.mark.parametrize("share", [0.0, 0.051, 1.0, float("nan")])
def test_more_than_a_twentieth_is_refused(share: float) -> None:
    with pytest.raises(ParameterError, match=r"at most 0\.05, got"):
        TrialSettings(share=share)


@pytest.mark.parametrize("is_dead", [False, True])
def test_an_interrupted_trial_says_what_has_become_of_the_joints(
    is_dead: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(trial: trial_module._Trial, joint: int, sign: float) -> TrialStep:
        if is_dead:
            monkeypatch.setattr(type(trial.adapter), "_stop", fail)
        raise KeyboardInterrupt

    def fail(_: JointAdapter) -> None:
        raise AdapterError("the bus is off")

    monkeypatch.setattr(trial_module._Trial, "_push", interrupt)
    (tmp_path / "drive.toml").write_text('backend = "twin-moteus"')
    done = CliRunner().invoke(app, ["adapter", "check", str(tmp_path / "drive.toml"), "--yes"])
    if is_dead:
        assert isinstance(done.exception, AdapterError)
        assert "the bus is off: cut the power" in str(done.exception)
        assert "zero torque" not in done.stderr
    else:
        assert done.exit_code == 130
        assert "Interrupted; what was energised is at zero torque" in done.stderr
