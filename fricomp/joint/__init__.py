"""What a joint on a bus offers, is told and reports: capabilities, command, feedback, clock."""

from fricomp.joint.arrival import FeedbackSource, await_feedback
from fricomp.joint.capabilities import Capabilities, CommandMode, JointCapabilities, TorqueKind, Watchdog
from fricomp.joint.clock import Clock, MonotonicClock, stands_still
from fricomp.joint.exchange import JointCommand, JointFeedback

__all__ = [
    "Capabilities",
    "Clock",
    "CommandMode",
    "FeedbackSource",
    "JointCapabilities",
    "JointCommand",
    "JointFeedback",
    "MonotonicClock",
    "TorqueKind",
    "Watchdog",
    "await_feedback",
    "stands_still",
]
