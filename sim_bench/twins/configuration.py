"""A twin from a configuration table: protocol, connection, drives, and the joints behind them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import msgspec

from fricomp.errors import AdapterConnectionError, MissingExtraError, ParameterError
from fricomp.untrusted import convert_table

from ..stand_in import StandIn
from ..stand_in.configuration import read_configuration
from .axis import DriveAxis, twin_stand_in
from .port import BytePort, PtyPort, SocketPort
from .twin import DriveTwin

if TYPE_CHECKING:
    from .can_twin import CanDevice, CanPort

__all__ = ["PROTOCOLS", "Link", "TwinTable", "make_twin"]

PROTOCOLS = ("canopen", "dynamixel", "mit", "moteus", "odrive")
CAN_PROTOCOLS = ("canopen", "mit", "odrive")

_Settings = TypeVar("_Settings")


class Link(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How the twin is reached.

    Attributes:
        kind: `pty` or `tcp`: a serial line (an slcan adapter on it for CAN protocols); `can`: a python-can bus.
        tcp_port: TCP port; 0 for any free one.
        interface: python-can's interface, such as `virtual`, `socketcan`, `udp_multicast`.
        channel: Its channel.
        bitrate: [bit/s].
    """

    kind: Literal["pty", "tcp", "can"] = "pty"
    tcp_port: int = 0
    interface: str = "virtual"
    channel: str | None = None
    bitrate: int = 1_000_000


class TwinTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The whole configuration.

    Attributes:
        link: How the twin is reached.
        drives: One table a joint: fields of the protocol's settings, and `gear_ratio`. Left out, every joint gets
            a drive as delivered, with identifiers from 1.
        sim: The joints, as for the `sim` backend.
        in_amperes: Do not tell the adapter the torque constants, so that torque stays in amperes where the drive
            counts it so.
    """

    link: Link = Link()
    drives: list[dict[str, Any]] = []
    sim: dict[str, Any] = {}
    in_amperes: bool = False


def make_twin(
    protocol: str,
    configuration: Mapping[str, Any] | None = None,
    port: Any = None,
    stored: Mapping[str, Any] | None = None,
) -> DriveTwin:
    """A twin that waits to be served.

    Args:
        protocol: One of `PROTOCOLS`.
        configuration: See `TwinTable`.
        port: A `BytePort` or `CanPort` of the caller's instead of the configured link.
        stored: What every drive has stored, unless its own table says otherwise.

    Raises:
        ParameterError: A name is unknown or a value is wrong.
        AdapterConnectionError: The bus cannot be opened.
        MissingExtraError: A package for this protocol is not installed.
    """
    if protocol not in PROTOCOLS:
        raise ParameterError(f"no twin for {protocol!r}; there are {', '.join(PROTOCOLS)}")
    try:
        table = convert_table(dict(configuration or {}), TwinTable)
    except msgspec.ValidationError as error:
        raise ParameterError(f"twin: {error}") from error
    settings, _ = read_configuration(table.sim)
    stand_in = twin_stand_in(settings)
    n_joints = len(stand_in.servos)
    drives = table.drives or [{} for _ in range(n_joints)]
    if len(drives) != n_joints:
        raise ParameterError(f"{len(drives)} drives given for {n_joints} joints: give one for each, or none")
    ratios = [float(drive.get("gear_ratio", 1.0)) for drive in drives]
    axes = [DriveAxis(stand_in, joint, ratio) for joint, ratio in enumerate(ratios)]
    tables = [
        {name: value for name, value in {**(stored or {}), **drive}.items() if name != "gear_ratio"} for drive in drives
    ]
    try:
        if protocol in CAN_PROTOCOLS:
            return _can_twin(protocol, port or _can_port(table.link), stand_in, axes, tables)
        return _serial_twin(protocol, port or _byte_port(protocol, table.link), stand_in, axes, tables)
    except ModuleNotFoundError as error:
        raise MissingExtraError(error.name or "a package", "can") from error


def _can_twin(
    protocol: str, port: CanPort, stand_in: StandIn, axes: Sequence[DriveAxis], stored: Sequence[dict[str, Any]]
) -> DriveTwin:
    from .can_twin import CanTwin

    make = {"mit": _mit_motor, "odrive": _odrive_node, "canopen": _cia402_drive}[protocol]
    devices = [make(axis, drive, number) for number, (axis, drive) in enumerate(zip(axes, stored, strict=True), 1)]
    return CanTwin(port, stand_in, devices)


def _mit_motor(axis: DriveAxis, stored: dict[str, Any], number: int) -> CanDevice:
    """A motor of the dialect its table names: `damiao`, `ak` or `cybergear`."""
    dialect = stored.pop("dialect", "damiao")
    if dialect == "cybergear":
        from .mit.cybergear import CyberGearMotor, CyberGearSettings

        return CyberGearMotor(axis, _settings(CyberGearSettings, {"motor_id": number} | stored))
    if dialect == "ak":
        from .mit.ak import AkMotor, AkSettings

        return AkMotor(axis, _settings(AkSettings, {"receive_id": number} | stored))
    if dialect != "damiao":
        raise ParameterError(f"no MIT dialect {dialect!r}; there are ak, cybergear, damiao")
    from .mit.damiao import MitMotor, MitSettings

    return MitMotor(axis, _settings(MitSettings, {"receive_id": number, "feedback_id": 0x10 + number} | stored))


def _odrive_node(axis: DriveAxis, stored: dict[str, Any], number: int) -> CanDevice:
    from .odrive import ODriveNode, ODriveSettings

    return ODriveNode(axis, _settings(ODriveSettings, {"node": number} | stored))


def _cia402_drive(axis: DriveAxis, stored: dict[str, Any], number: int) -> CanDevice:
    from .canopen.cia402 import Cia402Drive, Cia402Settings

    return Cia402Drive(axis, _settings(Cia402Settings, {"node_id": number} | stored))


def _serial_twin(
    protocol: str, port: BytePort, stand_in: StandIn, axes: Sequence[DriveAxis], stored: Sequence[dict[str, Any]]
) -> DriveTwin:
    pairs = list(enumerate(zip(axes, stored, strict=True), 1))
    if protocol == "moteus":
        from .moteus.bus import MoteusController, MoteusSettings, MoteusTwin

        period = stand_in.settings.period
        controllers = [
            MoteusController(a, _settings(MoteusSettings, {"identifier": n} | s), period) for n, (a, s) in pairs
        ]
        return MoteusTwin(port, stand_in, controllers)
    from .dynamixel.line import DynamixelServo, DynamixelSettings, DynamixelTwin

    servos = [DynamixelServo(a, _settings(DynamixelSettings, {"identifier": n} | s)) for n, (a, s) in pairs]
    return DynamixelTwin(port, stand_in, servos)


def _byte_port(protocol: str, link: Link) -> BytePort:
    if link.kind == "can":
        raise ParameterError(f"{protocol} is on a serial line here: choose link.kind 'pty' or 'tcp'")
    return SocketPort(link.tcp_port) if link.kind == "tcp" else PtyPort()


def _can_port(link: Link) -> CanPort:
    if link.kind != "can":
        from .slcan import SlcanPort

        return SlcanPort(_byte_port("slcan", link))
    import can

    try:
        return can.Bus(interface=link.interface, channel=link.channel, bitrate=link.bitrate)
    except (can.CanError, OSError, ValueError) as error:
        raise AdapterConnectionError(f"cannot open {link.interface} {link.channel}: {error}") from error


def _settings(kind: type[_Settings], values: dict[str, Any]) -> _Settings:
    known = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    unknown = sorted(set(values) - set(known))
    if unknown:
        raise ParameterError(f"a drive has no {', '.join(unknown)}; known: {', '.join([*known, 'gear_ratio'])}")
    try:
        return convert_table(values, kind)
    except msgspec.ValidationError as error:
        raise ParameterError(f"drive: {error}") from error
