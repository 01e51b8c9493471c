"""Other methods on concealed cases, to compare the diagnosis with."""

from .compare import compare_baselines, format_table
from .methods import METHODS

__all__ = ["METHODS", "compare_baselines", "format_table"]
