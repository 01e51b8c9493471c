"""The configuration file: bus, joints, limits and transmissions, read from TOML and checked before a bus is opened."""

import tomllib
from collections.abc import Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import msgspec

from fricomp.control import JointLimits
from fricomp.errors import AdapterConfigurationError, ParameterError
from fricomp.model import Motion
from fricomp.untrusted import convert_table, parse_toml, read_whole

from .options import AdapterOptions
from .transmission import Transmission

__all__ = [
    "AdapterChoice",
    "AdapterConfiguration",
    "CanAdapterConfiguration",
    "CanBusConfiguration",
    "ConfigurationTable",
    "JointConfiguration",
    "LimitsConfiguration",
    "SerialAdapterConfiguration",
    "SerialConfiguration",
    "TransmissionConfiguration",
    "choose_adapter",
    "convert",
    "options_of",
    "read_configuration",
    "read_table",
]

Configured = TypeVar("Configured", bound="AdapterConfiguration")

_SIMULATED = "sim"
_BUSES = frozenset({"bus", "serial"})  # tables that only a real drive has
_PATHS = {"endpoints": "", "friction": "", "model": ".xml"}  # keys that hold a path, and what such a path ends with
_NO_BACKEND = 'names no backend: add a line such as backend = "canopen" at the top'


