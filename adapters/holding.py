"""Drives that somebody else holds: they are asked, and left alone unless their user says otherwise."""

from collections.abc import Sequence
from typing import final

from fricomp.errors import AdapterError, DriveHeld

from .acceptance import raise_own
from .stopping import StoppableDriver

__all__ = ["POLL_INTERVAL_NS", "HeldDriver"]

POLL_INTERVAL_NS = 500_000
"""How often drives are looked at while waiting for an answer [ns]."""
STOPPING_NS = 100_000_000
"""How long a drive may go on saying that it is energised after a stop of ours [ns]: ten cycles at 100 Hz."""


class HeldDriver(StoppableDriver):
    """The half of every adapter that looks who holds the drives before it writes anything to them."""

    _may_take_over = False
    _is_ours = False  # energised by this adapter, and not seen limp since: a stop may have been lost on its way
    _taken_over: tuple[str, ...] = ()

    @property
    @final
    def taken_over(self) -> tuple[str, ...]:
        """Names of the joints that somebody else had energised when `open(take_over=True)` stopped them."""
        return self._taken_over

    def _find_energised(self) -> Sequence[bool | None]:
        """Ask every drive whether it is energised, without writing anything to it; None where it does not tell."""
        return [None] * len(self.options.limits)

    def _joint_names(self) -> Sequence[str]:
        """Names of the joints, as configured."""
        return [f"joint {number}" for number in range(len(self.options.limits))]

    @final
    def _read_energised(self) -> Sequence[bool | None]:
        """Whether each drive says now that it is energised; None where it does not tell. Only reads."""
        try:
            found = self._find_energised()
        except BaseException as error:
            raise_own(error)
        self._is_ours = self._is_ours and any(found)
        return found

    @final
    def _refuse_held(self) -> None:
        """Let nobody write to a drive that somebody else has energised; what this adapter has energised is stopped.

        Raises:
            DriveHeld: A drive is energised, and not by this adapter. Nothing has been written to any drive.
        """
        held = self._find_held()
        if held and self._may_take_over:
            self._take_over_from(held)
            self._await_limp()
        elif held and self._is_ours:
            self._stop_drives()
            self._await_limp()
        elif held:
            raise DriveHeld(
                f"energised by somebody else: {', '.join(held)}; nothing was written. Stop that program, or take over, "
                f"which lets the joints go limp: {self._command_line('clear', '--take-over')}"
            )

    def _await_limp(self) -> None:
        """Wait until a stop has arrived.

        Raises:
            DriveHeld: It has, and a drive is energised all the same.
        """
        deadline = self.clock.now_ns() + STOPPING_NS
        while held := self._find_held():
            if self.clock.now_ns() >= deadline:
                raise DriveHeld(
                    f"energised again after it was stopped: {', '.join(held)}; another program commands it: stop that"
                )
            self.clock.sleep_until(self.clock.now_ns() + POLL_INTERVAL_NS)

    def _find_held(self) -> tuple[str, ...]:
        names = self._joint_names()
        return tuple(name for name, on in zip(names, self._read_energised(), strict=True) if on)

    def _take_over_from(self, held: tuple[str, ...]) -> None:
        """Zero torque and de-energise what somebody else holds, once; whoever energises it again keeps it."""
        self._may_take_over = False
        try:
            self._take_over()
        except Exception as error:
            raise AdapterError(f"{', '.join(held)} could not be taken over: {error}") from error
        self._taken_over = held
