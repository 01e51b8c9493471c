"""The measured parts of the page `docs/identification.md`, each from the ledger."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from fricomp.report import format_markdown_table

from ..kit.store import RowStore
from .departure import DepartureFigures
from .extras import ExtraFigures
from .load_departure import LoadFigures
from .printed import PrintedRow
from .problem import NOISE_READINGS, PARAMETERS, PaperProblem, Reading
from .rival_summary import SearchFigures, find_best_adam, name_of, summarise_noise_free, summarise_searches
from .rivals import PAPER_LENGTH
from .summary import StatisticsFigures, summarise_outliers, summarise_statistics
from .targets import judge_targets
from .timing import OURS, summarise_timing


def _write_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return format_markdown_table(heads, rows) + "\n"


def _select_largest(ledger: RowStore, study: str) -> list[dict[str, Any]]:
    """Figures of the rows of the largest size, where a ledger has seen several."""
    rows = ledger.rows(study=study)
    size = max((int(row["size"]) for row in rows), default=0)
    return [row["figures"] for row in rows if row["size"] == size]


def format_target_table(ledger: RowStore) -> str:
    """What was wanted beside what was measured."""
    rows = [[t.what, t.wanted, t.measured, "yes" if t.reached else "**no**"] for t in judge_targets(ledger)]
    return _write_table(["what", "wanted", "measured", "reached"], rows)


def format_printed_table(printed: Sequence[PrintedRow], ledger: RowStore, readings: Sequence[Reading]) -> str:
    """Values and errors as the paper prints them, and the same of ours and of our runs of its methods."""
    rows = []
    for row in printed:
        rows += _list_pair(f"{row.method} (paper)", row.values, f"{row.average:.4f}")
    for reading in readings:
        rows += [line for name, values in _list_own(ledger, reading) for line in _list_pair(name, values, "")]
    return _write_table(["method", "", *PARAMETERS, "average printed", "average recomputed"], rows)


def _list_pair(name: str, values: Sequence[float], printed: str) -> list[list[str]]:
    error = PaperProblem().error_percent(np.array(values))
    shown = [f"{e:.1e}" if e < 1e-3 else f"{e:.3f}" for e in error]
    return [
        [name, "value", *(f"{v:.5f}" for v in values), "", ""],
        ["", "error [%]", *shown, printed, f"{error.mean():.3g}" if error.mean() < 1e-3 else f"{error.mean():.4f}"],
    ]


def _list_own(ledger: RowStore, reading: Reading) -> list[tuple[str, Sequence[float]]]:
    study = "noise_free" if reading == "none" else "statistics"
    wanted = {} if reading == "none" else {"reading": reading}
    noise = "" if reading == "none" else f", {reading} noise"
    found = [(f"fricomp{noise}", row["values"]) for row in ledger.rows(study=study, seed=0, **wanted)]
    rows = ledger.rows(study="search", reading=reading, seed=0, iterations=PAPER_LENGTH)
    rows += find_best_adam(ledger, reading)
    return found + [(f"{name_of(row)}, {row['iterations']:,}{noise}", row["values"]) for row in rows]


def format_noise_free_section(ledger: RowStore) -> str:
    """Every method from many starts."""
    figures = summarise_noise_free(ledger)
    if not figures:
        return ""
    rows = [
        [
            f.method, f.starts, f"{f.iterations:,}" if f.iterations else "", str(f.runs), str(f.below_one),
            f"{f.median_error:.2g}", f"{f.smallest_error:.2g} to {f.largest_error:.2g}",
        ]
        for f in figures
    ]  # fmt: skip
    heads = ["method", "starts", "length", "runs", "below 1 %", "mean error, median [%]", "range [%]"]
    ours = figures[0]
    return (
        f"Starts lie anywhere within the factor of the middle of the search box, F_s above F_c, network weights are "
        f"random. fricomp takes the Stribeck velocities of such a start, brings them within the speeds measured and "
        f"solves for the other six parameters: {ours.from_start} of {ours.runs} trainings meet the data to rounding "
        f"from there, the others from the projection's own start; {ours.converged} report `converged`. `this training "
        "alone` and Adam take all eight parameters as they are drawn, and nothing comes after. With noise Adam starts "
        "from the best of its starts.\n\n" + _write_table(heads, rows)
    )


def format_statistics_section(ledger: RowStore, reading: Reading) -> str:
    """Errors and intervals over many draws of one noise reading."""
    problem, f = PaperProblem(), summarise_statistics(ledger, reading)
    if f is None:
        return ""
    bound = 100.0 * problem.cramer_rao(reading) / np.array(problem.true_values)
    rows = [
        ["Cramér-Rao bound [%]", *(f"{b:.2f}" for b in bound)],
        ["RMS error / bound", *(f"{r:.3f}" for r in f.rms_over_bound)],
        ["coverage of 95 % intervals [%]", *(f"{100.0 * c:.1f}" for c in f.coverage)],
    ]
    table = _write_table(["", *PARAMETERS], rows)
    return f"**{reading} noise, {f.draws} draws**\n\n{table}\n{_format_remarks(f)}"


def _format_remarks(f: StatisticsFigures) -> str:
    return (
        f"Monte-Carlo error: ± {f.rms_error:.3f} of RMS / bound, ± {100.0 * f.coverage_error:.2f} % of the coverage. "
        f"{f.from_projection} of {f.draws} trainings from the projection ended at the optimum of least squares, where "
        f"one that does not begins anew; {f.converged} report `converged`. "
        f"Distance to the oracle's optimum, largest over all parameters and draws: {f.largest_distance:.2g} "
        f"deviations (RMS {f.typical_distance:.1g}); negative log-likelihood above the oracle's: "
        f"{f.largest_excess:.1g} at most. Mean error {f.mean_error:.2f} %, of single draws from "
        f"{f.error_spread[0]:.2f} to {f.error_spread[1]:.2f} %.\n"
    )


def format_search_section(ledger: RowStore) -> str:
    """The other methods beside ours on the same draws."""
    rows = [_list_search(f, reading) for reading in NOISE_READINGS for f in summarise_searches(ledger, reading)]
    heads = [
        "method", "length", "noise", "draws", "mean error [%]", "ours [%]", "NLL above ours, median", "largest",
        "draws > 0.01", "ours above theirs, largest",
    ]  # fmt: skip
    return _write_table(heads, rows)


def _list_search(f: SearchFigures, reading: str) -> list[str]:
    return [
        f.method, f"{f.iterations:,}" if f.iterations else "", reading, str(f.draws), f"{f.mean_error:.3f}",
        f"{f.our_mean_error:.3f}", f"{f.excess[0]:.2g}", f"{f.excess[1]:.2g}", str(f.missed),
        f"{f.our_largest_excess:.1g}",
    ]  # fmt: skip


def format_timing_section(ledger: RowStore) -> str:
    """Processor time of every method."""
    figures = summarise_timing(ledger)
    ours = {f.reading: f.seconds for f in figures if f.method == OURS}
    rows = [
        [
            f.reading,
            f.method,
            f"{f.length:,}" if f.length else "",
            f"{f.seconds:.3g}",
            f"{f.seconds / ours[f.reading]:.3g}",
            f"{f.seconds_to_optimum:.3g}" if f.seconds_to_optimum else "",
            f"{f.seconds_to_optimum / ours[f.reading]:.3g}" if f.seconds_to_optimum else "",
        ]
        for f in figures
    ]
    heads = ["noise", "method", "length", "processor time [s]", "/ ours", "until at the optimum [s]", "/ ours"]
    return _write_table(heads, rows) if rows else ""


def format_outlier_section(ledger: RowStore) -> str:
    """Robust fits of contaminated draws."""
    rows = []
    for reading in NOISE_READINGS:
        f = summarise_outliers(ledger, reading)
        if f is not None:
            rows.append([
                reading, str(f.draws), " ".join(f"{r:.2f}" for r in f.rms_over_bound),
                " ".join(f"{r:.2f}" for r in f.rms_of_converged), " ".join(f"{100.0 * c:.0f}" for c in f.coverage),
                str(f.wrong_basins), str(f.silent_wrong_basins), str(f.flagged),
            ])  # fmt: skip
    heads = [
        "noise", "draws", "RMS / bound of the clean points", "the same, draws that report `converged`",
        "coverage of their 95 % intervals [%]", "errors above 5 deviations", "of them reported as `converged`",
        "draws not reported `converged`",
    ]  # fmt: skip
    return _write_table(heads, rows)


def format_departure_section(ledger: RowStore) -> str:
    """Closed form and networks on a joint that is no Stribeck joint."""
    found = [DepartureFigures(**figures) for figures in _select_largest(ledger, "departure")]
    errors = [(f, (*f.inside, *f.outside)) for f in found]
    return _tabulate_networks("points", "between points", "beyond the speeds", errors)


def format_load_section(ledger: RowStore) -> str:
    """The same at several normal loads."""
    found = [LoadFigures(**figures) for figures in _select_largest(ledger, "loads")]
    errors = [(f, (*f.between, *f.beyond)) for f in found]
    return _tabulate_networks("points at each load", "between the loads", "beyond the loads", errors) if found else ""


def _tabulate_networks(
    points: str, near: str, far: str, found: Sequence[tuple[DepartureFigures | LoadFigures, Sequence[float]]]
) -> str:
    rows = [
        [f.case, str(f.points), str(f.seeds), *(f"{error:.4f}" for error in errors), str(f.departed)]
        for f, errors in found
    ]
    networks = ["exported network", "data-driven network"]
    heads = ["joint", points, "data sets", f"{near}: closed form", *networks, f"{far}: closed form", *networks]
    return _write_table([*heads, "network departed"], rows)


def format_extras_section(ledger: RowStore) -> str:
    """Speeds chosen for information, and LuGre."""
    return "".join(
        f"For the paper's parameters and 100 plateaus a direction, planned speeds bring the mean standard deviation "
        f"from {f.uniform_percent:.2f} to {f.planned_percent:.2f} % of the value (ratio {f.ratio:.3f}) under "
        f"5 % relative noise, {f.top_share:.0%} of the effort at top speed. Identified from simulated plateaus "
        f"at these speeds, the mean RMS error is {f.measured_ratio:.3f} of the uniform grid's.\n\n"
        f"LuGre from {f.lugre_seconds:.0f} s at 1 kHz with reversals and 2 % noise, {f.lugre_seeds} records of a joint "
        f"solved at 20 kHz by another rule, its velocity from the counts of an 18-bit encoder through a low-pass of "
        f"60 Hz: largest error of a static parameter {f.lugre_static_percent:.2f} %, "
        f"of sigma_0 {f.lugre_stiffness_percent:.2f} %, of sigma_1 {f.lugre_damping_percent:.1f} %; "
        f"{f.lugre_coverage:.0%} of the 95 % intervals hold the truth, {f.lugre_converged} report `converged`. What "
        f"encoder and low-pass do to the velocity is not in the intervals; without a low-pass it is more.\n"
        for f in (ExtraFigures(**figures) for figures in _select_largest(ledger, "further"))
    )
