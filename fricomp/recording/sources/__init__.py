"""Foreign files as columns: one format a module, each read by the package that knows it."""

from fricomp.recording.sources.columns import Columns, Contents, find_column
from fricomp.recording.sources.reader import is_text, read_columns, read_contents

__all__ = ["Columns", "Contents", "find_column", "is_text", "read_columns", "read_contents"]
