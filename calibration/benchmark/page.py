"""The page `docs/identification.md`: measured figures from the ledger between what they mean."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from typing import Any

import numpy as np

from .departure import DepartureFigures
from .extras import ExtraFigures
from .ledger import Ledger
from .printed import NOISE_FREE, NOISY, PrintedRow
from .problem import NOISE_READINGS, PARAMETERS, PaperProblem, Reading
from .summary import (
    BatchFigures,
    SearchFigures,
    summarise_noise_free,
    summarise_outliers,
    summarise_searches,
    summarise_statistics,
)

__all__ = ["identification_page"]


_INTRODUCTION = """# Identification

Written by `fricomp bench paper`; every number below is measured by it. The comparison is with [luo2024pinn]
(see `references.md`), whose data, bounds and settings it repeats.

## The method, and what it is not

Eight parameters of the bidirectional Stribeck law and the paper's 2-20-20-20-1 tanh network are trained together on
the paper's two losses, each residual divided by its noise. Turning each pair of residuals (data, model) by 45 degrees
leaves the sum of squares as it is and separates it: one part holds the friction parameters alone and is the
likelihood, the other is what the network still has to learn. A Levenberg-Marquardt step in float64 eliminates the
network's weights through a system with one row a point. It starts from variable projection over the Stribeck velocity,
so that no range is asked for, and ends when the likelihood's own gradient says that the parameters are within 0.005
standard deviations of its optimum. All parameters are estimated as logarithms, and so are positive.

**The PINN gains nothing over least squares on data that follow the law.** With equal weights and a network that can
represent the curve, the paper's loss has the optimum of weighted least squares; the distances measured below are what
is left of the difference. `identify(..., method="least_squares")` gives the same parameters faster. What
the paper gains over PSO and GA is convergence: run long enough, a good PSO finds the same optimum. One data set proves
nothing either: the mean error of a single draw varies severalfold around that of the Cramér-Rao bound (below).

With relative noise, maximum likelihood includes how the noise grows with the model's torque (the determinant). It is
solved as least squares by a rescaling with the geometric mean of the model, exactly. Reweighted least squares without
the determinant ends about 0.07 standard deviations away.

The network that identified follows the noise of its points. The one exported is trained anew on a grid, to the closed
form; where held-out points ask for it, `fit_discrepancy` lets it depart from the closed form.
"""

_CLOSING = """
## Other laws, uncertainty, design

