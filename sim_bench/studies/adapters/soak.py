"""A joint in its loop behind every adapter and twin for a long time, with faults at random: what stops it, and when.

Between the faults the joint moves slowly, stands still, turns round and hurries: nothing may stop it there. The faults
are those of links (`fricomp.testing.FAULTS`, a cable that is pulled, a line that dies), of drives, and of sensors that
lie. Each ends at zero torque, and nothing goes on before faults were cleared and the joint was enabled again.
"""

import gc
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf, pi, sin
from typing import Any

from fricomp.adapters import adapter_class
from fricomp.errors import FricompError
from fricomp.joint import JointCommand, JointFeedback, await_feedback
from fricomp.testing import FAULTS, FaultyLink

from ...stand_in.sensor import Reading
from .fuzz import resident_bytes

__all__ = ["LIES", "SoakResult", "soak_adapter"]

PERIOD = 1e-3
STIFFNESS, DAMPING = 98.7, 6.3  # of a loop of 5 Hz on the default joint's 0.1 kg·m²
TORQUE_SHARE = 0.9  # of the gate's limit: a controller that saturates below it
AFTER_A_FAULT = 400  # cycles at most
FAST_ENOUGH, WANTED = 1.0, 0.05
"""A sensor that lies about a joint which goes on moving faster than this [rad/s] must be found within that time [s]."""

Lie = Callable[[Reading, Reading], Reading]
"""What is told, of the reading as the lie began and the true one."""

LIES: dict[str, Lie] = {
    "frozen": lambda first, true: first._replace(time_ns=true.time_ns),
    "position frozen": lambda first, true: true._replace(position=first.position),
    "velocity mirrored": lambda first, true: true._replace(velocity=-true.velocity),
    "sensor mirrored": lambda first, true: true._replace(
        position=2.0 * first.position - true.position, velocity=-true.velocity
    ),
    "jump": lambda first, true: true._replace(position=true.position + 0.5),
}
"""Sensors that lie, by name."""

CONSISTENT = ("sensor mirrored",)
"""Lies that do not contradict themselves: what the joint makes of its torque tells, and travel is bounded, not time."""


@dataclass
class SoakResult:
    """What a soak run did.

    Attributes:
        protocol: Which.
        n_ticks: Control cycles in all.
        n_healthy: Of them those without a fault.
        false_trips: What stopped a healthy joint; nothing may.
        n_faults: How often each fault was tried.
        n_stops: How often it stopped the joint.
        slowest: Longest time from the beginning of a lie about a joint that goes on moving to the stop [s]; of `LIES`.
        foreign: Exceptions that are not the library's; none may be.
        still_torque: How often torque was left after an end; never may be.
        largest_torque: Of all that the drive exerted, over its limit and a step [1]; at most 1.
        memory_growth: Of the process over the second half of the run [byte].
    """

    protocol: str
    n_ticks: int = 0
    n_healthy: int = 0
    false_trips: list[str] = field(default_factory=list)
    n_faults: dict[str, int] = field(default_factory=dict)
    n_stops: dict[str, int] = field(default_factory=dict)
    slowest: dict[str, float] = field(default_factory=dict)
    foreign: list[str] = field(default_factory=list)
    still_torque: int = 0
    largest_torque: float = 0.0
    memory_growth: int = 0

    @property
    def passed(self) -> bool:
        """Whether nothing healthy was stopped, every lie was, nothing foreign came, and torque kept its limits."""
        is_late = any(time > WANTED for lie, time in self.slowest.items() if lie not in CONSISTENT)
        return not (self.false_trips or self.foreign or self.still_torque or is_late) and self.largest_torque <= 1.0


class LyingSensor:
    """A twin's sensor that may be told to lie.

    Args:
        sensor: The true one.
    """

    def __init__(self, sensor: Any) -> None:
        self._sensor = sensor
        self._lie: Lie | None = None
        self._first: Reading = sensor.newest

    def tell(self, lie: Lie | None) -> None:
        """Lie from now on, or be honest again."""
        self._lie = lie
        self._first = self._sensor.newest

    @property
    def newest(self) -> Reading:
        """What is told."""
        true: Reading = self._sensor.newest
        return true if self._lie is None else self._lie(self._first, true)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._sensor, name)


