"""A link that fails: frames lost, delayed, damaged; silence, a pulled cable, a full queue."""

import random

import pytest

from fricomp.errors import AdapterError, FricompError, SafetyTrip
from fricomp.joint import JointCommand, JointFeedback
from fricomp.testing.faulty_link import FAULTS
from fricomp.testing.rig import AdapterRig
from fricomp.testing.steps import (
    LONG,
    cycle,
    effective_torque,
    n_joints,
    opened,
    run,
    start,
    stopped,
    with_errors_of_ours,
    within_limits,
)


class LinkFailureConformance:
    """Part of `fricomp.testing.conformance.AdapterConformance`."""

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