class LimitsConfiguration(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Limits of one joint, joint side; see `fricomp.control.JointLimits`.

    Attributes:
        torque: Largest commanded torque [N·m], [N] or the actuator's own unit.
        torque_rate: Fastest change of it [N·m/s].
        velocity: Speed beyond which the joints are stopped [rad/s] or [m/s].
        position: Range outside which the joints are stopped [rad] or [m]; none where the joint turns freely.
        temperature: Temperature above which the joints are stopped [°C].
        breakaway: Largest torque with which its friction may hold the joint; 0.45 of `torque` if not given.
    """

    torque: float
    torque_rate: float
    velocity: float
    position: tuple[float, float] | None = None
    temperature: float | None = None
    breakaway: float | None = None


class TransmissionConfiguration(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Gear between drive and joint; see `Transmission`."""

    gear_ratio: float = 1.0
    sign: int = 1
    zero: float = 0.0
    motion: Motion = "rotary"


class JointConfiguration(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One joint.

    Attributes:
        name: Name of the joint, unique.
        id: Address of its drive on the bus.
        limits: What it may do.
        transmission: Gear, sign and zero.
    """

    name: str
    id: int
    limits: LimitsConfiguration
    transmission: TransmissionConfiguration = TransmissionConfiguration()


class CanBusConfiguration(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A CAN bus as python-can opens it.

    Attributes:
        interface: Any interface of python-can (`socketcan`, `pcan`, `gs_usb`, `socketcand`, `virtual`, ...), or
            `slcan-chunked` for a serial adapter read in chunks.
        channel: What the interface calls its channel: `can0`, `/dev/ttyACM0`, ...
        bitrate: [bit/s].
        options: Further arguments of the interface, passed on as they are.
    """

    interface: str
    channel: str | int | None = None
    bitrate: int = 1_000_000
    options: dict[str, Any] = {}


class SerialConfiguration(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A serial port as pyserial opens it.

    Attributes:
        port: `usb:` and the serial number of its USB device, which finds it again wherever it is plugged in; or a
            device or any pyserial address: `/dev/ttyACM0`, `COM3`, `socket://host:port`, ...
        baudrate: [baud]; USB devices ignore it.
    """

    port: str
    baudrate: int = 1_000_000


class AdapterConfiguration(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What every adapter takes; each adds its bus, its joints and its own keys.

    Attributes:
        backend: Name of the adapter; read by `choose_adapter` and `open_adapter` only.
        ramp_time: Time over which torque may rise to its limit after enabling [s].
        stale_after: Age at which feedback counts as lost [s].
        watchdog: Time of silence after which the drives stop by themselves [s].
        allow_no_watchdog: Enable drives that have none.
        response_timeout: How long a drive may take to answer while opening and configuring [s].
    """

    backend: str | None = None
    ramp_time: float = 0.2
    stale_after: float = 0.02
    watchdog: float = 0.1
    allow_no_watchdog: bool = False
    response_timeout: float = 0.3

    def __post_init__(self) -> None:
        for name in ("watchdog", "response_timeout"):
            if not 0.0 < getattr(self, name) <= 10.0:
                raise ValueError(f"{name} must be above 0 and at most 10 s, got {getattr(self, name)!r}")
        if not 0.0 <= self.ramp_time < inf:
            raise ValueError(f"ramp_time must be finite and at least 0 s, got {self.ramp_time!r}")
        if not 1e-9 <= self.stale_after < inf:
            raise ValueError(f"stale_after must be finite and above 0 s, got {self.stale_after!r}")


class CanAdapterConfiguration(AdapterConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What every adapter on a CAN bus takes."""

    bus: CanBusConfiguration


class SerialAdapterConfiguration(AdapterConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What every adapter on a serial port takes."""

    serial: SerialConfiguration


class ConfigurationTable(dict[str, Any]):
    """What stands in a TOML file.

    Attributes:
        path: The file.
    """

    def __init__(self, content: Mapping[str, Any], path: Path) -> None:
        super().__init__(content)
        self.path = path


class AdapterChoice(NamedTuple):
    """An adapter by name, and what it is made from."""

    backend: str
    configuration: dict[str, Any]


def choose_adapter(backend: str | None, config: str | Path | Mapping[str, Any] | None) -> AdapterChoice:
    """The adapter that a command line and a configuration ask for together.

    Args:
        backend: As given on the command line; none where the file, or the default, says it.
        config: Configuration file, or the table that it would hold; its `backend` may be left out where the command
            line names one, and for `sim`.

    Raises:
        AdapterConfigurationError: The file cannot be read, says another backend than the command line, or is that of a
            drive and nobody says of which.
    """
    if config is None:
        return AdapterChoice(backend or _SIMULATED, {})
    file = "the configuration" if isinstance(config, Mapping) else str(config)
    configuration = dict(config) if isinstance(config, Mapping) else read_table(config)
    named = configuration.pop("backend", None)
    if named is None and backend is None and _BUSES & configuration.keys():
        raise AdapterConfigurationError(f"{file} {_NO_BACKEND}, or give --backend")
    if named is not None and not isinstance(named, str):
        raise AdapterConfigurationError(f"{file}: backend must be a name in quotes, got {named!r}")
    if None not in (named, backend) and named != backend:
        raise AdapterConfigurationError(
            f"{file} is for backend {named!r}, but {backend!r} is asked for: leave out --backend, or give its own file"
        )
    return AdapterChoice(backend or named or _SIMULATED, configuration)


def read_configuration(path: str | Path) -> dict[str, Any]:
    """What stands in a TOML file that names its backend.

    Raises:
        AdapterConfigurationError: It cannot be read, or names no backend.
    """
    found = read_table(path)
    if not isinstance(found.get("backend"), str):
        raise AdapterConfigurationError(f"{path} {_NO_BACKEND}")
    return found


def read_table(path: str | Path) -> ConfigurationTable:
    """What stands in a TOML file; paths in it count from its own folder, wherever the command is called.

    Raises:
        AdapterConfigurationError: It cannot be read.
    """
    try:
        found = parse_toml(read_whole(path).decode("utf-8"))
    except OSError as error:
        raise AdapterConfigurationError(f"cannot read the configuration {path}: {error.strerror}") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise AdapterConfigurationError(f"cannot read the configuration {path} as TOML: {error}") from error
    _resolve_paths(found, Path(path).absolute().parent)
    return ConfigurationTable(found, Path(path))


def _resolve_paths(table: dict[str, Any], folder: Path) -> None:
    """Put `folder` before the relative paths of a table, of its joints and of the twin's `sim`."""
    for name, ending in _PATHS.items():
        value = table.get(name)
        if isinstance(value, str) and value.endswith(ending):  # a model may be a name as well
            table[name] = str(folder / value)
    joints = table.get("joints")
    for inner in (table.get("sim"), *(joints if isinstance(joints, list) else ())):
        if isinstance(inner, dict):
            _resolve_paths(inner, folder)


def convert(configuration: Mapping[str, Any], to: type[Configured]) -> Configured:
    """A checked configuration.

    Raises:
        AdapterConfigurationError: A key is unknown or missing, or a value is wrong; the message names the key.
    """
    where = str(getattr(configuration, "path", "configuration"))
    try:
        made = convert_table(dict(configuration), to)
    except (msgspec.ValidationError, ValueError) as error:
        hint = "" if configuration else "; give the drive's file with --config (docs/adapters.md)"
        raise AdapterConfigurationError(f"{where}: {error}{hint}") from error
    joints: Sequence[JointConfiguration] = getattr(made, "joints", ())
    if not joints:
        raise AdapterConfigurationError(f"{where}: no joint; add a [[joints]] table for each")
    for what in ("name", "id"):
        seen = [getattr(joint, what) for joint in joints]
        if len(set(seen)) != len(seen):
            raise AdapterConfigurationError(f"{where}: two joints have the same {what}: {seen}")
    return made


def options_of(configuration: AdapterConfiguration, joints: Sequence[JointConfiguration]) -> AdapterOptions:
    """The options of the adapter base.

    Raises:
        AdapterConfigurationError: A limit or a transmission is out of its domain; the message names the joint.
    """
    limits: list[JointLimits] = []
    transmissions: list[Transmission] = []
    for joint in joints:
        try:
            limits.append(JointLimits(**msgspec.structs.asdict(joint.limits)))
            transmissions.append(Transmission(**msgspec.structs.asdict(joint.transmission)))
        except (ParameterError, AdapterConfigurationError) as error:
            raise AdapterConfigurationError(f"configuration: joint {joint.name!r}: {error}") from error
    return AdapterOptions(
        limits=tuple(limits),
        transmissions=tuple(transmissions),
        ramp_time=configuration.ramp_time,
        stale_after=configuration.stale_after,
        allow_no_watchdog=configuration.allow_no_watchdog,
    )
