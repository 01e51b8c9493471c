"""The MIT motor: frames by hand from the protocol description, and damiao-motor as an independent master."""

from __future__ import annotations

import struct
from collections.abc import Iterator

import pytest

from fricomp.errors import ParameterError
from fricomp.sim_bench.twins import TwinClock, TwinServer
from fricomp.sim_bench.twins.mit.damiao import MitMotor, MitSettings, MitStatus

from ..rig import CanRig, can_rig, fresh_channel, wait_for

ENABLE, DISABLE, ZERO, CLEAR = (b"\xff" * 7 + bytes([code]) for code in (0xFC, 0xFD, 0xFE, 0xFB))
# Position, velocity and torque at their middle codes, gains zero.
NEUTRAL = bytes.fromhex("7fff7ff0000007ff")


@pytest.fixture
def rig() -> Iterator[CanRig]:
    with can_rig(lambda axis: MitMotor(axis, MitSettings(timeout=2000))) as made:
        yield made


def motor(rig: CanRig) -> MitMotor:
    (device,) = rig.twin.drives
    assert isinstance(device, MitMotor)
    return device


def torque_frame(torque: float) -> bytes:
    """A control frame of the middle position and velocity, no gains, and a torque over ±10 N·m."""
    code = round((torque + 10.0) / 20.0 * 4095)
    return (0x7FFF << 48 | 0x7FF << 36 | code).to_bytes(8, "big")


def test_every_control_frame_is_answered_with_state_position_velocity_torque(rig: CanRig) -> None:
    ((identifier, data),) = rig.ask(0x01, NEUTRAL)
    assert identifier == 0x11
    assert data[0] == 0x01  # disabled, motor 1
    position = int.from_bytes(data[1:3], "big") / 65535 * 25.0 - 12.5
    assert position == pytest.approx(0.25, abs=25.0 / 65535 / 2 + 1e-9)
    assert data[6:] == bytes([25, 25])


def test_torque_moves_nothing_until_enabled(rig: CanRig) -> None:
    for _ in range(50):
        rig.send(0x01, torque_frame(3.0))
        rig.steps(1)
    assert rig.stand_in.torque == [0.0]
    assert rig.ask(0x01, ENABLE)[0][1][0] >> 4 == MitStatus.ENABLED
    rig.steps(1)
    assert rig.stand_in.torque == [0.0]
    rig.send(0x01, torque_frame(3.0))
    rig.steps(1)
    assert rig.stand_in.torque[0] == pytest.approx(3.0, abs=20.0 / 4095)


def test_gains_pull_towards_the_position_reference(rig: CanRig) -> None:
    rig.ask(0x01, ENABLE)
    bits = round((0.5 + 12.5) / 25.0 * 65535) << 48 | 0x7FF << 36 | round(4.0 / 500.0 * 4095) << 24 | 0x7FF
    rig.send(0x01, bits.to_bytes(8, "big"))
    rig.steps(1)
    assert rig.stand_in.torque[0] == pytest.approx(4.0 * 0.25, abs=0.1)


def test_silence_beyond_register_9_goes_limp_and_needs_clear_and_enable(rig: CanRig) -> None:
    rig.ask(0x01, ENABLE)
    rig.send(0x01, torque_frame(1.0))
    rig.steps(99)
    assert rig.stand_in.torque[0] == pytest.approx(1.0, abs=0.01)
    rig.steps(4)
    assert rig.stand_in.torque == [0.0]
    assert rig.ask(0x01, ENABLE)[0][1][0] >> 4 == MitStatus.LOST_COMMUNICATION
    rig.ask(0x01, CLEAR)
    assert rig.ask(0x01, NEUTRAL)[0][1][0] >> 4 == MitStatus.DISABLED
    assert rig.ask(0x01, ENABLE)[0][1][0] >> 4 == MitStatus.ENABLED


def test_disable_and_power_cycle_take_the_torque_away(rig: CanRig) -> None:
    for ending in (lambda: rig.ask(0x01, DISABLE), rig.twin.power_cycle):
        rig.ask(0x01, ENABLE)
        rig.send(0x01, torque_frame(2.0))
        rig.steps(1)
        assert rig.stand_in.torque[0] > 1.9
        ending()
        rig.steps(1)
        assert rig.stand_in.torque == [0.0]


