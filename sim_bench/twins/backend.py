"""Backends `twin-canopen`, `twin-mit`, …: the real adapter on its twin in one process, in lock step.

Nothing but the wire is left out: the same encoding, state machines, watchdogs and quantisation as on hardware, and
equal runs are equal to the last bit.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, ClassVar, Self

from fricomp.adapters import JointAdapter
from fricomp.adapters.canopen import CanOpenAdapter
from fricomp.adapters.configuration import convert
from fricomp.adapters.dynamixel import DynamixelAdapter
from fricomp.adapters.mit import MitAdapter
from fricomp.adapters.moteus import MoteusAdapter
from fricomp.adapters.odrive import OdriveAdapter
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

# Reports every millisecond: what a user would set on the drive before calibrating it.
ODRIVE_REPORTS = {"encoder_period": 1e-3, "torques_period": 1e-3}


class _OnTwin(JointAdapter):
    """An adapter whose drives are a twin in the same process.

    Attributes:
        protocol: Of the twin.
        twin: The twin.
    """

    protocol: ClassVar[str]
    twin: DriveTwin

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make twin and adapter; `TwinTable` lists the keys, without `link`."""
        line = MemoryCanLine() if cls.protocol in CAN_PROTOCOLS else MemorySerialLine()
        twin, table = _make_twin(cls.protocol, configuration, line)
        adapter = cls._make(table, lambda: line.link, TwinClock(twin))
        adapter.twin = twin
        return adapter

    @classmethod
    def _make(cls, table: dict[str, Any], link: Callable[[], Any], clock: TwinClock) -> Self:
        make: Any = cls
        made: Self = make(convert(table, make.configuration_type), link, clock)
        return made

    def _open(self) -> Capabilities:
        adapter: Any = super()
        found: Capabilities = adapter._open()
        return replace(found, simulated=True)


class TwinCanOpenAdapter(_OnTwin, CanOpenAdapter):
    """CiA 402 on its twin."""

    protocol = "canopen"


class TwinMitAdapter(_OnTwin, MitAdapter):
    """An MIT motor's twin."""

    protocol = "mit"


class TwinOdriveAdapter(_OnTwin, OdriveAdapter):
    """An ODrive's twin."""

    protocol = "odrive"

    @classmethod
    def _make(cls, table: dict[str, Any], link: Callable[[], Any], clock: TwinClock) -> Self:
        with TemporaryDirectory() as folder:
            path = Path(folder) / "flat_endpoints.json"
            path.write_text(json.dumps(flat_endpoints()), "utf-8")
            return super()._make(table | {"endpoints": str(path)}, link, clock)


class TwinMoteusAdapter(_OnTwin, MoteusAdapter):
    """A moteus' twin."""

    protocol = "moteus"


class TwinDynamixelAdapter(_OnTwin, DynamixelAdapter):
    """A Dynamixel's twin."""

    protocol = "dynamixel"


def _make_twin(
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
