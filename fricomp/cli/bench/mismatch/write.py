"""Writing the page of a run, with its title and the command that makes it again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fricomp.sim_bench.studies.proof import RunSettings, Score


def write_run_page(
    page: Path, settings: RunSettings, scores: Sequence[Score], planned: int, out: Path, others: str
) -> None:
    """Write the page of a run, and beside it the data of the run."""
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.studies.proof import BASELINES, GAP, keep_data, write_page

    gaps, kept_others = (_read(page.with_suffix("") / name) for name in (GAP, BASELINES))
    write_page(
        scores,
        page,
        title=_title(settings, len(scores), planned),
        reproduce=_reproduce(settings, len(scores), out, page),
        baselines=others or kept_others,
        gaps=gaps,
        clear=settings.clear,
    )
    keep_data(out, page.with_suffix(""))
    console().print(f"{page} written", soft_wrap=True)


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


def _title(settings: RunSettings, count: int, planned: int) -> str:
    cases = f"{count} cases" if count >= planned else f"{count} of {planned} cases, in the order of the plan"
    commits = " and ".join(settings.commits)
    if settings.scored:
        kind = "The cases of a scored run, diagnosed again" if settings.replayed else "Scored run"
        return f"{kind}, measured at commit {commits}: {cases}."
    return f"Development seeds from {settings.first_seed}, measured at commit {commits}: {cases}. No scored run."


def _reproduce(settings: RunSettings, count: int, out: Path, page: Path) -> str:
    if settings.scored:
        return f"fricomp bench mismatch replay docs/proof --cases {count} --out runs/replay"
    seeds = f"--first-seed {settings.first_seed}"
    kind = "".join(f"--{name} " for name in ("quick", "clear", "nulls", "injected") if getattr(settings, name))
    options = f"{kind}--cases {settings.cases} {seeds} --page docs/{page.name} --out runs/{out.name}"
    return f"fricomp bench mismatch run {options}"
