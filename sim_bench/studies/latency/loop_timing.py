"""Seven joints of the stand-in in a loop at 1 kHz: what the library takes of a tick, and how late it comes."""

import tempfile
import time
from dataclasses import replace
from pathlib import Path

from fricomp.control import Compensator, ControlLoop, LoopResult, PositionController, RealTimeOptions, SineReference
from fricomp.control.compensation.choice import choose_settings
from fricomp.joint import MonotonicClock

from ...stand_in import DEFAULT_LAW, JointSettings, SimulatedJointAdapter, StandIn, StandInSettings, sensors_for
from .compensator import N_JOINTS, bench_model

_LONGEST_HALT = 2.0  # [s]


class PacedClock:
    """Real time on a stand-in: it is stepped, then the real deadline is waited for.

    Args:
        stand_in: What is stepped.
    """

    def __init__(self, stand_in: StandIn) -> None:
        self._stand_in, self._clock = stand_in, MonotonicClock()
        self._offset = time.monotonic_ns() - stand_in.time_ns

    def now_ns(self) -> int:
        """Real time since the stand-in's start, which has been stepped up to it [ns]."""
        now = time.monotonic_ns() - self._offset
        while self._stand_in.time_ns + self._stand_in.period_ns <= now:
            self._stand_in.step()
        return now

    def sleep_until(self, deadline_ns: int) -> None:
        """Step up to the deadline, then wait for it."""
        while self._stand_in.time_ns < deadline_ns:
            self._stand_in.step()
        self._clock.sleep_until(deadline_ns + self._offset)


def run_loop(duration: float, *, real_time: bool, options: RealTimeOptions | None = None) -> LoopResult:
    """Seven joints of the stand-in at 1 kHz, PD and compensation, in virtual or in real time.

    Args:
        duration: [s].
        real_time: Whether to keep to the wall clock, which shows lateness too.
        options: What to ask of the system.
    """
    with tempfile.TemporaryDirectory() as folder:
        mjcf = Path(folder) / "seven.xml"
        mjcf.write_text(_seven_joints())
        sensor = sensors_for(DEFAULT_LAW)
        joints = tuple(JointSettings(f"joint{j}", DEFAULT_LAW, sensor) for j in range(N_JOINTS))
        adapter = SimulatedJointAdapter(StandInSettings(mjcf, joints))
    if real_time:
        adapter.clock = PacedClock(adapter.stand_in)
        # A machine that halts for a while is what is measured here, not a reason to stop.
        adapter.options = replace(adapter.options, stale_after=_LONGEST_HALT)
    adapter.open()
    inertia = [0.1] * N_JOINTS
    settings = choose_settings(bench_model())
    loop = ControlLoop(
        adapter,
        SineReference([0.3] * N_JOINTS, 0.5, [0.0] * N_JOINTS),
        PositionController.from_bandwidth(inertia, 5.0),
        compensators=[Compensator(bench_model(), settings=settings) for _ in range(N_JOINTS)],
        options=options,
        most_skipped=1000,
    )
    result = loop.run(duration)
    adapter.close()
    result.raise_if_tripped()
    return result


def _seven_joints() -> str:
    body = (
        '<body pos="{j} 0 0"><joint name="joint{j}" axis="0 0 1"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body>'
    )
    bodies = "".join(body.format(j=j) for j in range(N_JOINTS))
    return f'<mujoco><option gravity="0 0 0"/><worldbody>{bodies}</worldbody></mujoco>'
