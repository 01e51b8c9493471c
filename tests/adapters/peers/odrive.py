"""An ODrive axis from the vendor's protocol page; frames are taken apart and made by cantools with the vendor's DBC."""

from __future__ import annotations

import struct
from importlib.resources import files
from math import inf, tau
from typing import Any

import cantools

from fricomp.adapters.link import CanFrame
from tests.adapters.peers.bus import Peer

ENDPOINTS = {
    183: ("axis0.config.enable_watchdog", "bool", "<?"),
    184: ("axis0.config.watchdog_timeout", "float", "<f"),
    251: ("axis0.config.torque_soft_min", "float", "<f"),
    252: ("axis0.config.torque_soft_max", "float", "<f"),
    400: ("axis0.controller.config.control_mode", "uint8", "<B"),
    401: ("axis0.controller.config.input_mode", "uint8", "<B"),
}
TORQUE_CONSTANT = 0.08
VELOCITY_GAIN, POSITION_GAIN = 3.0, 40.0  # of the axis' own loop, stiff [N·m·s/rad], [N·m/rad]


def endpoint_file(*without: int) -> dict[str, Any]:
    known = {number: entry for number, entry in ENDPOINTS.items() if number not in without}
    endpoints = {name: {"id": number, "type": kind} for number, (name, kind, _) in known.items()}
    return {"fw_version": "0.6.10", "hw_version": "4.4.58", "endpoints": endpoints}


def vendor_dbc(firmware: str) -> Any:
    name = {"0.5": "odrive-cansimple-0.5.6.dbc", "0.6": "odrive-cansimple-0.6.10.dbc"}[firmware]
    return cantools.database.load_string((files("odrive_can") / "dbc" / name).read_text(), "dbc")


DBC = {firmware: vendor_dbc(firmware) for firmware in ("0.5", "0.6")}


class OdrivePeer(Peer):
    """One axis. The DBC knows axis 0 as messages 0 to 31; the node is added here."""

    def __init__(self, node: int, firmware: str = "0.6", watchdog: float = 0.0) -> None:
        super().__init__()
        self.made_of = (node, firmware, watchdog)
        self.node, self.firmware, self.dbc = node, firmware, DBC[firmware]
        self.values: dict[int, float] = {183: watchdog > 0.0, 184: watchdog, 400: 3, 401: 1, 251: -inf, 252: inf}
        self.keeps = set(self.values)
        self.motor_temperature = 40.0
        self.error = 0
        self.fed_ns = self.beat_ns = 0

    def report(self, name: str, **signals: float) -> None:
        message = self.dbc.get_message_by_name(f"Axis0_{name}")
        data = message.encode({signal.name: signals.get(signal.name, 0) for signal in message.signals})
        self.outbox.append(CanFrame(self.node << 5 | message.frame_id, data))

    def on_time(self, now_ns: int) -> None:
        if self.failed:
            self.trip(0x10)
        self.fed_ns = now_ns if self.held else self.fed_ns
        if self.on and self.values[183] and now_ns - self.fed_ns > self.values[184] * 1e9:
            self.trip(0x01000000 if self.firmware == "0.6" else 0x800)
        if now_ns - self.beat_ns >= 100_000_000:
            self.beat_ns = now_ns
            self.report("Heartbeat", Axis_Error=self.error, Axis_State=8 if self.on else 1)

    def trip(self, error: int) -> None:
        self.error, self.on, self.torque = self.error | error, False, 0.0

    def on_frame(self, frame: CanFrame) -> None:
        if frame.extended or frame.identifier >> 5 != self.node:
            return
        command = frame.identifier & 0x1F
        if self.firmware == "0.5" or command in (0x0C, 0x0D, 0x0E):
            self.fed_ns = self.now_ns
        if frame.remote:
            self.on_request(command)
        elif command == 0x04 and self.firmware == "0.6":
            self.on_endpoint(frame.data)
        else:
            message = self.dbc.get_message_by_frame_id(command)
            self.on_command(message.name.removeprefix("Axis0_"), message.decode(frame.data, decode_choices=False))

    def on_request(self, command: int) -> None:
        if command == 0x00 and self.firmware == "0.6":
            self.report("Get_Version", Protocol_Version=2, Fw_Version_Minor=6, Fw_Version_Revision=10)
        elif command == 0x09:
            self.report("Get_Encoder_Estimates", Pos_Estimate=self.position / tau, Vel_Estimate=self.velocity / tau)
        elif command == 0x14:
            self.report("Get_Iq", Iq_Measured=self.torque / TORQUE_CONSTANT)
        elif command == 0x15:
            self.report("Get_Temperature", FET_Temperature=35.0, Motor_Temperature=self.motor_temperature)
        elif command == 0x1C:
            self.report("Get_Torques", Torque_Target=self.torque, Torque_Estimate=self.torque)

    def on_endpoint(self, data: bytes) -> None:
        operation, number = struct.unpack_from("<BH", data)
        layout = ENDPOINTS[number][2]
        if operation == 1 and number not in self.keeps:
            return
        if operation == 1:
            self.values[number] = struct.unpack_from(layout, data, 4)[0]
        else:
            value = self.values[number] if layout == "<f" else int(self.values[number])
            answer = struct.pack("<BHB", 0, number, 0) + struct.pack(layout, value)
            self.outbox.append(CanFrame(self.node << 5 | 0x05, answer))

    def on_command(self, name: str, signals: dict[str, float]) -> None:
        if name == "Set_Axis_State":
            if signals["Axis_Requested_State"] == 1:
                self.on, self.torque = False, 0.0
            elif signals["Axis_Requested_State"] == 8 and not self.error:
                self.on, self.fed_ns = True, self.now_ns
        elif name == "Set_Controller_Mode" and not self.refuses_mode:
            self.values[400], self.values[401] = signals["Control_Mode"], signals["Input_Mode"]
        elif name == "Clear_Errors" and not self.failed:
            self.error = 0
        elif name == "Set_Input_Torque" and self.on and self.values[400] == 1:
            self.exert(signals["Input_Torque"])
        elif name == "Set_Input_Vel" and self.on and self.values[400] == 2:
            self.exert(signals["Input_Torque_FF"] + VELOCITY_GAIN * (signals["Input_Vel"] * tau - self.velocity))
        elif name == "Set_Input_Pos" and self.on and self.values[400] == 3:
            self.exert(signals["Torque_FF"] + POSITION_GAIN * (signals["Input_Pos"] * tau - self.position))

    def exert(self, torque: float) -> None:
        self.torque = max(self.values[251], min(self.values[252], torque))
