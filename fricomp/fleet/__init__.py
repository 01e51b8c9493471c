"""Many calls at once: executors shared by the benchmarks, and fleets of joints."""

from .executor import EXECUTORS, SerialExecutor, always, open_executor, stream
from .joint import FleetJoint, find_recordings, is_joint_table, list_joints, read_joint_table
from .rows import FleetRow, read_rows
from .run import Work, run_fleet
from .severity import Severity, rate_row

__all__ = [
    "EXECUTORS",
    "FleetJoint",
    "FleetRow",
    "SerialExecutor",
    "Severity",
    "Work",
    "always",
    "find_recordings",
    "is_joint_table",
    "list_joints",
    "open_executor",
    "rate_row",
    "read_joint_table",
    "read_rows",
    "run_fleet",
    "stream",
]
