"""The bidirectional sweep: plan, motion, plateaus, breakaway, friction points, and the model identified from them."""

from .analysis.analysis import SweepAnalysis, analyse_sweep
from .analysis.block import BlockLabel, SweepData, load_sweep
from .calibrate import Calibration, calibrate, channels_of, identify_recorded, mean_relative_deviation
from .estimate import Estimate, IdentificationSettings, estimate_friction
from .feasibility import check_feasible
from .motion.context import SweepContext, loop_period
from .motion_file import MotionFile, at_rows_rate, fit_into, read_motion, record_motion, travel_now
from .opening import open_joint
from .planning.accuracy import Assumption, assume_friction, expected_deviations
from .planning.plan import SweepPlan, default_speeds, plan_plateaus, travel_of
from .planning.settings import SweepSettings
from .report.written_run import WrittenRun, write_run
from .request import CalibrationOptions, CalibrationRequest
from .rigid_body import RigidBody
from .run_folder import RunFolder
from .sweep import Sweep
from .watch import SweepWatch, measure_live_point

__all__ = [
    "Assumption",
    "BlockLabel",
    "Calibration",
    "CalibrationOptions",
    "CalibrationRequest",
    "Estimate",
    "IdentificationSettings",
    "MotionFile",
    "RigidBody",
    "RunFolder",
    "Sweep",
    "SweepAnalysis",
    "SweepContext",
    "SweepData",
    "SweepPlan",
    "SweepSettings",
    "SweepWatch",
    "WrittenRun",
    "analyse_sweep",
    "assume_friction",
    "at_rows_rate",
    "calibrate",
    "channels_of",
    "check_feasible",
    "default_speeds",
    "estimate_friction",
    "expected_deviations",
    "fit_into",
    "identify_recorded",
    "load_sweep",
    "loop_period",
    "mean_relative_deviation",
    "measure_live_point",
    "open_joint",
    "plan_plateaus",
    "read_motion",
    "record_motion",
    "travel_now",
    "travel_of",
    "write_run",
]
