"""The sweep: from the first check to the last breakaway, each block on disk before the next starts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.adapters import JointAdapter
from fricomp.errors import AdapterConfigurationError, ParameterError, SweepAborted
from fricomp.joint import CommandMode
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata, RecordingWriter

from .block import BlockLabel, SweepData
from .log import CycleLog
from .motion import MotionRunner
from .plan import Plateau, SweepPlan, Travel, default_speeds, move_speed, plan_plateaus, travel_of
from .rigid_body import RigidBody, derivatives
from .settings import SweepSettings
from .sign_check import SignCheck, check_signs
from .velocity_loop import DriveLoop, HostLoop, LimpLoop, VelocityLoop
from .visit import PlateauVisit

__all__ = ["Progress", "Sweep", "SweepContext", "loop_period"]

# Distance that ends the sign check, as a fraction of the travel; time over which its torque rises [s].
SIGN_CHECK_MOTION = 0.01
SIGN_CHECK_RISE = 3.0
# The reference of a breakaway ramp creeps at this fraction of the lowest speed of the sweep.
CREEP_RATIO = 0.2
# Encoder counts after which a joint has given way, and the time after which it counts as held fast [s].
BREAKAWAY_MOTION = 16
LONGEST_CREEP = 30.0
# Cycles a second of the loop by who closes it [Hz].
DRIVE_RATE, HOST_RATE = 500.0, 1000.0
# Rest before the torque sensor is read [s].
REST = 0.3
# Time between a run that was interrupted and its continuation, in the recording [s].
RESUME_GAP = 1.0

Progress = Callable[[str, float], None]
"""Called with what is being done and the fraction that is done [1]."""


def loop_period(adapter: JointAdapter, settings: SweepSettings, mode: CommandMode) -> float:
    """Period of the loop [s]: as asked for, else what suits the mode, never faster than the bus."""
    wanted = settings.rate or (HOST_RATE if mode == "torque" else DRIVE_RATE)
    return 1.0 / min(wanted, adapter.capabilities.rate_in(mode))


@dataclass(frozen=True)
class SweepContext:
    """What a sweep works with.

    Attributes:
        adapter: Open.
        joint: Index of the joint.
        settings: As chosen.
        body: Rigid-body model of the arm; None where gravity and inertia are unknown.
    """

    adapter: JointAdapter
    joint: int
    settings: SweepSettings
    body: RigidBody | None = None

    def choose_mode(self) -> CommandMode:
        """The command mode of the velocity loop.

        Raises:
            AdapterConfigurationError: The drive cannot do what was asked for.
        """
        offered, wanted = self.adapter.capabilities.modes, self.settings.loop
        if wanted != "host":
            own: tuple[CommandMode, ...] = ("velocity", "position")
            for mode in own:
                if mode in offered:
                    return mode
        if wanted != "drive" and "torque" in offered:
            return "torque"
        raise AdapterConfigurationError(f"loop {wanted!r} is not possible: the drive offers {', '.join(offered)}")

    def make_loop(self, mode: CommandMode, period: float, position: Sequence[float]) -> VelocityLoop:
        """The loop for a mode."""
        n_joints = len(self.adapter.capabilities.joints)
        if mode != "torque":
            return DriveLoop(n_joints, period, mode)
        inertias = [self.settings.inertia] * n_joints
        if self.body is not None and not self.settings.inertia:
            inertias = self.body.inertias(position)
        limits = [limit.torque for limit in self.adapter.options.limits]
        return HostLoop(inertias, self.settings.bandwidth, period, limits)

    def make_check_loop(self, period: float, position: Sequence[float]) -> VelocityLoop:
        """The loop of the sign check, which pushes with torque alone.

        Raises:
            ParameterError: Nothing is known that would hold the other joints of an arm.
        """
        if self.body is not None or self.settings.inertia:
            return self.make_loop("torque", period, position)
        joints = self.adapter.capabilities.joints
        if len(joints) > 1:
            raise ParameterError(
                f"the sign check would leave all {len(joints)} joints without torque, because nothing says their "
                "inertia: give a model or --inertia, or configure this joint alone"
            )
        return LimpLoop()

    def travel(self, at: float = 0.0) -> Travel:
        """Where the joint may move, of one that turns freely about the position `at` [rad] or [m]."""
        limits = self.adapter.options.limits[self.joint]
        return travel_of(self.adapter.capabilities.joints[self.joint], limits.position, limits.velocity, at)

    def metadata(self) -> RecordingMetadata:
        """Facts for the recording."""
        declared, limits = self.adapter.capabilities.joints[self.joint], self.adapter.options.limits[self.joint]
        return RecordingMetadata(
            joint=declared.name,
            motion=declared.motion,
            torque_unit=declared.torque_unit,
            torque_kind=declared.torque_kind,
            encoder_resolution=declared.position_quantum or None,
            position_limits=limits.position or declared.position_limits,
            velocity_limit=limits.velocity,
            continuous=limits.position is None and declared.position_limits is None,
            source="fricomp calibrate",
            extra={
                "torque_limit": min(limits.torque, declared.torque_limit),
                "torque_quantum": declared.torque_quantum,
            },
        )


class Sweep:
    """Moves one joint through a plan and writes what it does.

    Args:
        context: Joint and settings.
        writer: Of the run's recording; what it holds already is not repeated.
        data: The blocks it holds already.
        report: Told about progress.
    """

    def __init__(
        self,
        context: SweepContext,
        writer: RecordingWriter,
        data: SweepData,
        report: Progress = lambda text, done: None,
    ) -> None:
        self.context, self.data = context, data
        self._writer, self._told = writer, report
        self._metadata = context.metadata()
        self._mode = context.choose_mode()
        self.runner = MotionRunner(
            context.adapter, context.joint, loop_period(context.adapter, context.settings, self._mode)
        )
        elapsed = 0.0 if writer.last_time is None else writer.last_time + RESUME_GAP
        self._origin_ns = self.runner.now_ns - round(elapsed * 1e9)
        self.sign_check: SignCheck | None = None
        self.travel = Travel(0.0, 1.0, 1.0)
        self._visited = -1

    # -- the parts, in order ----------------------------------------------------------------------------

    def prepare(self) -> Travel:
        """Zero of the torque sensor, then signs and scales at low torque, then the loop holds the joint.

        Raises:
            SweepAborted: A sign or scale is wrong, the joint does not move, or a drive reports a fault.
            ParameterError: A speed does not fit into the travel, or a loop on the host lacks an inertia.
        """
        context = self.context
        context.adapter.configure(self._mode, self.runner.period)
        self.runner.await_feedback()
        self.travel = context.travel(self.runner.position)
        # Both refuse what cannot be done before anything moves.
        self.plan_first_pass()
        context.make_loop(self._mode, self.runner.period, self.runner.feedback.position)
        checks_signs = "torque" in context.adapter.capabilities.modes
        if checks_signs:
            context.make_check_loop(self.runner.period, self.runner.feedback.position)
        self.measure_offset("measuring the zero of the torque sensor")
        pushed = self._check_signs() if checks_signs else None
        loop = context.make_loop(self._mode, self.runner.period, self.runner.feedback.position)
        self.runner.start(loop)
        if pushed is not None:  # now, because without torque the joint may fall: a disk is nothing to wait for then
            self.write(pushed, BlockLabel("sign_check"))
        return self.travel

    def measure_offset(self, text: str) -> None:
        """Record the torque sensor of the joint at rest, not energised, once its filter has forgotten the motion."""
        if self.context.settings.tare > 0.0:
            self._report(text, 0.0)
            self.runner.watch(REST)
            self.write(self.runner.watch(self.context.settings.tare), BlockLabel("tare"))

    def warm_up(self) -> None:
        """Move to and fro over the travel for the time that was asked for."""
        settings, travel = self.context.settings, self.travel
        speed, ramp = move_speed(travel), settings.ramp
        self._report("warming up", 0.0)
        start, log = self.runner.now_ns, None
        while (self.runner.now_ns - start) * 1e-9 < settings.warm_up:
            for edge in (travel.low + 0.2 * travel.length, travel.high - 0.2 * travel.length):
                log = self.runner.move_to(edge, speed, ramp)
        if log is not None:
            self.write(log, BlockLabel("warm_up"))

    def run_plan(self, plan: SweepPlan, text: str = "sweeping") -> None:
        """Visit every plateau that is not on disk yet."""
        total, done = plan.duration, 0.0
        for plateau in plan.plateaus:
            if not self.data.has("plateau", plateau.number):
                self._report(f"{text}: {plateau.velocity:+.3g} {self._metadata.position_unit}/s", done / total)
                self._visit(plateau)
            done += plateau.profile.duration * total / sum(p.profile.duration for p in plan.plateaus)
        self._report(text, 1.0)

    def measure_breakaways(self, lowest_speed: float) -> None:
        """Ramp the torque at several positions, both ways, until the joint gives way."""
        travel, count = self.travel, self.context.settings.breakaway_positions
        creep = CREEP_RATIO * float(lowest_speed)
        if travel.speed_quantum > creep:
            return  # the drive cannot be told to go as slowly
        for index, place in enumerate(np.linspace(0.15, 0.85, count) if count else ()):
            self._report("breakaway", index / count)
            pending = [n for n in (2 * index, 2 * index + 1) if not self.data.has("breakaway", n)]
            if pending:
                self.runner.move_to(
                    travel.low + float(place) * travel.length, move_speed(travel), self.context.settings.ramp
                )
                self._creep(1, creep)  # so that the first ramp is as long as the others
            for number in pending:
                direction = -1 if number % 2 == 0 else 1
                log = self._creep(direction, creep)
                self.write(log, BlockLabel("breakaway", number, direction * creep, direction=direction))

    def finish(self) -> None:
        """Zero torque, and the zero of the torque sensor once more."""
        self.runner.stop()
        self.measure_offset("measuring the zero of the torque sensor again")

    def plan_first_pass(self) -> SweepPlan:
        """The plan before anything is known about the joint."""
        return plan_plateaus(default_speeds(self.travel, self.context.settings), self.travel, self.context.settings)

    # -- inside -----------------------------------------------------------------------------------------

    def _check_signs(self) -> CycleLog:
        """Torque rises until the joint has moved a little; then nothing holds it but its friction.

        Returns:
            What was seen, not written yet. Of a check that fails it is written, at zero torque.
        """
        context, runner = self.context, self.runner
        limit = context.settings.check_torque * context.adapter.options.limits[context.joint].torque
        self._report("checking signs at low torque", 0.0)
        runner.start(context.make_check_loop(runner.period, runner.feedback.position))
        start = runner.position
        direction = 1.0 if start <= self.travel.middle else -1.0
        base = self._gravity_here()
        enough = SIGN_CHECK_MOTION * self.travel.length

        def torque(time: float) -> float | None:
            if abs(runner.position - start) > enough or time > SIGN_CHECK_RISE:
                return None
            return base + direction * limit * time / SIGN_CHECK_RISE

        log = runner.apply_torque(torque)
        runner.stop()  # at once: the last torque has torn the joint loose, and no loop may be closed over unknown signs
        try:
            self.sign_check = self._judge_push(log, limit, moved=abs(runner.position - start) > enough)
        except BaseException:
            self.write(log, BlockLabel("sign_check"))
            raise
        return log

    def _judge_push(self, log: CycleLog, limit: float, *, moved: bool) -> SignCheck:
        if not moved:
            raise SweepAborted(
                f"joint {self._metadata.joint!r} did not move under {limit:.3g} {self._metadata.torque_unit}: release "
                "the brake, or raise --check-torque"
            )
        samples = log.to_recording(self._origin_ns, self._metadata, None)
        return check_signs(samples, torque_is_echo=self._metadata.torque_kind == "commanded")

    def _gravity_here(self) -> float:
        body, here = self.context.body, np.array([self.runner.feedback.position])
        if body is None:
            return 0.0
        return float(body.torque(self.context.joint, here, 0.0 * here, 0.0 * here)[0])

    def _visit(self, plateau: Plateau) -> None:
        runner, quantum = self.runner, self.travel.quantum
        if not (plateau.is_return and self._visited == plateau.number - 1):
            runner.move_to(plateau.start, move_speed(self.travel), self.context.settings.ramp)
        self._visited = plateau.number
        visit = PlateauVisit(plateau, quantum, runner.period, runner.position)
        log = runner.follow(lambda time: visit.velocity_at(time, runner.feedback.time_ns, runner.position))
        label = BlockLabel(
            "plateau", plateau.number, plateau.velocity, self._seconds(visit.start_ns), self._seconds(visit.stop_ns),
            visit.settled, plateau.is_first_again,
        )  # fmt: skip
        self.write(log, label)

    def _creep(self, direction: int, speed: float) -> CycleLog:
        """Let the reference creep until the joint has given way: the loop turns that into a ramp of torque."""
        runner, enough = self.runner, BREAKAWAY_MOTION * max(self.travel.quantum, 1e-7)
        start = runner.position

        def reference(time: float) -> float | None:
            gone = direction * (runner.position - start) > enough
            return None if gone or time > LONGEST_CREEP else direction * speed

        return runner.follow(reference)

    def _seconds(self, time_ns: int) -> float:
        return (time_ns - self._origin_ns) * 1e-9

    def write(self, log: CycleLog, label: BlockLabel) -> Recording:
        """Put one block on disk; it is there when this returns. The loop goes on holding an energised joint meanwhile.

        Raises:
            RecordingError: The file cannot be written.
            SweepAborted: The safety gate has tripped meanwhile.
        """
        samples = self.runner.meanwhile(lambda: self._append(log, label))
        self.data = self.data.with_block(label, samples)
        return samples

    def _report(self, text: str, done: float) -> None:
        """Tell about progress; a terminal may take its time as a disk may."""
        self.runner.meanwhile(lambda: self._told(text, done))

    def _append(self, log: CycleLog, label: BlockLabel) -> Recording:
        samples = log.to_recording(self._origin_ns, self._metadata, self._load_torque(log))
        self._writer.append(samples, label.encode())
        return samples

    def _load_torque(self, log: CycleLog) -> FloatArray | None:
        """Rigid-body torque along a motion; None without a model."""
        body = self.context.body
        if body is None:
            return None
        position = log.configuration()
        velocity, acceleration = derivatives(position, self.runner.period)
        return body.torque(self.context.joint, position, velocity, acceleration)
