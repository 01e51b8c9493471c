"""The stand-in: joints with known friction that truly stick, behind simulated drives and sensors."""

from .backend import SimulatedJointAdapter, default_limits
from .packaged import (
    DEFAULT_LAW,
    NO_DISTURBANCE,
    PACKAGED_MODELS,
    default_joint,
    packaged_model,
    sensors_for,
    two_link_arm,
)
from .plant import NormalLoad, Plant, ThermalSettings
from .sensor import Reading, SensorSettings
from .servo import ServoSettings
from .stand_in import JointSettings, StandIn, StandInSettings

__all__ = [
    "DEFAULT_LAW",
    "NO_DISTURBANCE",
    "PACKAGED_MODELS",
    "JointSettings",
    "NormalLoad",
    "Plant",
    "Reading",
    "SensorSettings",
    "ServoSettings",
    "SimulatedJointAdapter",
    "StandIn",
    "StandInSettings",
    "ThermalSettings",
    "default_joint",
    "default_limits",
    "packaged_model",
    "sensors_for",
    "two_link_arm",
]
