"""The adapter's side of a twin: a configuration file that reaches it, so that nobody has to write one to try it."""

import json
from collections.abc import Mapping
from typing import Any

from fricomp.errors import ParameterError

from ..stand_in import default_limits
from .configuration import CAN_PROTOCOLS, PROTOCOLS
from .port import BytePort
from .twin import DriveTwin

__all__ = ["adapter_configuration", "adapter_table", "twin_address"]

VELOCITY_SHARE = 0.8
LARGEST_DAMPING = 5.0  # of every MIT dialect that has a twin


def twin_address(twin: DriveTwin) -> str | None:
    """What pyserial opens to reach a twin; None where it sits on a python-can bus."""
    port: Any = getattr(twin, "port", None)
    carrier: BytePort = getattr(port, "port", port)
    return getattr(carrier, "address", None)


def adapter_table(protocol: str, twin: DriveTwin, *, in_amperes: bool = False) -> dict[str, Any]:
    """What the adapter of this protocol is to know of the drives, with the limits of the simulated ones.

    Args:
        protocol: One of `PROTOCOLS`.
        twin: Of this protocol.
        in_amperes: Leave the torque constants out, where the adapter can do without.
    """
    joints = []
    names = [joint.name for joint in twin.stand_in.settings.joints]
    for name, limits, drive in zip(names, default_limits(twin.stand_in), twin.drives, strict=True):
        torque, velocity = drive.settings.ranges
        allowed: dict[str, Any] = {
            "torque": min(limits.torque, torque * drive.axis.gear_ratio),
            "torque_rate": limits.torque_rate,
            "velocity": VELOCITY_SHARE * min(limits.velocity, velocity / drive.axis.gear_ratio),
        }
        if limits.position is not None:
            allowed["position"] = list(limits.position)
        joint = {"name": name, **drive.settings.adapter_entry(), **_gains(protocol, drive), "limits": allowed}
        if in_amperes and protocol == "dynamixel":
            constant = joint.pop("torque_constant")
            allowed["torque"] /= constant
            allowed["torque_rate"] /= constant
        if drive.axis.gear_ratio != 1.0:
            joint["transmission"] = {"gear_ratio": drive.axis.gear_ratio}
        joints.append(joint)
    return {"joints": joints}


def _gains(protocol: str, drive: Any) -> dict[str, float]:
    """Gains of the velocity mode of MIT motors: as damped as suits the joint, softer where its range ends before."""
    if protocol != "mit":
        return {}
    stiffness, damping = drive.axis.loop_gains
    share = min(1.0, LARGEST_DAMPING / damping)
    return {"stiffness": stiffness * share**2, "damping": damping * share}


def adapter_configuration(protocol: str, twin: DriveTwin, endpoints: str = "") -> str:
    """TOML text of a configuration that reaches a twin.

    Args:
        protocol: One of `PROTOCOLS`.
        twin: Reached over a serial line or TCP.
        endpoints: Path of the ODrive twin's `flat_endpoints.json`.

    Raises:
        ParameterError: The twin sits on a python-can bus, which its owner knows how to configure.
    """
    address = twin_address(twin)
    if protocol not in PROTOCOLS or address is None:
        raise ParameterError("an adapter configuration is written for a twin on a pty or TCP socket")
    # Two processes on a busy machine keep each other waiting for longer than a drive on its bus would.
    head: dict[str, Any] = {"backend": protocol, "stale_after": 0.2, "watchdog": 0.5, "response_timeout": 1.0}
    if protocol == "odrive":
        head["endpoints"] = endpoints
    if protocol == "canopen":
        head["heartbeat"] = 0.2
    way = {"interface": "slcan-chunked", "channel": address} if protocol in CAN_PROTOCOLS else {"port": address}
    sections = [_lines(head), ["[bus]" if protocol in CAN_PROTOCOLS else "[serial]", *_lines(way)]]
    sections += [["[[joints]]", *_lines(joint)] for joint in adapter_table(protocol, twin)["joints"]]
    return "\n\n".join("\n".join(section) for section in sections) + "\n"


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{name} = {_toml(value)}" for name, value in table.items()]


def _toml(value: Any) -> str:
    """A TOML value; strings, numbers and lists are written as in JSON."""
    if isinstance(value, dict):
        return "{ " + ", ".join(_lines(value)) + " }"
    return json.dumps(value)
