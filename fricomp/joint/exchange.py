"""Buffers between a control loop and an adapter: made once, filled every cycle, joint side, SI.

They hold lists of floats, not arrays: for the few joints of a robot that is several times faster.
"""

from math import nan


class JointCommand:
    """What the joints are told. Entries that the mode in use does not need are ignored.

    Attributes:
        torque: Torque, or torque feed-forward in the other modes [N·m], [N] or the joint's own unit.
        velocity: Velocity reference [rad/s] or [m/s].
        position: Position reference [rad] or [m].
    """

    __slots__ = ("position", "torque", "velocity")

    def __init__(self, n_joints: int) -> None:
        self.torque = [0.0] * n_joints
        self.velocity = [0.0] * n_joints
        self.position = [0.0] * n_joints


class JointFeedback:
    """What the joints report; NaN where a drive does not.

    Attributes:
        time_ns: When the newest part of it was taken, on the adapter's clock [ns].
        position: [rad] or [m].
        velocity: [rad/s] or [m/s].
        torque: [N·m], [N] or the joint's own unit.
        current: [A].
        temperature: [°C].
        fault: The drive's fault code of each joint; 0 for none.
    """

    __slots__ = ("current", "fault", "position", "temperature", "time_ns", "torque", "velocity")

    def __init__(self, n_joints: int) -> None:
        self.time_ns = 0
        self.position = [nan] * n_joints
        self.velocity = [nan] * n_joints
        self.torque = [nan] * n_joints
        self.current = [nan] * n_joints
        self.temperature = [nan] * n_joints
        self.fault = [0] * n_joints
