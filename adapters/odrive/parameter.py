"""The half of the ODrive adapter that writes parameters and reads them back: watchdog, mode, and torque limit."""

from collections.abc import Callable
from math import inf, isclose, isnan
from typing import TypeVar

from fricomp.errors import AdapterConfigurationError, AdapterTimeout
from fricomp.joint import Clock, CommandMode

from ..can_adapter import CanAdapter
from ..link import CanFrame, CanLink
from .codec import CONTROL_MODES, PASSTHROUGH, Command, plain_frame, request_frame
from .configuration import OdriveConfiguration
from .endpoint import (
    CONTROL_MODE,
    ENABLE_WATCHDOG,
    HIGHEST_TORQUE,
    INPUT_MODE,
    LOWEST_TORQUE,
    WATCHDOG_TIMEOUT,
    Endpoint,
    read_endpoints,
)

__all__ = ["HOW_TO_BOUND", "ParameterAdapter"]

Answer = TypeVar("Answer")

HOW_TO_BOUND = (
    f"not offered: nothing would bound the torque of the drive's own loop; on firmware 0.6 give endpoints "
    f"with {HIGHEST_TORQUE} and {LOWEST_TORQUE}"
)


class ParameterAdapter(CanAdapter):
    """Nodes whose parameters can be asked for, where the endpoints of their firmware are known.

    Args:
        configuration: Bus and axes.
        open_link: Makes the link; python-can as configured unless given.
        clock: Real time unless a simulation brings its own.
    """

    def __init__(
        self, configuration: OdriveConfiguration, open_link: Callable[[], CanLink] | None, clock: Clock | None
    ) -> None:
        super().__init__(configuration, configuration.joints, open_link, clock, parts=2)
        self._configuration = configuration
        self._nodes = [joint.id for joint in configuration.joints]
        self._version, self._endpoints = "", dict[str, Endpoint]()
        if configuration.endpoints is not None:
            self._version, self._endpoints = read_endpoints(configuration.endpoints)
        self._answers: list[bytes | None] = [None] * len(self._nodes)

    def _take_answer(self, joint: int, data: bytes) -> None:
        self._answers[joint] = data

    def _ask(self, joint: int, request: CanFrame, decode: Callable[[bytes], Answer | None]) -> Answer:
        """Send a request and wait for an answer that `decode` accepts."""
        found: list[Answer] = []

        def answered() -> bool:
            data, self._answers[joint] = self._answers[joint], None
            value = None if data is None else decode(data)
            if value is not None:
                found.append(value)
            return bool(found)

        self._answers[joint] = None
        self._send([request])
        complaint = f"node {self._nodes[joint]} did not answer"
        self._wait(answered, self._response_timeout, complaint)
        return found[0]

    def _set_endpoint(self, joint: int, name: str, value: float) -> bool:
        """Write an endpoint and read it back; whether it kept the value."""
        endpoint = self._endpoints[name]
        node = self._nodes[joint]
        self._send([plain_frame(node, Command.WRITE_ENDPOINT, endpoint.write_request(value))])
        return isclose(self._read_endpoint(joint, endpoint), value, rel_tol=1e-6)

    def _read_endpoint(self, joint: int, endpoint: Endpoint) -> float:
        request = plain_frame(self._nodes[joint], Command.WRITE_ENDPOINT, endpoint.read_request())
        return self._ask(joint, request, endpoint.decode)

    def _check_version(self) -> None:
        """What the nodes say must be the firmware that is configured: its heartbeats and reports differ.

        The numbers of endpoints hold for one version only: another would be written somewhere else.

        Raises:
            AdapterConfigurationError: A node runs another firmware.
        """
        for joint, node in enumerate(self._nodes):
            found = self._find_version(joint)
            generation = "0.6" if found else "0.5"  # which has no such answer
            if generation != self._configuration.firmware:
                says = f"says that it runs firmware {found}" if found else "does not tell its version, as 0.5 does not"
                raise AdapterConfigurationError(
                    f'node {node} {says}: write firmware = "{generation}" into the configuration'
                )
            if self._endpoints and found != self._version.lstrip("v").partition("-")[0]:
                raise AdapterConfigurationError(
                    f"node {node} runs firmware {found}, {self._configuration.endpoints} is of {self._version}: "
                    f"get the file of the node's own firmware"
                )

    def _find_version(self, joint: int) -> str:
        """The version of a node's firmware; empty where it does not tell."""
        request = request_frame(self._nodes[joint], Command.VERSION)
        try:
            answer = self._ask(joint, request, lambda data: data if len(data) == 8 else None)
        except AdapterTimeout:
            return ""
        return ".".join(str(part) for part in answer[4:7])

    @property
    def _is_bounded(self) -> bool:
        """Whether the drive can be told the highest torque of its own loop, and asked whether it has understood."""
        return HIGHEST_TORQUE in self._endpoints and LOWEST_TORQUE in self._endpoints

    def _own_torque_limit(self, joint: int) -> float:
        """The torque that the axis lets through as it is now, the same both ways [N·m]; infinite where not known."""
        if not self._is_bounded:
            return inf
        found = {name: self._read_endpoint(joint, self._endpoints[name]) for name in (HIGHEST_TORQUE, LOWEST_TORQUE)}
        if any(map(isnan, found.values())):
            raise AdapterConfigurationError(f"node {self._nodes[joint]} has {found}: set them to numbers")
        return max(min(found[HIGHEST_TORQUE], -found[LOWEST_TORQUE]), 0.0)

    def _bound_torque(self, joint: int, mode: CommandMode) -> None:
        """Tell the axis the limit for its own loop and read it back; in torque mode the gate is all there is.

        Raises:
            AdapterConfigurationError: It does not keep it.
        """
        if mode == "torque":
            return
        highest = self._torques_at_drives()[joint]
        for name, value in ((HIGHEST_TORQUE, highest), (LOWEST_TORQUE, -highest)):
            if not self._set_endpoint(joint, name, value):
                raise AdapterConfigurationError(
                    f"node {self._nodes[joint]} does not keep {name} = {value:g}, which bounds its own loop: "
                    f"use torque mode, or the endpoints of its own firmware"
                )

    def _check_mode(self, joint: int, mode: CommandMode) -> None:
        for name, wanted in ((CONTROL_MODE, CONTROL_MODES[mode]), (INPUT_MODE, PASSTHROUGH)):
            if name in self._endpoints:
                found = self._read_endpoint(joint, self._endpoints[name])
                if found != wanted:
                    raise AdapterConfigurationError(
                        f"node {self._nodes[joint]} has {name} = {found:g} where {wanted} was written"
                    )

    def _set_watchdog(self, joint: int) -> bool:
        missing = [name for name in (ENABLE_WATCHDOG, WATCHDOG_TIMEOUT) if name not in self._endpoints]
        if missing:
            raise AdapterConfigurationError(f"{self._configuration.endpoints} has no endpoint {missing[0]}")
        return self._set_endpoint(joint, WATCHDOG_TIMEOUT, self._configuration.watchdog) and self._set_endpoint(
            joint, ENABLE_WATCHDOG, True
        )
