"""The half that all adapters on a serial port share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import final

from fricomp.joint import Clock

from .configuration import JointConfiguration, SerialAdapterConfiguration, options_of
from .link import SerialLink, open_serial_link
from .link_adapter import LinkAdapter

__all__ = ["SerialAdapter"]


class SerialAdapter(LinkAdapter[SerialLink]):
    """N drives on one serial port; see `LinkAdapter`.

    Args:
        configuration: Of bus and adapter.
        joints: In its order.
        open_link: Makes the link; as configured unless given.
        clock: Real time unless a simulation brings its own.
        parts: Messages that make up the state of one joint.
    """

    def __init__(
        self,
        configuration: SerialAdapterConfiguration,
        joints: Sequence[JointConfiguration],
        open_link: Callable[[], SerialLink] | None,
        clock: Clock | None,
        *,
        parts: int = 1,
    ) -> None:
        super().__init__(
            options_of(configuration, joints),
            open_link or (lambda: open_serial_link(configuration.serial)),
            clock,
            parts=parts,
        )

    @abstractmethod
    def _on_bytes(self, data: bytes) -> None:
        """Take in bytes as they come, in any pieces."""

    @final
    def _send(self, data: bytes) -> None:
        self._opened_link.send(data)

    @final
    def _pump(self) -> None:
        data = self._opened_link.receive()
        if data:
            self._on_bytes(data)
