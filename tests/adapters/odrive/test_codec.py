"""Frames of CANSimple, byte by byte as the vendor's protocol page lays them out [odrive2024]."""

import struct
from importlib.resources import files
from math import inf, isnan, nan, tau

import pytest

from fricomp.adapters.link import CanFrame
from fricomp.adapters.odrive.codec import (
    AxisState,
    Command,
    Heartbeat,
    axis_state_frame,
    controller_mode_frame,
    decode_heartbeat,
    decode_pair,
    decode_temperature,
    input_frame,
    plain_frame,
    request_frame,
)
from fricomp.errors import AdapterValueError
from fricomp.joint import CommandMode

NAMES = {
    "VERSION": "Get_Version", "HEARTBEAT": "Heartbeat", "WRITE_ENDPOINT": "RxSdo", "ENDPOINT_ANSWER": "TxSdo",
    "AXIS_STATE": "Set_Axis_State", "ENCODER_ESTIMATES": "Get_Encoder_Estimates",
    "CONTROLLER_MODE": "Set_Controller_Mode", "INPUT_POSITION": "Set_Input_Pos", "INPUT_VELOCITY": "Set_Input_Vel",
    "INPUT_TORQUE": "Set_Input_Torque", "CURRENT": "Get_Iq", "TEMPERATURE": "Get_Temperature",
    "CLEAR_ERRORS": "Clear_Errors", "TORQUES": "Get_Torques",
}  # fmt: skip
"""Our names of commands, and those of the vendor's DBC for firmware 0.6."""


def test_commands_and_states_have_the_numbers_of_the_vendor_s_dbc() -> None:
    cantools = pytest.importorskip("cantools")
    pytest.importorskip("odrive_can")
    text = (files("odrive_can") / "dbc" / "odrive-cansimple-0.6.10.dbc").read_text()
    database = cantools.database.load_string(text, "dbc")
    numbers = {message.name.removeprefix("Axis0_"): message.frame_id & 0x1F for message in database.messages}
    assert {command.name: command.value for command in Command} == {ours: numbers[name] for ours, name in NAMES.items()}
    (states, *_) = database.get_message_by_name("Axis0_Set_Axis_State").signals
    named = {str(name): number for number, name in (states.choices or {}).items()}
    told = [named[name] for name in ("UNDEFINED", "IDLE", "CLOSED_LOOP_CONTROL")]
    assert told == [AxisState.UNDEFINED, AxisState.IDLE, AxisState.CLOSED_LOOP]


def test_a_node_is_told_its_state_its_mode_and_what_to_report() -> None:
    assert axis_state_frame(3, AxisState.CLOSED_LOOP) == CanFrame(0x067, bytes.fromhex("0800000000000000"))
    assert controller_mode_frame(63, "velocity") == CanFrame(0x7EB, bytes.fromhex("0200000001000000"))
    assert controller_mode_frame(0, "torque").data[:4] == b"\x01\0\0\0"
    assert controller_mode_frame(0, "position").data[:4] == b"\x03\0\0\0"
    assert request_frame(2, Command.TEMPERATURE) == CanFrame(0x055, b"", False, remote=True)
    assert plain_frame(1, Command.CLEAR_ERRORS, b"\0") == CanFrame(0x038, b"\0")
    assert plain_frame(1, Command.CLEAR_ERRORS) == CanFrame(0x038)


@pytest.mark.parametrize(
    ("mode", "identifier", "data"),
    [
        ("torque", 0x02E, struct.pack("<ff", 0.012, 0.0)),
        ("velocity", 0x02D, struct.pack("<ff", 2.0, 0.012)),
        ("position", 0x02C, struct.pack("<fhh", 0.25, 0, 12)),
    ],
)
def test_a_set_point_is_in_turns_and_newton_metres(mode: CommandMode, identifier: int, data: bytes) -> None:
    assert input_frame(1, mode, 0.012, 2.0 * tau, 0.25 * tau) == CanFrame(identifier, data)


@pytest.mark.parametrize(("torque", "count"), [(32.767, 32767), (40.0, 32767), (-40.0, -32767), (-0.0034, -3)])
def test_a_feed_forward_in_thousandths_saturates(torque: float, count: int) -> None:
    assert struct.unpack("<fhh", input_frame(1, "position", torque, 0.0, 0.0).data) == (0.0, 0, count)


@pytest.mark.parametrize("bad", [nan, inf, -inf, 3.5e38])
@pytest.mark.parametrize("place", [0, 1, 2])
@pytest.mark.parametrize("mode", ["torque", "velocity", "position"])
def test_no_mode_sends_what_is_no_float(mode: CommandMode, place: int, bad: float) -> None:
    values = [0.0, 0.0, 0.0]
    values[place] = bad
    with pytest.raises(AdapterValueError, match="cannot be sent"):
        input_frame(1, mode, *values)


@pytest.mark.parametrize("flags", [(1, 0, 0), (0, 1, 0), (0, 0, 1)])
def test_errors_of_motor_encoder_and_controller_are_told_on_firmware_5_alone(flags: tuple[int, int, int]) -> None:
    data = struct.pack("<IBBBB", 0x01020304, 8, *flags)
    assert decode_heartbeat(data, 5) == Heartbeat(0x01020304, 8, 1)
    assert decode_heartbeat(data, 6) == Heartbeat(0x01020304, 8, 0)


def test_other_bits_beside_the_errors_are_no_error() -> None:
    assert decode_heartbeat(struct.pack("<IBBBB", 0, 1, 0xFE, 0xFE, 0xFE), 5) == Heartbeat(0, 1, 0)


@pytest.mark.parametrize("decode", [lambda data: decode_heartbeat(data, 5), decode_pair, decode_temperature])
def test_a_report_that_is_cut_short_says_nothing(decode: object) -> None:
    assert callable(decode)
    assert all(decode(bytes(length)) is None for length in range(8))
    assert decode(bytes(8)) is not None


def test_a_pair_is_two_finite_floats() -> None:
    assert decode_pair(struct.pack("<ff", 1.5, -2.5)) == (1.5, -2.5)
    assert decode_pair(struct.pack("<ff", nan, 1.0)) is None
    assert decode_pair(struct.pack("<ff", 1.0, inf)) is None
    assert decode_pair(bytes(9)) is None


def test_the_hotter_of_inverter_and_motor_counts_and_one_is_enough() -> None:
    assert decode_temperature(struct.pack("<ff", 30.0, 45.0)) == 45.0
    assert decode_temperature(struct.pack("<ff", 50.0, 45.0)) == 50.0
    assert decode_temperature(struct.pack("<ff", 30.0, nan)) == 30.0
    unknown = decode_temperature(struct.pack("<ff", nan, inf))
    assert unknown is not None
    assert isnan(unknown)
