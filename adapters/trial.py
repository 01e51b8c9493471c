"""Trying a drive for the first time: step by step, at a twentieth of its torque limit or less."""

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf

from fricomp.control.number import is_number
from fricomp.errors import AdapterError, FricompError, ParameterError
from fricomp.joint import JointCapabilities, JointCommand, JointFeedback

from .adapter import JointAdapter

__all__ = ["LARGEST_SHARE", "TrialSettings", "TrialStep", "describe_energy", "try_drive"]

LARGEST_SHARE = 0.05
"""Of the configured torque limit; a trial never goes beyond."""

SILENCE_TRIED = 3.0  # in watchdog times
STATES_AWAITED = 40
"""Cycles after the silence in which the drives may tell what has stopped them."""


@dataclass(frozen=True)
class TrialStep:
    """What one step found.

    Attributes:
        name: What was tried.
        passed: Whether it was as it should be; None where the trial cannot tell.
        detail: What was found, with values.
    """

    name: str
    passed: bool | None
    detail: str


@dataclass(frozen=True)
class TrialSettings:
    """How a drive is tried.

    Attributes:
        period: Control period [s].
        share: Torque at most, as a share of the configured limit.
        ramp_time: Time to that torque [s].
        largest_motion: Motion that ends a ramp [rad] or [m].
        listen_time: How long the state is listened to [s].
        take_over: Stop drives that somebody else has energised, in place of refusing them.

    Raises:
        ParameterError: The share is above 0.05, or a value not positive.
    """

    period: float = 0.005
    share: float = LARGEST_SHARE
    ramp_time: float = 1.0
    largest_motion: float = 0.05
    listen_time: float = 0.5
    take_over: bool = False

    def __post_init__(self) -> None:
        if not (is_number(self.share, 0.0, LARGEST_SHARE) and self.share > 0.0):
            raise ParameterError(
                f"a trial uses a share of the torque limit above 0 and of at most {LARGEST_SHARE}, got {self.share!r}"
            )
        for name in ("period", "ramp_time", "largest_motion", "listen_time"):
            if not (is_number(getattr(self, name), 0.0) and getattr(self, name) > 0.0):
                raise ParameterError(f"{name} must be finite and positive, got {getattr(self, name)!r}")


def try_drive(adapter: JointAdapter, settings: TrialSettings, may_energise: Callable[[], bool]) -> Generator[TrialStep]:
    """Open, configure, listen, energise at zero, push gently both ways, stop, and fall silent; one step at a time.

    Stops at the first step that fails, and leaves the adapter closed whatever happens.

    Args:
        adapter: Not opened yet. Its torque limits are cut down to the share for good.
        settings: How.
        may_energise: Asked once, before anything is energised; False ends the trial there.

    Yields:
        What each step found.
    """
    trial = _Trial(adapter, settings)
    try:
        for step in trial.steps(may_energise):
            yield step
            if step.passed is False:
                return
    except FricompError as error:
        yield TrialStep(trial.doing, False, str(error))
    finally:
        adapter.close()


