"""A diagnosis for people: tables, charts, the report page, and the folder of files."""

from .files import WrittenDiagnosis, write_diagnosis
from .fleet import build_fleet_row, build_fleet_table, write_fleet
from .page import build_diagnosis_page, draw_diagnosis_charts
from .tables import (
    build_base_table,
    build_brief_effect_table,
    build_change_table,
    build_effect_table,
    build_error_table,
    build_forward_table,
    build_location_table,
    build_residual_table,
)
from .wording import (
    VERDICT_TITLES,
    Units,
    derive_parameters,
    describe_next_step,
    format_interval,
    format_location,
    format_quantity,
)

__all__ = [
    "VERDICT_TITLES",
    "Units",
    "WrittenDiagnosis",
    "build_base_table",
    "build_brief_effect_table",
    "build_change_table",
    "build_diagnosis_page",
    "build_effect_table",
    "build_error_table",
    "build_fleet_row",
    "build_fleet_table",
    "build_forward_table",
    "build_location_table",
    "build_residual_table",
    "derive_parameters",
    "describe_next_step",
    "draw_diagnosis_charts",
    "format_interval",
    "format_location",
    "format_quantity",
    "write_diagnosis",
    "write_fleet",
]
