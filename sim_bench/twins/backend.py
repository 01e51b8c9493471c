"""Backends `twin-canopen`, `twin-mit`, …: the real adapter on its twin in one process, in lock step.

Nothing but the wire is left out: the same encoding, state machines, watchdogs and quantisation as on hardware, and
equal runs are equal to the last bit.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Self, TypeVar

from fricomp.adapters import JointAdapter
from fricomp.adapters.canopen import CanOpenAdapter
from fricomp.adapters.canopen.configuration import CanOpenConfiguration
from fricomp.adapters.configuration import convert
from fricomp.adapters.dynamixel import DynamixelAdapter
from fricomp.adapters.dynamixel.configuration import DynamixelConfiguration
from fricomp.adapters.mit import MitAdapter
from fricomp.adapters.mit.configuration import MitConfiguration
from fricomp.adapters.moteus import MoteusAdapter
from fricomp.adapters.moteus.adapter import MoteusConfiguration
from fricomp.adapters.odrive import OdriveAdapter
from fricomp.adapters.odrive.configuration import OdriveConfiguration
from fricomp.errors import AdapterConfigurationError, ParameterError
from fricomp.joint import Capabilities

from .adapter_table import adapter_table
from .configuration import CAN_PROTOCOLS, make_twin
from .memory import MemoryCanLine, MemorySerialLine
from .odrive import flat_endpoints
from .twin import DriveTwin, TwinClock

__all__ = [
    "TwinCanOpenAdapter",
    "TwinDynamixelAdapter",
    "TwinMitAdapter",
    "TwinMoteusAdapter",
    "TwinOdriveAdapter",
]

_Adapter = TypeVar("_Adapter", bound=JointAdapter)

# Reports every millisecond: what a user would set on the drive before calibrating it.
ODRIVE_REPORTS = {"encoder_period": 1e-3, "torques_period": 1e-3}


class TwinCanOpenAdapter(CanOpenAdapter):
    """CiA 402 on its twin."""

    twin: DriveTwin

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make twin and adapter; `TwinTable` lists the keys, without `link`."""
        line = MemoryCanLine()
        twin, table = _twin("canopen", configuration, line)
        return _joined(cls(convert(table, CanOpenConfiguration), lambda: line.link, TwinClock(twin)), twin)

    def _open(self) -> Capabilities:
        return replace(super()._open(), simulated=True)


class TwinMitAdapter(MitAdapter):
    """An MIT motor's twin."""

    twin: DriveTwin

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make twin and adapter; `TwinTable` lists the keys, without `link`."""
        line = MemoryCanLine()
        twin, table = _twin("mit", configuration, line)
        return _joined(cls(convert(table, MitConfiguration), lambda: line.link, TwinClock(twin)), twin)

    def _open(self) -> Capabilities:
        return replace(super()._open(), simulated=True)


class TwinOdriveAdapter(OdriveAdapter):
    """An ODrive's twin."""

    twin: DriveTwin

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make twin and adapter; `TwinTable` lists the keys, without `link`."""
        line = MemoryCanLine()
        twin, table = _twin("odrive", configuration, line)
        with TemporaryDirectory() as folder:
            path = Path(folder) / "flat_endpoints.json"
            path.write_text(json.dumps(flat_endpoints()), "utf-8")
            made = convert(table | {"endpoints": str(path)}, OdriveConfiguration)
            return _joined(cls(made, lambda: line.link, TwinClock(twin)), twin)

    def _open(self) -> Capabilities:
        return replace(super()._open(), simulated=True)


class TwinMoteusAdapter(MoteusAdapter):
    """A moteus' twin."""

    twin: DriveTwin

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make twin and adapter; `TwinTable` lists the keys, without `link`."""
        line = MemorySerialLine()
        twin, table = _twin("moteus", configuration, line)
        return _joined(cls(convert(table, MoteusConfiguration), lambda: line.link, TwinClock(twin)), twin)

    def _open(self) -> Capabilities:
        return replace(super()._open(), simulated=True)


class TwinDynamixelAdapter(DynamixelAdapter):
    """A Dynamixel's twin."""

    twin: DriveTwin

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make twin and adapter; `TwinTable` lists the keys, without `link`."""
        line = MemorySerialLine()
        twin, table = _twin("dynamixel", configuration, line)
        return _joined(cls(convert(table, DynamixelConfiguration), lambda: line.link, TwinClock(twin)), twin)

    def _open(self) -> Capabilities:
        return replace(super()._open(), simulated=True)


def _twin(
    protocol: str, configuration: Mapping[str, Any], line: MemoryCanLine | MemorySerialLine
) -> tuple[DriveTwin, dict[str, Any]]:
    """A twin on the line, and the configuration of its adapter."""
    wanted = {name: value for name, value in configuration.items() if name != "backend"}
    try:
        twin = make_twin(protocol, wanted, line, ODRIVE_REPORTS if protocol == "odrive" else {})
    except ParameterError as error:
        raise AdapterConfigurationError(str(error)) from error
    line.on_sent = twin.pump
    way = {"bus": {"interface": "virtual"}} if protocol in CAN_PROTOCOLS else {"serial": {"port": "loop://"}}
    return twin, way | adapter_table(protocol, twin, in_amperes=bool(wanted.get("in_amperes", False)))


def _joined(adapter: _Adapter, twin: DriveTwin) -> _Adapter:
    adapter.twin = twin  # type: ignore[attr-defined]
    return adapter
