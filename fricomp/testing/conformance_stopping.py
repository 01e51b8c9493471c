"""Stopping: from any thread, by a fault, by a power cycle; and nothing enables again by itself."""

import threading

import pytest

from fricomp.errors import DriveFault, SafetyTrip
from fricomp.joint import JointFeedback
from fricomp.testing.rig import AdapterRig
from fricomp.testing.steps import cycle, n_joints, opened, run, start, stopped, with_errors_of_ours


class StoppingConformance:
    """Part of `fricomp.testing.conformance.AdapterConformance`."""

    def test_a_stop_from_another_thread_stops_and_holds(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        thread = threading.Thread(target=rig.adapter.safe_stop)
        thread.start()
        thread.join(5.0)
        rig.clock.advance(rig.period)
        assert stopped(rig)
        for _ in range(20):
            assert not cycle(rig, [rig.torque_limit] * n_joints(rig))
            assert stopped(rig)

    def test_stopping_often_and_early_is_harmless(self, rig: AdapterRig) -> None:
        rig.adapter.safe_stop()
        opened(rig)
        start(rig)
        for _ in range(3):
            rig.adapter.safe_stop()
        assert stopped(rig)

    def test_a_stop_before_enabling_holds_until_it_is_cleared(self, rig: AdapterRig) -> None:
        opened(rig)
        rig.adapter.safe_stop()
        rig.adapter.configure("torque", rig.period)
        with pytest.raises(SafetyTrip):
            rig.adapter.enable()
        assert stopped(rig)
        rig.adapter.clear_faults()
        rig.adapter.enable()
        assert all(rig.energised())

    def test_a_motion_that_was_ended_may_begin_again_without_clearing(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        rig.adapter.disable()
        rig.clock.advance(rig.period)
        assert stopped(rig)
        rig.adapter.configure("torque", rig.period)
        rig.adapter.enable()
        assert all(rig.energised())
        assert run(rig, 5, torque=0.5 * rig.torque_limit)

    def test_closing_stops(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        rig.adapter.close()
        rig.clock.advance(rig.period)
        assert stopped(rig)

    def test_a_drive_fault_stops_all_joints_and_nothing_enables_again_by_itself(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        rig.fail(0)
        with_errors_of_ours(rig)
        assert rig.adapter.gate.tripped
        assert stopped(rig)
        with pytest.raises(SafetyTrip):
            rig.adapter.enable()
        rig.heal(0)
        for _ in range(20):
            rig.clock.advance(rig.period)
            rig.adapter.read_into(JointFeedback(n_joints(rig)))
        assert stopped(rig)
        rig.adapter.clear_faults()
        assert stopped(rig)
        rig.adapter.enable()
        assert all(rig.energised())
        assert run(rig, 5, torque=0.5 * rig.torque_limit)

    def test_a_fault_that_stays_cannot_be_cleared(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5)
        rig.fail(0)
        with_errors_of_ours(rig)
        with pytest.raises(DriveFault):
            rig.adapter.clear_faults()
        with pytest.raises(SafetyTrip):
            rig.adapter.enable()

    def test_a_power_cycle_of_a_drive_is_noticed_and_stops_all(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        rig.power_cycle(0)
        with_errors_of_ours(rig)
        assert rig.adapter.gate.tripped
        assert stopped(rig)