`identify(..., law=...)` takes `coulomb`, `coulomb_viscous`, `tanh`, `arctan`, `symmetric_stribeck`, `stribeck` from
points, and `dahl`, `lugre` from a time series with reversals (output error; a network of velocity and load has no
state and takes no part). `choose_law` compares by held-out likelihood. `profile_interval` serves where the likelihood
is not quadratic, `block_bootstrap` where samples are correlated, as those of a recorded motion are.
"""


def identification_page(ledger: Ledger, command: str) -> str:
    """The whole page as Markdown."""
    parts = [
        _INTRODUCTION,
        _how(command),
        "## Without noise: tables III to V\n",
        _printed_table(NOISE_FREE, _ours_noise_free(ledger)),
        _noise_free(ledger),
        "\n## With 5 % noise: tables VI to VIII\n",
        _printed_table(NOISY, _ours_noisy(ledger)),
        "`recomputed` averages the errors of the printed values. Two printed averages do not follow from them: "
        "0.4375 of the PINN without noise (0.4545), and 5.025 of GA with noise (4.390). The paper does not say which "
        "reading of 5 % noise it used.\n",
        "\n## Over many draws\n",
        *(_statistics(ledger, reading, _optima(ledger, reading)) for reading in NOISE_READINGS),
        "\n## Beside PSO, GA, CMA-ES, robust NLS and the paper's Adam\n",
        _searches(ledger),
        "\n## Outliers\n",
        _outliers(ledger),
        "\n## Where the joint is no Stribeck joint\n",
        _departure(ledger),
        "\n## Sweep chosen for information, and LuGre\n",
        _extras(ledger),
        _CLOSING,
    ]
    return "\n".join(part for part in parts if part)


def _how(command: str) -> str:
    return (
        f"Command: `{command}`. Draw k of a reading has the seed k. Machine: {os.cpu_count()} cores, "
        f"{platform.machine()}, shared with other work, so times compare only within a table.\n"
    )


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def _printed_table(printed: Sequence[PrintedRow], ours: Sequence[tuple[str, Any]]) -> str:
    rows = []
    for row in printed:
        error = row.recomputed()
        rows.append(
            [f"{row.method} (paper)", *(f"{e:.3f}" for e in error), f"{row.average:.4f}", f"{error.mean():.4f}"]
        )
    for name, values in ours:
        error = PaperProblem().error_percent(np.array(values))
        rows.append([name, *(f"{e:.2g}" if e < 1e-3 else f"{e:.3f}" for e in error), "", f"{error.mean():.3g}"])
    return _table(["\\|error\\| [%]", *PARAMETERS, "printed average", "recomputed"], rows)


def _ours_noise_free(ledger: Ledger) -> list[tuple[str, Any]]:
    rows = [("fricomp", row["values"]) for row in ledger.rows(study="noise_free", seed=0)]
    return rows + [("Adam, 50,000 steps", row["values"]) for row in ledger.rows(study="adam", reading="none")]


def _ours_noisy(ledger: Ledger) -> list[tuple[str, Any]]:
    found: list[tuple[str, Any]] = []
    for reading in NOISE_READINGS:
        rows = ledger.rows(study="search", reading=reading, seed=0, iterations=50_000)
        rows += ledger.rows(study="adam", reading=reading, seed=0)
        ours = ledger.rows(study="statistics", reading=reading, seed=0)
        found += [(f"fricomp, {reading} noise, draw 0", row["values"]) for row in ours]
        found += [(f"{row['method']}, {reading} noise, draw 0", row["values"]) for row in rows]
    return found


def _noise_free(ledger: Ledger) -> str:
    figures = summarise_noise_free(ledger)
    if not figures:
        return ""
    return (
        f"{figures['starts']:.0f} random starts (parameters within a factor of thirty, random network weights): all "
        f"{figures['converged']:.0f} converged, largest mean error "
        f"{figures['largest_mean_error_percent']:.2g} %, median {figures['median_mean_error_percent']:.2g} %, "
        f"median time {figures['seconds']:.2g} s.\n"
    )


def _optima(ledger: Ledger, reading: Reading) -> BatchFigures | None:
    rows = ledger.rows(study="optima", reading=reading)
    return BatchFigures(**rows[-1]["figures"]) if rows else None


def _statistics(ledger: Ledger, reading: Reading, optima: BatchFigures | None) -> str:
    problem = PaperProblem()
    bound = 100.0 * problem.cramer_rao(reading) / np.array(problem.true_values)
    found = summarise_statistics(ledger, reading)
    if optima is None:
        return ""
    rows = [
        ["Cramér-Rao bound [%]", *(f"{b:.2f}" for b in bound)],
        [f"likelihood optimum, {optima.draws} draws: RMS error / bound", *(f"{r:.3f}" for r in optima.rms_over_bound)],
        ["the same: coverage of 95 % intervals [%]", *(f"{100.0 * c:.1f}" for c in optima.coverage)],
    ]
    if found is None:
        return f"**{reading} noise**\n\n" + _table(["", *PARAMETERS], rows)
    rows += [
        [f"`identify`, {found.draws} draws: RMS error / bound", *(f"{r:.3f}" for r in found.rms_over_bound)],
        ["the same: coverage of 95 % intervals [%]", *(f"{100.0 * c:.1f}" for c in found.coverage)],
    ]
    return (
        f"**{reading} noise**. Monte-Carlo error of RMS / bound: ± {1.0 / np.sqrt(2.0 * optima.draws):.3f} for the "
        f"optimum, ± {found.rms_error:.3f} for `identify`; of the coverage: "
        f"± {100.0 * np.sqrt(0.95 * 0.05 / optima.draws):.1f} and ± {100.0 * found.coverage_error:.1f} %.\n\n"
        + _table(["", *PARAMETERS], rows)
        + f"\n{found.converged} of {found.draws} draws of `identify` (the PINN) reported `converged`. Distance to the "
        f"oracle's optimum, largest over all parameters and draws: {found.largest_distance:.2g} deviations "
        f"(RMS {found.typical_distance:.1g}); negative log-likelihood above the oracle's: "
        f"{found.largest_excess:.1g} at most. "
        f"Mean error {found.mean_error:.2f} %, of single draws from {found.error_spread[0]:.2f} to "
        f"{found.error_spread[1]:.2f} %. Median time {found.seconds:.2g} s.\n"
    )


def _searches(ledger: Ledger) -> str:
    rows = [_search_row(f, reading) for reading in NOISE_READINGS for f in summarise_searches(ledger, reading)]
    heads = [
        "method", "length", "noise", "draws", "mean error [%]", "ours [%]", "NLL above ours, median", "largest",
        "draws > 0.01", "ours above theirs, largest", "time [s]", "time / ours",
    ]  # fmt: skip
    return (
        "PSO and GA: population 100, the paper's bounds, learning factors 1, compiled (see `compiled_search.py`; pymoo "
        "runs the same rules several times slower); they minimise the same negative log-likelihood. Length: "
        "iterations, evaluations for CMA-ES, steps for Adam, which minimises the paper's unweighted loss. "
        "The paper ran 50,000 iterations throughout. Ours is the PINN.\n\n" + _table(heads, rows)
    )


def _search_row(f: SearchFigures, reading: str) -> list[str]:
    return [
        f.method, f"{f.iterations:,}" if f.iterations else "", reading, str(f.draws), f"{f.mean_error:.3f}",
        f"{f.our_mean_error:.3f}", f"{f.excess[0]:.2g}", f"{f.excess[1]:.2g}", str(f.missed),
        f"{f.our_largest_excess:.1g}", f"{f.seconds:.3g}", f"{f.seconds / f.our_seconds:.3g}",
    ]  # fmt: skip


def _outliers(ledger: Ledger) -> str:
    rows = []
    for reading in NOISE_READINGS:
        f = summarise_outliers(ledger, reading)
        if f is not None:
            rows.append([
                reading, str(f.draws), " ".join(f"{r:.2f}" for r in f.rms_over_bound),
                " ".join(f"{r:.2f}" for r in f.rms_of_converged), str(f.wrong_basins), str(f.silent_wrong_basins),
                str(f.flagged), f"{f.seconds:.2g}",
            ])  # fmt: skip
    heads = [
        "noise", "draws", "RMS / bound of the clean points", "the same, draws that report converged",
        "errors above 5 deviations", "of them reported as converged", "draws not reported converged", "time [s]",
    ]  # fmt: skip
    return (
        'One point in ten is off by ten standard deviations, either way, `loss="robust"`. Where two of the three '
        "slowest points of a direction are hit on the same side, two basins explain the data about equally well, "
        "and no method without further knowledge tells them apart; such draws are reported as "
        "`wrong_basin_suspected`.\n\n" + _table(heads, rows)
    )


def _departure(ledger: Ledger) -> str:
    figures = [DepartureFigures(**row["figures"]) for row in ledger.rows(study="departure")]
    rows = [
        [f.case, str(f.points), str(f.seeds), *(f"{e:.4f}" for e in (*f.inside, *f.outside)), str(f.departed)]
        for f in figures
    ]
    heads = [
        "joint", "points", "data sets", "closed form, between points", "exported network", "data-driven network",
        "closed form, beyond the speeds", "exported network", "data-driven network", "network departed",
    ]  # fmt: skip
    return "RMS torque error against the truth [N·m]; noise 0.01 N·m.\n\n" + _table(heads, rows)


def _extras(ledger: Ledger) -> str:
    rows = ledger.rows(study="extras")
    if not rows:
        return ""
    f = ExtraFigures(**rows[-1]["figures"])
    return (
        f"For the paper's parameters and 100 plateaus a direction, planned speeds bring the mean standard deviation "
        f"from {f.uniform_percent:.2f} to {f.planned_percent:.2f} % of the value (ratio {f.ratio:.3f}) under "
        f"5 % relative noise, {f.top_share:.0%} of the effort at top speed. Identified from simulated plateaus "
        f"at these speeds, the mean RMS error falls by {f.measured_ratio:.3f}.\n\n"
        f"LuGre from {f.lugre_seconds:.0f} s at 1 kHz with reversals and 2 % noise, {f.lugre_seeds} seeds: "
        f"largest error of a static parameter {f.lugre_static_percent:.2f} %, "
        f"of sigma_0 {f.lugre_stiffness_percent:.2f} %.\n"
    )
