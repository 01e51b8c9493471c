"""The page of `fricomp bench mismatch`, with its title and the command that makes it again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fricomp.sim_bench.studies.proof import RunSettings, Score

__all__ = ["write"]


def write(
    page: Path, settings: RunSettings, scores: Sequence[Score], planned: int, out: Path, others: str, log: Path
) -> None:
    """Write the page of a run, and beside it the data of the run."""
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.studies.proof import BASELINES, GAP, format_earlier, keep_data, read_entries, write_page

    title, reproduce = _title(settings, len(scores), planned), _reproduce(settings, len(scores), out, page)
    earlier = format_earlier(read_entries(log), settings.run) if settings.scored else ""
    gaps, kept_others = (_read(page.with_suffix("") / name) for name in (GAP, BASELINES))
    write_page(
        scores,
        page,
        title=title,
        reproduce=reproduce,
        baselines=others or kept_others,
        earlier=earlier,
        gaps=gaps,
        clear=settings.clear,
    )
    keep_data(out, page.with_suffix(""))
    console().print(f"{page} written", soft_wrap=True)


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


def _title(settings: RunSettings, count: int, planned: int) -> str:
    cases = f"{count} cases" if count >= planned else f"{count} of {planned} cases, in the order of the plan"
    if settings.scored:
        kind = "Replay of scored" if settings.replayed else "Scored"
        return f"{kind} run {settings.run} of the diagnosis with tree {settings.tree[:12]}: {cases}."
    of = f"Diagnosis with tree {settings.tree[:12]}, development" if settings.tree else "Development"
    return f"{of} seeds from {settings.first_seed}: {cases}. No scored run."


def _reproduce(settings: RunSettings, count: int, out: Path, page: Path) -> str:
    if settings.scored:
        return f"fricomp bench mismatch-replay {settings.run} --cases {count} --out runs/replay"
    seeds = f"--first-seed {settings.first_seed}"
    kind = "".join(f"--{name} " for name in ("quick", "clear", "nulls", "injected") if getattr(settings, name))
    return (
        f"fricomp bench mismatch {kind}--cases {settings.cases} {seeds} --page docs/{page.name} --out runs/{out.name}"
    )
