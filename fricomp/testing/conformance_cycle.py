"""The loop: it never waits, and keeps nothing that grows."""

import gc
import tracemalloc

from fricomp.joint import JointCommand, JointFeedback
from fricomp.testing.rig import AdapterRig
from fricomp.testing.steps import n_joints, opened, run, start


class CycleConformance:
    """Part of `fricomp.testing.conformance.AdapterConformance`."""

    def test_a_cycle_never_waits(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        command, feedback = JointCommand(n_joints(rig)), JointFeedback(n_joints(rig))
        for _ in range(20):
            before = rig.clock.now_ns()
            rig.adapter.write(command)
            rig.adapter.read_into(feedback)
            assert rig.clock.now_ns() == before
            rig.clock.advance(rig.period)

    def test_memory_does_not_grow(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        feedback = JointFeedback(n_joints(rig))
        run(rig, 100, feedback)
        gc.collect()
        tracemalloc.start()
        try:
            run(rig, 50, feedback)
            before = tracemalloc.get_traced_memory()[0]
            run(rig, 200, feedback)
            gc.collect()
            # Less than half a small object a cycle: what is kept must not depend on how long it runs.
            assert tracemalloc.get_traced_memory()[0] - before < 6_000
        finally:
            tracemalloc.stop()

    def test_opening_again_after_closing_works(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 3)
        rig.adapter.close()
        opened(rig)
        start(rig)
        assert run(rig, 3, torque=0.2 * rig.torque_limit)
