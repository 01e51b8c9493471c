"""Many calls at once: executors shared by the benchmarks, and fleets of joints."""

from .executor import EXECUTORS, SerialExecutor, always, open_executor, stream

__all__ = ["EXECUTORS", "SerialExecutor", "always", "open_executor", "stream"]
