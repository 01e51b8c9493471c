"""The bidirectional sweep: plan, motion, plateaus, breakaway, friction points, and the model identified from them."""

from .analysis.analysis import analyse_sweep
from .analysis.block import BlockLabel, SweepData, load_sweep
from .calibrate import Calibration, calibrate, channels_of, identify_recorded
from .estimate import IdentificationSettings
from .feasibility import check_feasible
from .motion.context import SweepContext, loop_period
from .motion_file import MotionFile, at_rows_rate, fit_into, read_motion, record_motion, travel_now
from .opening import open_joint
from .planning.accuracy import assume_friction, expected_deviations
from .planning.plan import SweepPlan, plan_plateaus
from .planning.settings import SweepSettings
from .report.written_run import write_run
from .request import CalibrationOptions, CalibrationRequest
from .rigid_body import RigidBody
from .run_folder import RunFolder
from .sweep import Sweep
from .watch import SweepWatch, measure_live_point

__all__ = [
    "BlockLabel",
    "Calibration",
    "CalibrationOptions",
    "CalibrationRequest",
    "IdentificationSettings",
    "MotionFile",
    "RigidBody",
    "RunFolder",
    "Sweep",
    "SweepContext",
    "SweepData",
    "SweepPlan",
    "SweepSettings",
    "SweepWatch",
    "analyse_sweep",
    "assume_friction",
    "at_rows_rate",
    "calibrate",
    "channels_of",
    "check_feasible",
    "expected_deviations",
    "fit_into",
    "identify_recorded",
    "load_sweep",
    "loop_period",
    "measure_live_point",
    "open_joint",
    "plan_plateaus",
    "read_motion",
    "record_motion",
    "travel_now",
    "write_run",
]