class _Trial:
    def __init__(self, adapter: JointAdapter, settings: TrialSettings) -> None:
        self.adapter, self.settings = adapter, settings
        self.doing = "open"
        self._feedback = JointFeedback(len(adapter.options.limits))
        self._n_fresh = 0

    def steps(self, may_energise: Callable[[], bool]) -> Iterator[TrialStep]:
        yield self._open()
        yield self._configure()
        yield self._listen()
        if not may_energise():
            yield TrialStep("energise", None, f"not tried: not allowed to; {self._energy()}")
            return
        yield self._rest()
        for joint in range(len(self._feedback.position)):
            for sign in (1.0, -1.0):
                yield self._push(joint, sign)
        yield self._stop()
        if self.adapter.capabilities.watchdog is None:
            yield TrialStep("fall silent at zero torque", None, "not tried: there is no watchdog")
            return
        codes = self._fall_silent()
        yield self._judge_silence(codes)
        yield self._clear(codes)

    def _open(self) -> TrialStep:
        found = self.adapter.open(take_over=self.settings.take_over)
        taken = f"taken over, and limp now: {', '.join(self.adapter.taken_over)}; " if self.adapter.taken_over else ""
        joints = "; ".join(map(_describe_joint, found.joints))
        return TrialStep("open", True, f"{taken}{joints}; bus carries {found.highest_rate:.0f} Hz")

    def _configure(self) -> TrialStep:
        self.doing = "configure"
        options, share = self.adapter.options, self.settings.share
        limits = tuple(
            replace(
                limit,
                torque=share * limit.torque,
                torque_rate=min(limit.torque_rate, limit.torque),
                breakaway=limit.breakaway_torque,  # of the joint, whatever part of its torque is used
            )
            for limit in options.limits
        )
        self.adapter.options = replace(options, limits=limits)
        self.adapter.configure("torque", self.settings.period)
        watchdog = self.adapter.capabilities.watchdog
        if watchdog is None or not watchdog.confirmed:
            waived = "waived by the configuration" if options.allow_no_watchdog else "enabling will be refused"
            return TrialStep("configure", options.allow_no_watchdog, f"no confirmed watchdog: {waived}")
        fed = ", fed by mere reads, too" if watchdog.fed_by_reads else ""
        return TrialStep("configure", True, f"torque mode; watchdog of {watchdog.timeout:g} s read back{fed}")

    def _listen(self) -> TrialStep:
        self.doing = "listen"
        positions = self._collect(self.settings.listen_time)
        if not positions:
            return TrialStep("listen", False, "the drives report nothing")
        rate = self._n_fresh / self.settings.listen_time
        spreads = [max(column) - min(column) for column in zip(*positions, strict=True)]
        detail = f"{rate:.0f} states a second; positions moved by {_list(spreads)} while at rest"
        if any(self._feedback.fault):
            return TrialStep("listen", False, f"{detail}; {self.adapter.describe_faults(self._feedback.fault)}")
        return TrialStep("listen", rate > 0.5 / (self.settings.period * 10), detail)

    def _rest(self) -> TrialStep:
        self.doing = "energise at zero torque"
        self.adapter.enable()
        positions = self._collect(self.settings.listen_time, torque=lambda _: self._zeros())
        return self._judge_motion(positions)

    def _judge_motion(self, positions: Sequence[Sequence[float]]) -> TrialStep:
        if self.adapter.gate.tripped or not positions:
            return TrialStep(self.doing, False, f"stopped: {self.adapter.gate.trip_record}")
        moved = [last - first for first, last in zip(positions[0], positions[-1], strict=True)]
        held = all(abs(motion) <= self.settings.largest_motion for motion in moved)
        return TrialStep(self.doing, held, f"moved by {_list(moved)}" + ("" if held else ": a load moves the joint"))

    def _push(self, joint: int, sign: float) -> TrialStep:
        """Ramp torque on one joint until it moves; its direction tells whether the signs are right."""
        s, names = self.settings, self.adapter.capabilities.joints
        self.doing = f"push {names[joint].name} {'forward' if sign > 0 else 'backward'}"
        most = self.adapter.options.limits[joint].torque
        reached = 0.0

        def torque(elapsed: float) -> list[float]:
            nonlocal reached
            wanted = self._zeros()
            wanted[joint] = reached = sign * most * min(elapsed / s.ramp_time, 1.0)
            return wanted

        start = self._feedback.position[joint]
        self._collect(
            1.2 * s.ramp_time,
            torque,
            until=lambda: abs(self._feedback.position[joint] - start) > 0.5 * s.largest_motion,
        )
        moved = self._feedback.position[joint] - start
        self._collect(s.listen_time, torque=lambda _: self._zeros())
        if self.adapter.gate.tripped:
            return TrialStep(self.doing, False, f"stopped: {self.adapter.gate.trip_record}")
        quantum = max(2.0 * names[joint].position_quantum, 0.01 * s.largest_motion)
        detail = f"{reached:+.3g} {names[joint].torque_unit} moved it by {moved:+.3g}"
        if abs(moved) <= quantum:
            return TrialStep(self.doing, None, f"{detail}: friction or load hold it, so the sign cannot be told")
        if moved * sign < 0.0:
            return TrialStep(self.doing, False, f"{detail}: the wrong way; set sign = -1, or turn the drive's polarity")
        return TrialStep(self.doing, True, detail)

    def _stop(self) -> TrialStep:
        self.doing = "stop"
        self.adapter.safe_stop("end of the trial")
        failure = self.adapter.health().get("stop_failure")
        refused = not self.adapter.write(JointCommand(len(self._feedback.position)))
        passed = failure is None and refused
        return TrialStep(
            "stop", passed, "stopped, and torque is refused" if passed else f"{failure or 'torque passed'}"
        )

    def _fall_silent(self) -> list[int]:
        """Energise once more and fall silent, until the drives stop by themselves; the codes that they report then."""
        self.doing = "fall silent at zero torque"
        self.adapter.clear_faults()
        self.adapter.enable()
        self._collect(0.1, torque=lambda _: self._zeros())
        clock, watchdog = self.adapter.clock, self.adapter.capabilities.watchdog
        silence = SILENCE_TRIED * watchdog.timeout if watchdog is not None else 0.0
        clock.sleep_until(clock.now_ns() + round(silence * 1e9))
        codes = [0] * len(self._feedback.fault)
        with suppress(AdapterError):  # before anything stops them: one that has stopped alone may tell it until then
            codes = list(self.adapter.ask_faults())
        for _ in range(STATES_AWAITED):
            with suppress(AdapterError):  # such as heartbeats that have not been heard meanwhile
                if self.adapter.read_into(self._feedback):
                    codes = [new or old for new, old in zip(self._feedback.fault, codes, strict=True)]
            clock.sleep_until(clock.now_ns() + round(self.settings.period * 1e9))
        return codes

    def _judge_silence(self, codes: Sequence[int]) -> TrialStep:
        if any(codes):
            return TrialStep(
                self.doing, True, f"the drives stopped by themselves, and report {self.adapter.describe_faults(codes)}"
            )
        return TrialStep(self.doing, None, "our side stopped them; the drives do not tell whether they had already")

    def _clear(self, codes: Sequence[int]) -> TrialStep:
        """Clear what the silence has latched, and nothing else: the user has to see that first."""
        self.doing = "clear"
        foreign = [0 if code in self.adapter.watchdog_faults else code for code in codes]
        if any(foreign):
            hint = f"fricomp adapter clear {self.adapter.configuration_file or 'FILE'}"
            told = self.adapter.describe_faults(foreign)
            return TrialStep(self.doing, False, f"not the watchdog's: {told}; find out, then {hint}")
        self.adapter.clear_faults()
        return TrialStep(self.doing, True, f"cleared what the silence had latched; {self._energy()}")

    def _energy(self) -> str:
        return describe_energy([j.name for j in self.adapter.capabilities.joints], self.adapter.read_energised())

    # -- cycles -------------------------------------------------------------------------------------------------

    def _zeros(self) -> list[float]:
        return [0.0] * len(self._feedback.position)

    def _collect(
        self,
        seconds: float,
        torque: Callable[[float], list[float]] | None = None,
        until: Callable[[], bool] | None = None,
    ) -> list[list[float]]:
        """Positions of all joints over some cycles; with `torque` (of the time since the start) commanded."""
        adapter, clock, period_ns = self.adapter, self.adapter.clock, round(self.settings.period * 1e9)
        command = JointCommand(len(self._feedback.position))
        positions: list[list[float]] = []
        self._n_fresh, start = 0, clock.now_ns()
        due = start
        while clock.now_ns() - start < seconds * 1e9:
            if torque is not None:
                command.torque[:] = torque((clock.now_ns() - start) * 1e-9)
                if not adapter.write(command):
                    break
            due += period_ns
            clock.sleep_until(due)
            if adapter.read_into(self._feedback):
                self._n_fresh += 1
                positions.append(list(self._feedback.position))
            if until is not None and until():
                break
        return positions


def describe_energy(names: Sequence[str], energised: Sequence[bool | None]) -> str:
    """What the drives say about being energised, in words.

    Args:
        names: Of the joints.
        energised: As `JointAdapter.read_energised` returns it.
    """
    if not any(on is not False for on in energised):
        return "the drives say that nothing is energised"
    told = {True: "is energised", False: "is not energised", None: "does not tell whether it is energised"}
    return ", ".join(f"{name} {told[on]}" for name, on in zip(names, energised, strict=True))


def _describe_joint(joint: JointCapabilities) -> str:
    """What a drive says of its torque, and in which steps it counts; a step of 0 is that of a float."""
    most = f"torque up to {joint.torque_limit:g} {joint.torque_unit}"
    if joint.torque_limit == inf:
        most = f"torque in {joint.torque_unit}, no limit told"
    steps = {"torque": joint.torque_quantum, "position": joint.position_quantum, "velocity": joint.velocity_quantum}
    counted = ", ".join(f"{name} {step:.3g}" for name, step in steps.items() if step)
    return f"{joint.name}: {most}, {joint.torque_kind}; {f'steps of {counted}' if counted else 'no steps'}"


def _list(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.3g}" for value in values)
