"""Before anything moves: opening, configuring, the watchdog, the first states."""

from math import isfinite

import pytest

from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.joint import JointFeedback
from fricomp.testing.rig import AdapterRig
from fricomp.testing.steps import LONG, n_joints, opened, start


class PreparationConformance:
    """Part of `fricomp.testing.conformance.AdapterConformance`."""

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
