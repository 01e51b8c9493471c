"""The sweep: from the first check to the last breakaway, each block on disk before the next starts."""

from collections.abc import Callable

import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingWriter

from .analysis.block import BlockLabel, SweepData
from .motion.context import SweepContext, loop_period
from .motion.log import CycleLog
from .motion.motion import MotionRunner
from .motion.push import push_joint
from .motion.sign_check import SignCheck
from .motion.visit import PlateauVisit
from .planning.plan import Plateau, SweepPlan, Travel, default_speeds, move_speed, plan_plateaus
from .rigid_body import derivatives

__all__ = ["Progress", "Sweep"]

# The reference of a breakaway ramp creeps at this fraction of the lowest speed of the sweep.
CREEP_RATIO = 0.2
# Encoder counts after which a joint has given way, and the time after which it counts as held fast [s].
BREAKAWAY_MOTION = 16
LONGEST_CREEP = 30.0
# Rest before the torque sensor is read [s].
REST = 0.3
# Time between a run that was interrupted and its continuation, in the recording [s].
RESUME_GAP = 1.0

Progress = Callable[[str, float], None]
"""Called with what is being done and the fraction that is done [1]."""


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
        """See `push_joint`.

        Returns:
            What was seen, not written yet. Of a check that fails it is written, at zero torque.
        """
        self._report("checking signs at low torque", 0.0)
        push = push_joint(self.runner, self.context, self.travel)
        try:
            self.sign_check = push.judge(self._metadata)
        except BaseException:
            self.write(push.log, BlockLabel("sign_check"))
            raise
        return push.log

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
        if self.context.watch is not None:
            self.context.watch.show_block(label, samples)
        return samples

    def _load_torque(self, log: CycleLog) -> FloatArray | None:
        """Rigid-body torque along a motion; None without a model."""
        body = self.context.body
        if body is None:
            return None
        position = log.configuration()
        velocity, acceleration = derivatives(position, self.runner.period)
        return body.torque(self.context.joint, position, velocity, acceleration)
