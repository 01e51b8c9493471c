"""The column of time of a log, and its unit."""
