"""The default compensation of a tracked joint, asked whether its loop is safe."""

from fricomp.control import DriveLimits, check_loop
from fricomp.control.loop.loop_check import LoopCheck

from ...stand_in import SensorSettings, StandIn, default_joint, default_limits
from .joint import TrackedJoint, loop_of

_PERIOD = 1e-3


def check_tracked(joint: TrackedJoint, bandwidth: float) -> LoopCheck:
    """Check the loop of `bandwidth` [Hz] around the stand-in's default drive, with the limits of its safety gate."""
    sensor = SensorSettings()
    _, loop = loop_of(bandwidth, sensor, _PERIOD)
    (limits,) = default_limits(StandIn(default_joint()))
    drive = DriveLimits(limits.torque, limits.torque_rate)
    return check_loop(joint.model, loop, period=_PERIOD, velocity_quantum=sensor.velocity_quantum(_PERIOD), drive=drive)
