"""The half of every adapter that answers what its user asks of drives and bus, whatever the joints do."""

from collections.abc import Sequence
from typing import final

from fricomp.errors import AdapterError
from fricomp.joint import Capabilities, Clock

from .acceptance import raise_own
from .holding import HeldDriver
from .options import AdapterOptions


class AnsweringDriver(HeldDriver):
    """A driver that tells what it offers, who is energised, and which faults there are."""

    def __init__(self, options: AdapterOptions, clock: Clock | None = None) -> None:
        super().__init__(options, clock)
        self._capabilities: Capabilities | None = None
        self._close_failure = ""

    @property
    @final
    def capabilities(self) -> Capabilities:
        """What the drives offer, joint side.

        Raises:
            AdapterError: The adapter is not open.
        """
        if self._capabilities is None:
            raise AdapterError("the adapter is not open: call open() first")
        return self._capabilities

    @final
    def read_energised(self) -> tuple[bool | None, ...]:
        """Ask each drive at rest whether it is energised, and write nothing; None where its protocol does not tell.

        Raises:
            AdapterError: Not open, the joints are enabled, or a drive does not answer.
        """
        if len(self.capabilities.joints) and self._enabled:
            raise AdapterError("the joints are enabled: they are energised by this adapter")
        with self._lock:
            return tuple(self._read_energised())

    @final
    def ask_faults(self) -> tuple[int, ...]:
        """Ask the drives which faults they report now, in codes; nothing is judged or stopped. None told is 0.

        Raises:
            AdapterError: Not open, or the bus failed.
        """
        n_joints = len(self.capabilities.joints)
        with self._lock:
            try:
                return tuple(self._ask_faults() or [0] * n_joints)
            except BaseException as error:
                raise_own(error)

    @final
    def describe_faults(self, codes: Sequence[int]) -> str:
        """What drives report, in words: the fault code of each joint, as in `JointFeedback.fault`."""
        told = []
        for joint, (name, code) in enumerate(zip(self._joint_names(), codes, strict=True)):
            if code:
                words = self._describe_fault(joint, code)
                told.append(f"{name}: {words} ({code:#x})" if words else f"{name}: {code:#x}")
        return "; ".join(told)

    @final
    def health(self) -> dict[str, float | str]:
        """Counters and states of bus and drives, for display.

        `stop_failure` and `close_failure` are among them if a stop did not get through, or the bus did not close.
        """
        health = self._health() | self._bus_health()
        if self._stop_failure:
            health["stop_failure"] = self._stop_failure
        if self._close_failure:
            health["close_failure"] = self._close_failure
        return health

    def _bus_health(self) -> dict[str, float | str]:
        """What the bus itself counts; adapters on one tell it."""
        return {}
