"""Compensation in the control loop, and what keeps it safe.

These are the names that a loop is built from; everything else is in the module that is named after it, such as
`fricomp.control.compensation.trust`.
"""

from fricomp.control.compensation.adaptation import AdaptationSettings, OnlineAdaptation
from fricomp.control.compensation.arm_load import ArmLoad
from fricomp.control.compensation.compensator import ArmCompensator, Compensator
from fricomp.control.compensation.network import NetworkCompensator
from fricomp.control.gate.gate import SafetyGate
from fricomp.control.gate.limits import JointLimits
from fricomp.control.loop.interruption import interrupt_on_ending_signals
from fricomp.control.loop.loop import ControlLoop, LoopResult
from fricomp.control.loop.loop_check import check_loop
from fricomp.control.loop.position_loop import Controller, PositionController, ReferenceState, SineReference
from fricomp.control.loop.real_time import RealTimeOptions
from fricomp.control.settings import CompensationSettings, DriveLimits, LoopDynamics

__all__ = [
    "AdaptationSettings",
    "ArmCompensator",
    "ArmLoad",
    "CompensationSettings",
    "Compensator",
    "ControlLoop",
    "Controller",
    "DriveLimits",
    "JointLimits",
    "LoopDynamics",
    "LoopResult",
    "NetworkCompensator",
    "OnlineAdaptation",
    "PositionController",
    "RealTimeOptions",
    "ReferenceState",
    "SafetyGate",
    "SineReference",
    "check_loop",
    "interrupt_on_ending_signals",
]
