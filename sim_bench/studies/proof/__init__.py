"""Proof of the diagnosis on concealed cases: sealing, running in another process, scoring."""

from .gap import GAP, GapScore, format_gaps, measure_gaps, plan_gaps
from .injected import plan_bare, plan_injected
from .judging import is_wrong
from .kept import BASELINES, keep_data, restore_data
from .page import format_failures, write_page
from .plan import GROUPS, PlannedCase, plan_cases, plan_clear_cases
from .power import compute_power
from .run import count_open, read_refused, read_scores, run_proof
from .score import Score
from .settings import (
    QUICK_DURATION,
    RunSettings,
    draw_seeds,
    list_development_seeds,
    load_or_start,
    load_replay,
    plan_run,
    stop_after,
)
from .speed_up import measure_speed_up
from .summary import compute_figures

__all__ = [
    "BASELINES",
    "GAP",
    "GROUPS",
    "QUICK_DURATION",
    "GapScore",
    "PlannedCase",
    "RunSettings",
    "Score",
    "compute_figures",
    "compute_power",
    "count_open",
    "draw_seeds",
    "format_failures",
    "format_gaps",
    "is_wrong",
    "keep_data",
    "list_development_seeds",
    "load_or_start",
    "load_replay",
    "measure_gaps",
    "measure_speed_up",
    "plan_bare",
    "plan_cases",
    "plan_clear_cases",
    "plan_gaps",
    "plan_injected",
    "plan_run",
    "read_refused",
    "read_scores",
    "restore_data",
    "run_proof",
    "stop_after",
    "write_page",
]
