"""The diagnosis on public recordings of real joints, beside what was published on them."""

from .cases import REAL_CASES, RealCase
from .page import write_real_page
from .run import RealOutcome, run_case

__all__ = ["REAL_CASES", "RealCase", "RealOutcome", "run_case", "write_real_page"]
