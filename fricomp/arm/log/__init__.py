"""Logs of whole arms as robots write them: one file or several, with the columns of all joints beside each other."""

from .reading import ArmLog, list_log_files, read_arm_log

__all__ = ["ArmLog", "list_log_files", "read_arm_log"]
