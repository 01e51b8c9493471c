"""The push of the sign check leaves no joint turning that a drive's own loop would then have to brake."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import pytest

from fricomp.adapters import JointAdapter
from fricomp.calibration.sweep.motion import push
from fricomp.calibration.sweep.motion.context import SweepContext, loop_period
from fricomp.calibration.sweep.motion.motion import MotionRunner
from fricomp.calibration.sweep.motion.push import push_joint
from fricomp.calibration.sweep.planning.settings import SweepSettings
from fricomp.sim_bench.twins import backend

TWINS = [
    backend.TwinCanOpenAdapter,
    backend.TwinDynamixelAdapter,
    backend.TwinMitAdapter,
    backend.TwinMoteusAdapter,
    backend.TwinOdriveAdapter,
]


@pytest.mark.parametrize("make", TWINS)
def test_a_joint_that_was_pushed_rests_before_a_loop_starts(make: type[JointAdapter]) -> None:
    adapter = cast(Any, make).from_configuration({})
    with adapter:
        context = SweepContext(adapter, 0, SweepSettings())
        runner = MotionRunner(adapter, 0, loop_period(adapter, context.settings, "velocity"))
        adapter.configure("velocity", runner.period)
        runner.await_feedback()
        pushed = push_joint(runner, context, context.travel(runner.position))
        assert pushed.has_moved
        assert not adapter.enabled
        fastest = max(map(abs, pushed.log.velocity))
        assert fastest > 0.2  # torn loose
        assert abs(adapter.twin.stand_in.plant.velocity(0)) < 0.1 * fastest


class ScriptedRunner:
    """A joint that moves by given distances, one a glimpse."""

    def __init__(self, steps: list[float]) -> None:
        self.position, self.steps = 0.0, steps

    def apply_torque(self, torque: Callable[[float], float | None]) -> None:
        assert torque(0.0) == 0.25
        assert torque(push.GLIMPSE) is None
        self.position += self.steps.pop(0)


@pytest.mark.parametrize(
    ("steps", "left"),
    [
        ([0.04, 0.02, 0.0004, 0.0], 1),  # rests
        ([-0.04, -0.02, 0.0004, 0.0], 1),
        ([0.02, 0.02, 0.01, 0.0], 0),  # slows down late
        ([0.02, 0.04, 0.06], 1),  # falls
    ],
)
def test_a_joint_is_let_go_while_that_slows_it_down(steps: list[float], left: int) -> None:
    push._let_coast(cast(MotionRunner, ScriptedRunner(steps)), 0.001, 0.25)
    assert len(steps) == left


def test_a_joint_that_never_slows_down_is_not_waited_for_without_end() -> None:
    steps = [0.02] * 1000
    push._let_coast(cast(MotionRunner, ScriptedRunner(steps)), 0.001, 0.25)
    assert 1000 - len(steps) == round(push.LONGEST_COAST / push.GLIMPSE)
