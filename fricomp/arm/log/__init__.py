"""Logs of whole arms as robots write them: one file or several, with the columns of all joints beside each other.

`column` says what a column's name means, `source` reads a file's columns, `reading` makes a recording of each joint.
"""

from .reading import ArmLog, is_recording, list_log_files, read_arm_log

__all__ = ["ArmLog", "is_recording", "list_log_files", "read_arm_log"]