def test_a_fault_stays_until_cleared(rig: CanRig) -> None:
    rig.ask(0x01, ENABLE)
    motor(rig).fail(MitStatus.OVER_CURRENT)
    assert rig.ask(0x01, torque_frame(1.0))[0][1][0] == 0xA1
    rig.steps(2)
    assert rig.stand_in.torque == [0.0]


def test_zero_sets_the_position_origin_while_disabled(rig: CanRig) -> None:
    rig.ask(0x01, ZERO)
    data = rig.ask(0x01, NEUTRAL)[0][1]
    assert int.from_bytes(data[1:3], "big") in (0x7FFF, 0x8000)


def test_registers_are_read_and_written_on_7ff_and_answered_on_the_feedback_id(rig: CanRig) -> None:
    assert rig.ask(0x7FF, bytes([1, 0, 0x33, 21, 0, 0, 0, 0])) == [
        (0x11, bytes([1, 0, 0x33, 21]) + struct.pack("<f", 12.5))
    ]
    rig.ask(0x7FF, bytes([1, 0, 0x55, 9]) + struct.pack("<I", 400))
    assert motor(rig).registers[9] == 400
    rig.ask(0x7FF, bytes([1, 0, 0x55, 16]) + struct.pack("<I", 99))
    assert motor(rig).registers[16] == 0, "pole pairs are read only"
    assert rig.ask(0x7FF, bytes([2, 0, 0x33, 21, 0, 0, 0, 0])) == [], "another motor's"


@pytest.mark.parametrize("data", [b"", b"\xff", NEUTRAL[:7], b"\xff" * 7])
def test_short_frames_are_dropped(rig: CanRig, data: bytes) -> None:
    assert rig.ask(0x01, data) == []


def test_an_unplugged_motor_is_silent_and_its_watchdog_bites(rig: CanRig) -> None:
    rig.ask(0x01, ENABLE)
    rig.send(0x01, torque_frame(1.0))
    rig.steps(1)
    rig.twin.unplugged = True
    assert rig.ask(0x01, NEUTRAL) == []
    rig.steps(105)
    assert rig.stand_in.torque == [0.0]


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(ParameterError, match="torque_range"):
        MitSettings(torque_range=0.0)


@pytest.mark.filterwarnings("ignore:The 'bustype' argument:DeprecationWarning")
def test_damiao_motor_drives_the_twin_unmodified() -> None:
    damiao = pytest.importorskip("damiao_motor", reason="damiao-motor is not installed")
    channel = fresh_channel()
    with can_rig(MitMotor, channel) as rig, TwinServer(rig.twin) as server:
        controller = damiao.DaMiaoController(channel=channel, bustype="virtual")
        try:
            peer = controller.add_motor(motor_id=1, feedback_id=0x11, motor_type="4310")
            assert peer.get_register(22, timeout=5.0) == pytest.approx(30.0)
            peer.set_can_timeout(100)
            wait_for(lambda: motor(rig).registers[9] == 2000)
            peer.enable()
            wait_for(lambda: motor(rig).status == MitStatus.ENABLED)
            clock = TwinClock(rig.twin)
            for _ in range(300):
                peer.send_cmd_mit(
                    target_position=0.0, target_velocity=0.0, stiffness=0.0, damping=0.0, feedforward_torque=0.9
                )
                clock.sleep_until(clock.now_ns() + 1_000_000)
            truth = rig.stand_in.plant
            peer.request_motor_feedback()
            wait_for(lambda: abs(peer.get_states()["pos"] - truth.position(0)) < 1e-3)
            states = peer.get_states()
            assert states["status"] == "ENABLED"
            assert states["vel"] == pytest.approx(truth.velocity(0), abs=60.0 / 4095)
            assert states["torq"] == pytest.approx(rig.stand_in.torque[0], abs=20.0 / 4095)
            clock.sleep_until(clock.now_ns() + 200_000_000)
            peer.request_motor_feedback()
            wait_for(lambda: peer.get_states()["status"] == "LOST_COMM")
        finally:
            controller.shutdown()
        assert server.error is None
