"""`--from` and `--to`: the part of a recording that a command takes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Annotated

from fricomp.cli.option.panel import log_option
from fricomp.errors import ParameterError

if TYPE_CHECKING:
    from fricomp.arm.log import ArmLog
    from fricomp.recording import Recording

From = Annotated[float | None, log_option("--from", help="Leave out what is before this time [s].")]
To = Annotated[float | None, log_option("--to", help="Leave out what is from this time on [s].")]


@dataclass(frozen=True)
class Cut:
    """A part of the time that a recording states.

    Attributes:
        start: First time that is taken [s]; None for the beginning.
        stop: First time that is not taken any more [s]; None for the end.

    Raises:
        ParameterError: The part ends before it begins.
    """

    start: float | None = None
    stop: float | None = None

    def __post_init__(self) -> None:
        low, high = self._edges
        if not low < high:
            raise ParameterError(f"--from {low:g} is not before --to {high:g}: give times of the recording [s]")

    @property
    def _edges(self) -> tuple[float, float]:
        return (-inf if self.start is None else self.start, inf if self.stop is None else self.stop)

    @property
    def given(self) -> dict[str, bool]:
        """Each option, and whether it stands on the command line."""
        return {"--from": self.start is not None, "--to": self.stop is not None}

    def apply(self, recording: Recording) -> Recording:
        """The part of a recording.

        Raises:
            RecordingError: Nothing is left of it.
        """
        return recording.window(*self._edges) if any(self.given.values()) else recording

    def apply_to_log(self, log: ArmLog) -> ArmLog:
        """The part of the log of an arm, of all its joints alike.

        Raises:
            RecordingError: Nothing is left of a joint.
        """
        return replace(log, sessions=tuple(tuple(self.apply(one) for one in session) for session in log.sessions))
