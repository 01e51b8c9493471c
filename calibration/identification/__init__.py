"""Identification of friction laws at the statistical limit."""

from .design import SpeedPlan, expected_deviation, plan_informative_speeds
from .discrepancy import DiscrepancyNetwork, fit_discrepancy
from .dynamic import DynamicIdentification, identify_dynamic
from .files import ModelFiles, save_discrepancy, save_identification
from .identify import identify
from .inference.uncertainty import BootstrapSample, Interval, block_bootstrap, profile_interval
from .options import IdentificationOptions
from .result import IdentificationResult, NoiseEstimate
from .selection import LawChoice, choose_law
from .status import Status

__all__ = [
    "BootstrapSample",
    "DiscrepancyNetwork",
    "DynamicIdentification",
    "IdentificationOptions",
    "IdentificationResult",
    "Interval",
    "LawChoice",
    "ModelFiles",
    "NoiseEstimate",
    "SpeedPlan",
    "Status",
    "block_bootstrap",
    "choose_law",
    "expected_deviation",
    "fit_discrepancy",
    "identify",
    "identify_dynamic",
    "plan_informative_speeds",
    "profile_interval",
    "save_discrepancy",
    "save_identification",
]