def soak_adapter(protocol: str, n_ticks: int, seed: int) -> SoakResult:
    """Run the loop of one joint, healthy for a while and with a fault for a while, by turns.

    Args:
        protocol: One of the twins'.
        n_ticks: Control cycles in all.
        seed: Of motions and faults.
    """
    soak = _Soak(protocol, seed)
    try:
        soak.run(n_ticks // 2)
        gc.collect()
        before = resident_bytes()
        soak.run(n_ticks)
        gc.collect()
        soak.result.memory_growth = resident_bytes() - before
    finally:
        soak.adapter.close()
    return soak.result


class _Soak:
    def __init__(self, protocol: str, seed: int) -> None:
        self.result, self.rng = SoakResult(protocol), random.Random(seed)
        twin_adapter: Any = adapter_class(f"twin-{protocol}")
        self.adapter = twin_adapter.from_configuration({})
        self.twin = self.adapter.twin
        open_link = self.adapter._open_link
        self.link = FaultyLink(open_link())
        self.adapter._open_link = lambda: self.link
        axis = self.twin.drives[0].axis
        self.sensor = axis._sensor = LyingSensor(axis._sensor)
        self.command, self.feedback = JointCommand(1), JointFeedback(1)
        self.adapter.open()
        self.limit = self.adapter.options.limits[0].torque
        self.faults: dict[str, Callable[[], None]] = {
            **{f"link {name}": self._spoiling(name) for name in FAULTS},
            "link silent": lambda: setattr(self.link, "silent", True),
            "link dead": lambda: setattr(self.link, "dead", True),
            "power cycle": self.twin.power_cycle,
            **{name: self._lying(name) for name in LIES},
        }

    def _spoiling(self, name: str) -> Callable[[], None]:
        return lambda: setattr(self.link, "incoming", FAULTS[name](self.rng))

    def _lying(self, name: str) -> Callable[[], None]:
        return lambda: self.sensor.tell(LIES[name])

    def run(self, until: int) -> None:
        """Healthy stretches and faults by turns."""
        while self.result.n_ticks < until:
            self._recover()
            self._healthy(self.rng.randrange(500, 3000))
            if self.adapter.enabled:
                self._fault(self.rng.choice(list(self.faults)))

    def _recover(self) -> None:
        """All is mended; the joint is put back to the middle, limp."""
        self.link.silent = self.link.dead = False
        self.link.incoming = None
        self.sensor.tell(None)
        stand_in, clock = self.twin.stand_in, self.adapter.clock
        clock.sleep_until(clock.now_ns() + 300_000_000)
        if abs(stand_in.torque[0]) > 0.0:
            self.result.still_torque += 1
        stand_in.plant.reset([0.0])
        clock.sleep_until(clock.now_ns() + 200_000_000)  # filters and delays forget where it was
        self.adapter.clear_faults()
        self.adapter.configure("torque", PERIOD)
        await_feedback(self.adapter, self.feedback, PERIOD)
        self.adapter.enable()

    def _healthy(self, n_ticks: int) -> None:
        motion = self._motion()
        for tick in range(n_ticks):
            self.result.n_healthy += 1
            if not self._guarded_tick(motion(tick * PERIOD)):
                self.result.false_trips.append(str(self.adapter.gate.trip_record))
                return

    def _motion(self) -> Callable[[float], float]:
        """A reference over time: at rest, slow, to and fro, or fast; a ramp begins where the joint is."""
        at, kind = self.feedback.position[0], self.rng.randrange(4)
        speed = self.rng.choice((-1.0, 1.0)) * self.rng.uniform(0.002, 0.05)
        amplitude, frequency = self.rng.uniform(0.02, 0.4), self.rng.uniform(0.1, 1.5)
        if kind == 0:
            return lambda time: at
        if kind == 1:
            return lambda time: at + speed * time
        return lambda time: at + amplitude * sin(2.0 * pi * frequency * time) * min(time, 1.0)

    def _fault(self, name: str) -> None:
        result, motion = self.result, self._motion()
        result.n_faults[name] = result.n_faults.get(name, 0) + 1
        is_moving = self._is_moving()
        self.faults[name]()
        ends = AFTER_A_FAULT
        for tick in range(ends):
            is_moving = is_moving and (tick * PERIOD > WANTED or self._is_moving())
            if not self._guarded_tick(motion(tick * PERIOD)):
                result.n_stops[name] = result.n_stops.get(name, 0) + 1
                if is_moving and name in LIES:
                    result.slowest[name] = max(result.slowest.get(name, 0.0), tick * PERIOD)
                return
        if is_moving and name in LIES:
            result.slowest[name] = inf
        self._guard(lambda: self.adapter.safe_stop("end of the fault"))

    def _is_moving(self) -> bool:
        return bool(abs(self.twin.stand_in.plant.velocity(0)) > FAST_ENOUGH)

    def _guarded_tick(self, reference: float) -> bool:
        return bool(self._guard(lambda: self._tick(reference)))

    def _guard(self, call: Callable[[], bool | None]) -> bool | None:
        try:
            return call()
        except FricompError:
            return False
        except Exception as error:  # exactly what must not happen; it is the result
            self.result.foreign.append(repr(error)[:200])
            return False

    def _tick(self, reference: float) -> bool:
        adapter, feedback, clock = self.adapter, self.feedback, self.adapter.clock
        self.result.n_ticks += 1
        wanted = STIFFNESS * (reference - feedback.position[0]) - DAMPING * feedback.velocity[0]
        most = TORQUE_SHARE * self.limit
        self.command.torque[0] = max(-most, min(most, wanted))
        if not adapter.write(self.command):
            return False
        clock.sleep_until(clock.now_ns() + round(PERIOD * 1e9))
        adapter.read_into(feedback)
        bound = self.limit + adapter.capabilities.joints[0].torque_quantum
        exerted = abs(self.twin.stand_in.torque[0]) / (bound * (1.0 + 1e-9))
        self.result.largest_torque = max(self.result.largest_torque, exerted)
        return bool(adapter.enabled)
