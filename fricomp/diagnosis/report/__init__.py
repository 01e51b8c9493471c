"""A diagnosis for people: tables, charts, the report page, and the folder of files."""

from .files import WrittenDiagnosis, write_diagnosis
from .fleet import fleet_row, fleet_table, write_fleet
from .page import diagnosis_charts, diagnosis_page
from .tables import base_table, change_table, effect_table, error_table, forward_table, location_table
from .wording import (
    VERDICT_TITLES,
    Units,
    derived_parameters,
    format_interval,
    format_location,
    format_quantity,
    next_step,
    with_names,
)

__all__ = [
    "VERDICT_TITLES",
    "Units",
    "WrittenDiagnosis",
    "base_table",
    "change_table",
    "derived_parameters",
    "diagnosis_charts",
    "diagnosis_page",
    "effect_table",
    "error_table",
    "fleet_row",
    "fleet_table",
    "format_interval",
    "format_location",
    "format_quantity",
    "forward_table",
    "location_table",
    "next_step",
    "with_names",
    "write_diagnosis",
    "write_fleet",
]
