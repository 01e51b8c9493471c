"""The diagnosis on public recordings of real joints, beside what was published on them."""

from .cases import REAL_CASES, RealCase
from .injection import INJECTABLE, InjectedSpec, inject
from .page import write_real_page
from .run import RealOutcome, run_all

__all__ = [
    "INJECTABLE",
    "REAL_CASES",
    "InjectedSpec",
    "RealCase",
    "RealOutcome",
    "inject",
    "run_all",
    "write_real_page",
]
