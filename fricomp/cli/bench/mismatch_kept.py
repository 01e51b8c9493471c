"""Scored runs that are kept: ended with a reason, or their answers made again and held against the seals."""

from __future__ import annotations

from pathlib import Path

__all__ = ["only"]


def only(close: str | None, replay: int, log: Path, executor: tuple[str, int | None]) -> None:
    """Close the kept run, or else verify the one that was to be replayed.

    Raises:
        DiagnosisError: Neither can be done, or an answer does not have the hash that was sealed.
    """
    from fricomp.errors import DiagnosisError

    if close is not None:
        _close(close, log)
    elif replay:
        _verify(replay, log, executor)
    else:
        raise DiagnosisError("--verify needs the number of a scored run: give --replay N too")


def _close(reason: str, log: Path) -> None:
    """End the scored run whose data stands beside the log."""
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.proof import close_run

    run = close_run(reason, log)
    console().print(f"scored run {run} is closed; its data is in {log.parent / f'run-{run}'}", soft_wrap=True)


def _verify(run: int, log: Path, executor: tuple[str, int | None]) -> None:
    """Make the answers of a scored run again and compare."""
    from fricomp.cli.terminal import console, progress
    from fricomp.errors import DiagnosisError
    from fricomp.sim_bench.fleet import open_executor
    from fricomp.sim_bench.proof import verify_seals

    with progress() as bar, open_executor(*executor) as pool:
        task = bar.add_task("answers made again", total=None)
        found = verify_seals(run, log, pool, Path.cwd(), lambda total: bar.update(task, total=total, advance=1))
    told = f"scored run {run}: {found.agree} answers made again have the hash that was sealed"
    told += f", {found.unmade} cases could not be made then or now" if found.unmade else ""
    console().print(told, soft_wrap=True)
    if not found.holds:
        parts = {
            "have another hash": found.differ,
            "are not in the plan of this code": found.unplanned,
            "could not be made then and can now": found.unexpected,
        }
        raise DiagnosisError("; ".join(f"{len(some)} {what}, {some[0]} first" for what, some in parts.items() if some))
