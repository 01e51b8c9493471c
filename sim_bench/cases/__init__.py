"""Concealed cases: recordings of joints with physics that the user's simulation leaves out.

The generator has its own dynamics, its own friction and its own file writing, and imports neither the friction
laws nor the diagnosis, so that finding what it conceals proves something.
"""

from .case import Case, generate, record_again
from .effects import CATALOGUE, EFFECTS, OUTSIDE
from .excitation import EXCITATIONS
from .spec import CHOICES, CaseSpec
from .writing import derive_case_id, write_answer, write_case

__all__ = [
    "CATALOGUE",
    "CHOICES",
    "EFFECTS",
    "EXCITATIONS",
    "OUTSIDE",
    "Case",
    "CaseSpec",
    "derive_case_id",
    "generate",
    "record_again",
    "write_answer",
    "write_case",
]
