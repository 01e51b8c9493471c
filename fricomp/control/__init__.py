"""Compensation in the control loop, and what keeps it safe."""

from fricomp.control.adaptation import AdaptationSettings, OnlineAdaptation
from fricomp.control.batch import compute_compensation, compute_friction
from fricomp.control.bristle import FALLING_SHARE_WITHOUT_VELOCITY, deepest_bend
from fricomp.control.choice import choose_settings
from fricomp.control.compensator import ArmCompensator, Compensator
from fricomp.control.confidence import compute_confident_gain, compute_friction_deviation
from fricomp.control.curve import CurveParameters, FrictionCurves, split_law
from fricomp.control.gate import ABSURD_TORQUE_RATIO, SafetyGate, TripReason, TripRecord
from fricomp.control.hot_path import TorqueFunction
from fricomp.control.interruption import interrupt_on_ending_signals
from fricomp.control.limit_cycle import LIMIT_CYCLE_MARGIN
from fricomp.control.limits import JointLimits
from fricomp.control.load import LoadModel, ReportedLoad
from fricomp.control.loop import ControlLoop, LoopAdapter, LoopResult
from fricomp.control.loop_check import GainScan, LoopCheck, check_loop
from fricomp.control.loop_log import LoopLog, LoopTiming
from fricomp.control.loop_simulation import LoopCases, SimulatedLoop, simulate_loop
from fricomp.control.network import NetworkCompensator
from fricomp.control.position_loop import Controller, PositionController, Reference, ReferenceState, SineReference
from fricomp.control.real_time import RealTimeOptions, RealTimeReport, real_time
from fricomp.control.settings import CompensationSettings, DriveLimits, LoopDynamics, Source
from fricomp.control.trust import (
    LARGEST_EXTRAPOLATION,
    bound_friction,
    compute_torque_cap,
    find_doubt,
    find_doubt_in_status,
    require_usable,
    trusted_curves,
)

__all__ = [
    "ABSURD_TORQUE_RATIO",
    "FALLING_SHARE_WITHOUT_VELOCITY",
    "LARGEST_EXTRAPOLATION",
    "LIMIT_CYCLE_MARGIN",
    "AdaptationSettings",
    "ArmCompensator",
    "CompensationSettings",
    "Compensator",
    "ControlLoop",
    "Controller",
    "CurveParameters",
    "DriveLimits",
    "FrictionCurves",
    "GainScan",
    "JointLimits",
    "LoadModel",
    "LoopAdapter",
    "LoopCases",
    "LoopCheck",
    "LoopDynamics",
    "LoopLog",
    "LoopResult",
    "LoopTiming",
    "NetworkCompensator",
    "OnlineAdaptation",
    "PositionController",
    "RealTimeOptions",
    "RealTimeReport",
    "Reference",
    "ReferenceState",
    "ReportedLoad",
    "SafetyGate",
    "SimulatedLoop",
    "SineReference",
    "Source",
    "TorqueFunction",
    "TripReason",
    "TripRecord",
    "bound_friction",
    "check_loop",
    "choose_settings",
    "compute_compensation",
    "compute_confident_gain",
    "compute_friction",
    "compute_friction_deviation",
    "compute_torque_cap",
    "deepest_bend",
    "find_doubt",
    "find_doubt_in_status",
    "interrupt_on_ending_signals",
    "real_time",
    "require_usable",
    "simulate_loop",
    "split_law",
    "trusted_curves",
]
