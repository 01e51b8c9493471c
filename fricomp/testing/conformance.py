"""The conformance suite of adapters: subclass it with one fixture called `rig`, and pytest runs it all.

class TestMyAdapter(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        return MyRig()
"""

from __future__ import annotations

import gc
import random
import threading
import tracemalloc
from math import inf, isfinite, nan

import pytest

from fricomp.errors import AdapterConfigurationError, AdapterError, DriveFault, FricompError, SafetyTrip
from fricomp.joint import JointCommand, JointFeedback
from fricomp.testing.faulty_link import FAULTS
from fricomp.testing.rig import AdapterRig
from fricomp.testing.steps import (
    LONG,
    cycle,
    effective_torque,
    flattened,
    n_joints,
    opened,
    run,
    start,
    stopped,
    with_errors_of_ours,
    within_limits,
)

__all__ = ["AdapterConformance"]


class AdapterConformance:
    """Every promise of an adapter as a test."""

    @pytest.fixture
    def rig(self) -> AdapterRig:
        """The rig under test; to be overridden."""
        raise NotImplementedError("give this class a fixture `rig` that returns an AdapterRig")

    @pytest.fixture(autouse=True)
    def _skip_what_the_protocol_rules_out(self, rig: AdapterRig, request: pytest.FixtureRequest) -> None:
        name = getattr(request.node, "originalname", request.node.name)
        if name in rig.exempt:
            pytest.skip(f"ruled out by the protocol: {rig.exempt[name]}")

    # -- before anything moves ----------------------------------------------------------------------------

    def test_opening_and_configuring_energise_nothing(self, rig: AdapterRig) -> None:
        opened(rig)
        assert not any(rig.energised())
        rig.adapter.configure("torque", rig.period)
        rig.clock.advance(0.1)
        assert not any(rig.energised())

    def test_capabilities_are_declared(self, rig: AdapterRig) -> None:
        capabilities = opened(rig)
        names = [joint.name for joint in capabilities.joints]
        assert len(set(names)) == len(names) > 0
        assert "torque" in capabilities.modes
        assert isfinite(capabilities.highest_rate)
        assert capabilities.highest_rate > 0.0
        for joint in capabilities.joints:
            assert min(joint.position_quantum, joint.velocity_quantum, joint.torque_quantum) >= 0.0
            assert min(joint.torque_limit, joint.velocity_limit) > 0.0

    def test_a_rate_beyond_the_bus_is_refused_with_the_one_that_fits(self, rig: AdapterRig) -> None:
        capabilities = opened(rig)
        with pytest.raises(AdapterConfigurationError, match=f"{capabilities.highest_rate:.0f} Hz"):
            rig.adapter.configure("torque", 0.5 / capabilities.highest_rate)

    def test_a_mode_that_the_drive_does_not_take_is_an_error(self, rig: AdapterRig) -> None:
        opened(rig)
        rig.refuse_mode()
        with pytest.raises(AdapterError):
            start(rig)
        assert not any(rig.energised())

    def test_the_watchdog_is_confirmed_before_enabling(self, rig: AdapterRig) -> None:
        opened(rig)
        rig.adapter.configure("torque", rig.period)
        watchdog = rig.adapter.capabilities.watchdog
        assert watchdog is not None
        assert watchdog.confirmed
        assert watchdog.timeout <= LONG

    def test_the_state_can_be_read_before_enabling(self, rig: AdapterRig) -> None:
        opened(rig)
        rig.adapter.configure("torque", rig.period)
        rig.move(0, 0.4, 0.0)
        feedback = JointFeedback(n_joints(rig))
        for _ in range(20):
            rig.clock.advance(rig.period)
            if rig.adapter.read_into(feedback) and abs(feedback.position[0] - 0.4) < 0.01:
                break
        assert feedback.position[0] == pytest.approx(0.4, abs=0.01)
        assert not any(rig.energised())

    # -- commands and states --------------------------------------------------------------------------------

    def test_enabling_starts_at_zero_torque(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        assert all(rig.energised())
        for torque, joint in zip(rig.applied_torque(), rig.adapter.capabilities.joints, strict=True):
            assert abs(torque) <= max(joint.torque_quantum, 1e-6)

    def test_torque_arrives_within_a_quantum_with_its_sign(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        rng = random.Random(1)
        for _ in range(50):
            wanted = [rng.uniform(-1.0, 1.0) * rig.torque_limit for _ in range(n_joints(rig))]
            assert cycle(rig, wanted)
            for applied, torque, joint in zip(
                rig.applied_torque(), wanted, rig.adapter.capabilities.joints, strict=True
            ):
                assert abs(applied - torque) <= 0.501 * joint.torque_quantum + 1e-6 * rig.torque_limit

    def test_position_and_velocity_arrive_with_sign_and_unit(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        feedback = JointFeedback(n_joints(rig))
        for position, velocity in ((0.5, 1.5), (-0.7, -0.8)):
            for joint in range(n_joints(rig)):
                rig.move(joint, position, velocity)
            run(rig, 3, feedback)
            for joint, declared in enumerate(rig.adapter.capabilities.joints):
                assert feedback.position[joint] == pytest.approx(position, abs=declared.position_quantum + 1e-6)
                assert feedback.velocity[joint] == pytest.approx(velocity, abs=declared.velocity_quantum + 1e-6)

    def test_reported_torque_has_the_sign_and_size_of_the_command(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        feedback = JointFeedback(n_joints(rig))
        for share in (0.5, -0.5):
            run(rig, 4, feedback, share * rig.torque_limit)
            for joint, declared in enumerate(rig.adapter.capabilities.joints):
                tolerance = 2.0 * declared.torque_quantum + 0.02 * rig.torque_limit
                assert feedback.torque[joint] == pytest.approx(share * rig.torque_limit, abs=tolerance)

    def test_over_range_saturates_with_the_right_sign(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        for sign in (1.0, -1.0):
            assert cycle(rig, [sign * 3.0 * rig.torque_limit] * n_joints(rig))
            for applied, joint in zip(rig.applied_torque(), rig.adapter.capabilities.joints, strict=True):
                assert sign * applied == pytest.approx(rig.torque_limit, abs=joint.torque_quantum + 1e-6)

    @pytest.mark.parametrize("value", [nan, inf, -inf])
    def test_a_torque_that_is_not_finite_reaches_no_joint(self, rig: AdapterRig, value: float) -> None:
        opened(rig)
        start(rig)
        run(rig, 3)
        command = JointCommand(n_joints(rig))
        command.torque[:] = [0.5 * rig.torque_limit] * n_joints(rig)
        command.torque[-1] = value
        assert not rig.adapter.write(command)
        rig.clock.advance(rig.period)
        assert stopped(rig)

    def test_frames_are_those_of_an_independent_encoder(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        for golden in rig.golden():
            rig.link.sent.clear()
            rig.link.recording = True
            assert cycle(rig, list(golden.torque))
            rig.link.recording = False
            assert golden.wire in flattened(rig.link.sent)

    # -- a link that fails ----------------------------------------------------------------------------------

    @pytest.mark.parametrize("fault", sorted(FAULTS))
    def test_a_bad_link_never_lets_more_than_the_limit_through(self, rig: AdapterRig, fault: str) -> None:
        opened(rig)
        start(rig)
        rig.link.incoming = FAULTS[fault](random.Random(7))
        feedback = JointFeedback(n_joints(rig))
        rng = random.Random(3)
        try:
            for _ in range(100):
                wanted = [rng.uniform(-2.0, 2.0) * rig.torque_limit for _ in range(n_joints(rig))]
                if not cycle(rig, wanted, feedback):
                    break
                assert within_limits(rig)
        except FricompError:
            pass  # giving up in the library's own words is right, too
        if rig.adapter.gate.tripped:
            rig.clock.advance(LONG)
            assert stopped(rig)

    def test_silence_of_the_drives_stops_them(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        rig.link.incoming = lambda traffic: traffic[:0]
        with_errors_of_ours(rig)
        assert rig.adapter.gate.tripped
        assert stopped(rig)

    def test_a_pulled_cable_ends_in_zero_torque_by_the_watchdog(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        rig.link.silent = True
        with_errors_of_ours(rig)
        assert rig.adapter.gate.tripped
        watchdog = rig.adapter.capabilities.watchdog
        assert watchdog is not None
        rig.clock.advance(watchdog.timeout + 2.0 * rig.period)
        assert stopped(rig)

    @pytest.mark.parametrize("kind", ["dead", "full"])
    def test_a_broken_link_is_one_error_and_stays_stopped(self, rig: AdapterRig, kind: str) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        setattr(rig.link, kind, True)
        with pytest.raises(AdapterError):
            run(rig, 3, torque=0.5 * rig.torque_limit)
        rig.clock.advance(LONG)
        setattr(rig.link, kind, False)
        command = JointCommand(n_joints(rig))
        assert not rig.adapter.write(command)
        with pytest.raises(SafetyTrip):
            rig.adapter.enable()
        rig.clock.advance(rig.period)
        assert not any(abs(torque) > 1e-6 for torque in effective_torque(rig))

    def test_a_dead_loop_ends_in_zero_torque_by_the_watchdog(self, rig: AdapterRig) -> None:
        opened(rig)
        start(rig)
        run(rig, 5, torque=0.5 * rig.torque_limit)
        watchdog = rig.adapter.capabilities.watchdog
        assert watchdog is not None
        rig.clock.advance(watchdog.timeout + 2.0 * rig.period)
        assert stopped(rig)

    # -- stopping -------------------------------------------------------------------------------------------

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
        rig.adapter.safe_stop()
        start(rig)
        for _ in range(3):
            rig.adapter.safe_stop()
        assert stopped(rig)

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

    # -- the loop -------------------------------------------------------------------------------------------

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
