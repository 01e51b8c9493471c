"""The version, for those parts of the library that write it down."""

__version__ = "0.1.0"
