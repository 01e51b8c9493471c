"""Commands and states: sign, unit, quantum, saturation, golden frames."""

import random
from math import inf, nan

import pytest

from fricomp.joint import JointCommand, JointFeedback
from fricomp.testing.rig import AdapterRig
from fricomp.testing.steps import cycle, flattened, n_joints, opened, run, start, stopped


class ExchangeConformance:
    """Part of `fricomp.testing.conformance.AdapterConformance`."""

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
