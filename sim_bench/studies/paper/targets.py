"""What was to be reached, beside what was measured."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from ..kit.store import RowStore
from .extras import ExtraFigures
from .problem import NOISE_READINGS
from .rival_summary import NoiseFreeFigures, SearchFigures, summarise_noise_free, summarise_searches
from .rivals import PAPER_LENGTH
from .summary import StatisticsFigures, summarise_outliers, summarise_statistics
from .timing import OURS, TimeFigures, summarise_timing


@dataclass(frozen=True)
class Target:
    """One line of the table.

    Attributes:
        what: What was measured.
        wanted: The figure to reach.
        measured: The figure measured.
        reached: Whether it was.
    """

    what: str
    wanted: str
    measured: str
    reached: bool


def judge_targets(ledger: RowStore) -> list[Target]:
    """The lines for which the ledger holds figures."""
    free = summarise_noise_free(ledger)
    found = [f for reading in NOISE_READINGS if (f := summarise_statistics(ledger, reading))]
    rivals = [f for reading in NOISE_READINGS for f in summarise_searches(ledger, reading)]
    times = summarise_timing(ledger)
    parts: Iterable[list[Target]] = (
        _judge_noise_free(free),
        _judge_statistics(found),
        _judge_likelihood(rivals),
        _judge_speed(times),
        _judge_adam(free, times),
        _judge_outliers(ledger),
        _judge_extras(ledger),
    )
    return [target for part in parts for target in part]


def _judge_noise_free(figures: list[NoiseFreeFigures]) -> list[Target]:
    if not figures:
        return []
    f = figures[0]
    return [
        Target(
            "no noise, 41 points, random starts: mean error",
            "≤ 1e-3 % from each of 100",
            f"≤ {f.largest_error:.1e} % from each of {f.runs}: {f.from_start} by training from the start's Stribeck "
            "velocity, the others after a second start",
            f.largest_error <= 1e-3 and f.converged == f.runs,
        )
    ]


def _judge_statistics(figures: list[StatisticsFigures]) -> list[Target]:
    if not figures:
        return []
    draws = " and ".join(f"{f.draws}" for f in figures)
    distance = max(f.largest_distance for f in figures)
    ratio = [r for f in figures for r in f.rms_over_bound]
    covered = [100.0 * c for f in figures for c in f.coverage]
    error, share = max(f.rms_error for f in figures), 100.0 * max(f.coverage_error for f in figures)
    return [
        Target(
            "5 % noise, both readings, every draw: distance to the oracle's optimum",
            "≤ 0.1 deviations",
            f"≤ {distance:.2g} in {draws} draws",
            distance <= 0.1,
        ),
        Target(
            "the same: RMS error / Cramér-Rao bound of each parameter",
            "0.95 to 1.06",
            f"{min(ratio):.3f} to {max(ratio):.3f}, each ± {error:.3f}",
            min(ratio) >= 0.95 and max(ratio) <= 1.06,
        ),
        Target(
            "the same: coverage of 95 % intervals",
            "93.5 to 96.5 %",
            f"{min(covered):.1f} to {max(covered):.1f} %, each ± {share:.1f}",
            min(covered) >= 93.5 and max(covered) <= 96.5,
        ),
    ]


def _judge_likelihood(rivals: list[SearchFigures]) -> list[Target]:
    searches = [f for f in rivals if f.method != "Adam"]
    if not searches:
        return []
    worst = max(f.our_largest_excess for f in searches)
    counts = sum(f.draws for f in searches)
    return [
        Target(
            "negative log-likelihood above the best of PSO, GA, CMA-ES and NLS on the same draws",
            "≤ 0.01",
            f"≤ {worst:.1g} in {counts} comparisons",
            worst <= 0.01,
        )
    ]


def _judge_speed(times: list[TimeFigures]) -> list[Target]:
    ours = {f.reading: f.seconds for f in times if f.method == OURS}
    searches = [f for f in times if f.length and f.method != "Adam"]
    if not searches:
        return []
    at_length = [(f.method, f.seconds / ours[f.reading]) for f in searches]
    reached = [(f.method, f.seconds_to_optimum / ours[f.reading]) for f in searches if f.seconds_to_optimum]
    what = "processor time over ours: PSO and GA at the paper's length, CMA-ES"
    return [
        _judge_ratio(what, at_length),
        *([_judge_ratio("the same until they are at the optimum, where they get there", reached)] if reached else []),
    ]


def _judge_ratio(what: str, ratios: list[tuple[str, float]]) -> Target:
    least: dict[str, float] = {}
    for name, ratio in ratios:
        least[name] = min(ratio, least.get(name, ratio))
    measured = "; ".join(f"{name}: {ratio:.1f}" for name, ratio in least.items())
    return Target(what, "≥ 20", f"{measured} (the lowest over the kinds of noise)", min(least.values()) >= 20.0)


def _judge_adam(figures: list[NoiseFreeFigures], times: list[TimeFigures]) -> list[Target]:
    adam = [f for f in figures if f.method == "Adam" and f.iterations == PAPER_LENGTH]
    seconds = {f.method: f.seconds for f in times if f.reading == "none"}
    if not adam or "Adam" not in seconds:
        return []
    share = figures[0].largest_error / min(f.smallest_error for f in adam)
    faster = seconds["Adam"] / seconds[OURS]
    return [
        Target(
            "no noise: processor time of 50,000 Adam steps over ours; our largest error over that of its best start",
            "≥ 20; ≤ 0.1",
            f"{faster:.0f}; {share:.1e}",
            faster >= 20.0 and share <= 0.1,
        )
    ]


def _judge_outliers(ledger: RowStore) -> list[Target]:
    figures = [(r, f) for r in NOISE_READINGS if (f := summarise_outliers(ledger, r))]
    if not figures:
        return []
    worst = ", ".join(f"{max(f.rms_over_bound):.2f} {reading}" for reading, f in figures)
    wrong = sum(f.wrong_basins for _, f in figures)
    silent = sum(f.silent_wrong_basins for _, f in figures)
    draws = " and ".join(str(f.draws) for _, f in figures)
    return [
        Target(
            "10 % outliers of 10 sigma: largest RMS error / bound of the clean points",
            "≤ 1.3",
            f"{worst}, in {draws} draws",
            all(max(f.rms_over_bound) <= 1.3 for _, f in figures),
        ),
        Target(
            "the same: coverage of 95 % intervals, draws that report `converged`",
            "93.5 to 96.5 %",
            _format_span([100.0 * c for _, f in figures for c in f.coverage]),
            all(0.935 <= c <= 0.965 for _, f in figures for c in f.coverage),
        ),
        Target(
            "the same: draws in a wrong basin (an error above 5 deviations)",
            "0",
            f"{wrong}, of which reported as `converged`: {silent}",
            wrong == 0,
        ),
    ]


def _format_span(values: list[float]) -> str:
    return f"{min(values):.1f} to {max(values):.1f} %" if values else "no draw reports `converged`"


def _judge_extras(ledger: RowStore) -> list[Target]:
    rows: list[dict[str, Any]] = ledger.rows(study="further")
    if not rows:
        return []
    f = ExtraFigures(**max(rows, key=lambda row: int(row["size"]))["figures"])
    return [
        Target(
            "speeds chosen for information, same duration: mean deviation over the uniform grid's",
            "≤ 0.75",
            f"{f.ratio:.3f} expected, {f.measured_ratio:.3f} on simulated plateaus",
            f.ratio <= 0.75 and f.measured_ratio <= 0.75,
        ),
        Target(
            "LuGre, 2 % noise, encoder: static parameters, sigma_0, sigma_1",
            "≤ 2 %, ≤ 10 %, ≤ 10 %",
            f"≤ {f.lugre_static_percent:.2f} %, ≤ {f.lugre_stiffness_percent:.2f} %, ≤ {f.lugre_damping_percent:.1f} %"
            f" in {f.lugre_seeds} records",
            f.lugre_static_percent <= 2.0 and f.lugre_stiffness_percent <= 10.0 and f.lugre_damping_percent <= 10.0,
        ),
    ]
