"""The half that all CAN adapters share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import final

from fricomp.joint import Clock

from .configuration import CanAdapterConfiguration, JointConfiguration, options_of
from .link import CanFrame, CanLink, open_can_link
from .link_adapter import LinkAdapter

__all__ = ["CanAdapter"]


class CanAdapter(LinkAdapter[CanLink]):
    """N drives on one CAN bus; see `LinkAdapter`.

    Args:
        configuration: Of bus and adapter.
        joints: In its order.
        open_link: Makes the link; as configured unless given.
        clock: Real time unless a simulation brings its own.
        parts: Messages that make up the state of one joint.
    """

    def __init__(
        self,
        configuration: CanAdapterConfiguration,
        joints: Sequence[JointConfiguration],
        open_link: Callable[[], CanLink] | None,
        clock: Clock | None,
        *,
        parts: int = 1,
    ) -> None:
        super().__init__(
            options_of(configuration, joints),
            open_link or (lambda: open_can_link(configuration.bus)),
            clock,
            parts=parts,
        )

    @abstractmethod
    def _on_frame(self, frame: CanFrame) -> None:
        """Take in one frame."""

    @final
    def _send(self, frames: Sequence[CanFrame]) -> None:
        self._opened_link.send(frames)

    @final
    def _pump(self) -> None:
        for frame in self._opened_link.receive():
            self._on_frame(frame)
