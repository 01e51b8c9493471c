"""Logs that say by the names of their columns what they hold, so that nobody has to write a mapping.

`column` says what a name means, `source` reads a file's columns, `log` makes a recording of each joint.
"""
