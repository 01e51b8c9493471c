"""The drive's side of a transmission: buffers, and the way between them and the joint, the same every cycle."""

from collections.abc import Sequence
from math import isfinite

from fricomp.errors import AdapterValueError
from fricomp.joint import Capabilities, JointCommand, JointFeedback

from .transmission import Transmission


class DriveSide:
    """Command and feedback on the drives' side, made once and filled every cycle.

    Args:
        capabilities: As the drives declare them.
        transmissions: One for each joint.
    """

    def __init__(self, capabilities: Capabilities, transmissions: Sequence[Transmission]) -> None:
        n_joints = len(capabilities.joints)
        self.command = JointCommand(n_joints)
        self._geared = JointCommand(n_joints)  # another one: entries that a mode leaves alone would turn every cycle
        self.feedback = JointFeedback(n_joints)
        self._gears = [
            (joint, t.sign / t.gear_ratio, t.zero, t.torque_gain(declared.torque_unit))
            for joint, (declared, t) in enumerate(zip(capabilities.joints, transmissions, strict=True))
            if not t.is_identity
        ]

    def zero_command(self) -> None:
        """Set every entry of the command to zero."""
        for entries in (self.command.torque, self.command.velocity, self.command.position):
            entries[:] = [0.0] * len(entries)

    def command_from_joint(self) -> JointCommand:
        """The command, filled joint side, on the drives' side.

        Raises:
            AdapterValueError: A torque is not finite after the transmission.
        """
        command, geared = self.command, self._geared
        if not self._gears:
            return command  # as the gate has let it through
        geared.torque[:], geared.velocity[:], geared.position[:] = command.torque, command.velocity, command.position
        for joint, gain, zero, torque_gain in self._gears:
            geared.torque[joint] /= torque_gain
            geared.velocity[joint] /= gain
            geared.position[joint] = (command.position[joint] + zero) / gain
        if not isfinite(sum(geared.torque)):
            raise AdapterValueError(f"torque {geared.torque} after the transmission is not finite")
        return geared

    def feedback_to_joint(self, feedback: JointFeedback) -> None:
        """Fill `feedback`, joint side, with what the drives have reported."""
        source = self.feedback
        feedback.time_ns = source.time_ns
        feedback.position[:], feedback.velocity[:] = source.position, source.velocity
        feedback.torque[:], feedback.current[:] = source.torque, source.current
        feedback.temperature[:], feedback.fault[:] = source.temperature, source.fault
        for joint, gain, zero, torque_gain in self._gears:
            feedback.position[joint] = source.position[joint] * gain - zero
            feedback.velocity[joint] = source.velocity[joint] * gain
            feedback.torque[joint] = source.torque[joint] * torque_gain
