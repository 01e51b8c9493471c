"""The half that all CAN adapters share."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import final

from .can_bus import open_can_link
from .configuration import CanAdapterConfiguration
from .link import CanFrame, CanLink
from .link_adapter import LinkAdapter


class CanAdapter(LinkAdapter[CanAdapterConfiguration, CanLink]):
    """N drives on one CAN bus; see `LinkAdapter`."""

    @staticmethod
    @final
    def _link_of(configuration: CanAdapterConfiguration) -> CanLink:
        return open_can_link(configuration.bus)

    @abstractmethod
    def _on_frame(self, frame: CanFrame) -> None:
        """Take in one frame."""

    @final
    def _send(self, frames: Sequence[CanFrame]) -> None:
        self._opened_link.send(frames)

    @final
    def _bus_health(self) -> dict[str, float | str]:
        return {"bus_errors": float(getattr(self._link, "n_errors", 0))}

    @final
    def _pump(self) -> None:
        for frame in self._opened_link.receive():
            self._on_frame(frame)
