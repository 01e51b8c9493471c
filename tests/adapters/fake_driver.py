"""A driver without hardware that records every call and fails when told to."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any, Self

from fricomp.adapters import AdapterOptions, JointAdapter
from fricomp.control import JointLimits
from fricomp.joint import Capabilities, CommandMode, JointCapabilities, JointCommand, JointFeedback, Watchdog

LIMITS = JointLimits(torque=2.0, torque_rate=1e6, velocity=10.0, position=(-3.0, 3.0))
PERIOD = 0.001
CONFIRMED = Watchdog(0.05, confirmed=True)


class ManualClock:
    """Time that moves only when told to."""

    def __init__(self) -> None:
        self.time_ns = 1_000_000_000

    def now_ns(self) -> int:
        return self.time_ns

    def sleep_until(self, deadline_ns: int) -> None:
        self.time_ns = max(self.time_ns, deadline_ns)

    def advance(self, seconds: float) -> None:
        self.time_ns += round(seconds * 1e9)


class FakeAdapter(JointAdapter):
    """Keeps a log of what reached the drive; `fail[name]` raises or runs in place of the call of that name."""

    def __init__(self, options: AdapterOptions | None = None, watchdog: Watchdog | None = CONFIRMED) -> None:
        self.manual_clock = ManualClock()
        super().__init__(options or AdapterOptions(limits=(LIMITS,), ramp_time=0.0), self.manual_clock)
        self.watchdog = watchdog
        self.log: list[str] = []
        self.sent: list[float] = []
        self.references: list[tuple[float, float]] = []
        self.fail: dict[str, BaseException | Callable[[], None]] = {}
        self.position = 0.5
        self.velocity = 0.0
        self.torque = 0.0
        self.fault = 0
        self.fresh = True
        self.reports_temperature = True
        self.position_limits: tuple[float, float] | None = None
        self.taken_ns: int | None = None

    def step(self, name: str) -> None:
        self.log.append(name)
        failure = self.fail.get(name)
        if isinstance(failure, BaseException):
            raise failure
        if failure is not None:
            failure()

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        return cls()

    def _open(self) -> Capabilities:
        self.step("open")
        joint = JointCapabilities(
            "j",
            torque_limit=5.0,
            velocity_limit=50.0,
            torque_quantum=0.01,
            reports_temperature=self.reports_temperature,
            position_limits=self.position_limits,
        )
        return Capabilities((joint,), ("torque", "velocity", "position"), 1000.0, self.watchdog)

    def _configure(self, mode: CommandMode, period: float) -> None:
        self.step("configure")

    def _enable(self) -> None:
        self.step("enable")

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        self.step("write")
        self.sent.append(command.torque[0])
        self.references.append((command.velocity[0], command.position[0]))

    def _read_into(self, feedback: JointFeedback) -> bool:
        self.step("read")
        if self.fresh:
            feedback.time_ns = self.clock.now_ns() if self.taken_ns is None else self.taken_ns
            feedback.position[0], feedback.velocity[0], feedback.torque[0] = self.position, self.velocity, self.torque
            feedback.fault[0] = self.fault
        return self.fresh

    def _stop(self) -> None:
        self.step("stop")

    def _clear_faults(self) -> None:
        self.step("clear")

    def _close(self) -> None:
        self.step("close")


def enabled_adapter(mode: CommandMode = "torque", **arguments: Any) -> FakeAdapter:
    """A fake adapter, opened, configured and enabled."""
    adapter = FakeAdapter(**arguments)
    adapter.open()
    adapter.configure(mode, PERIOD)
    adapter.enable()
    return adapter


def command(torque: float = 0.0, velocity: float = 0.0, position: float = 0.0) -> JointCommand:
    """A command for one joint."""
    made = JointCommand(1)
    made.torque[0], made.velocity[0], made.position[0] = torque, velocity, position
    return made


def run_in_thread(call: Callable[[], None]) -> None:
    """Run `call` in another thread to its end."""
    thread = threading.Thread(target=call)
    thread.start()
    thread.join(timeout=5.0)
    assert not thread.is_alive()
