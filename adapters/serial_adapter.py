"""The half that all adapters on a serial port share."""

from abc import abstractmethod
from typing import final

from .configuration import SerialAdapterConfiguration
from .link import SerialLink, open_serial_link
from .link_adapter import LinkAdapter


class SerialAdapter(LinkAdapter[SerialAdapterConfiguration, SerialLink]):
    """N drives on one serial port; see `LinkAdapter`."""

    @staticmethod
    @final
    def _link_of(configuration: SerialAdapterConfiguration) -> SerialLink:
        return open_serial_link(configuration.serial)

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
