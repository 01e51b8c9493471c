"""Foreign files as columns: one format a module, each read by the package that knows it."""

from fricomp.recording.sources.columns import Columns, find_column
from fricomp.recording.sources.reader import is_text, read_columns, read_words

__all__ = ["Columns", "find_column", "is_text", "read_columns", "read_words"]
