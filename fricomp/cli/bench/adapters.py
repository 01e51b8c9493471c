"""`fricomp bench adapters`: peers, fuzz, cost of a cycle, and slcan."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fricomp.report import ReportPage
    from fricomp.report.page import Table
    from fricomp.sim_bench.adapter_bench.cost import CycleCost
    from fricomp.sim_bench.adapter_bench.fuzz import FuzzResult
    from fricomp.sim_bench.adapter_bench.peers import PeerComparison
    from fricomp.sim_bench.adapter_bench.serial_can import RoundTrip

    Results = tuple[list[PeerComparison], list[FuzzResult], list[CycleCost], list[RoundTrip]]

__all__ = ["app"]

app = typer.Typer()

JOINT_COUNTS = (1, 7)
FRAME_COUNTS = (1, 14)


@app.command(epilog="fricomp bench adapters --quick --out runs/adapters\n\nfricomp bench adapters --out runs/adapters")
def adapters(
    out: Annotated[Path, typer.Option(help="Folder for figures.json and report.html.")] = Path("runs/bench_adapters"),
    quick: Annotated[bool, typer.Option("--quick", help="A fiftieth of the frames.")] = False,
    frames: Annotated[int, typer.Option(help="Random and damaged frames a protocol; 0 for the size's own.")] = 0,
    commands: Annotated[int, typer.Option(help="Random commands a protocol against its peer.")] = 10_000,
    only: Annotated[str, typer.Option(help="One protocol alone for fuzz and cost.")] = "",
) -> None:
    """Every adapter against an independent encoder, under garbage, in time; and slcan in chunks.

    Exit status 1 if a difference has no reason, something foreign was raised, or torque went beyond the gate's limit.
    """
    import msgspec

    from fricomp.cli.terminal import console
    from fricomp.report import write_report

    out.mkdir(parents=True, exist_ok=True)
    results = _measure(commands, frames or (20_000 if quick else 1_000_000), only, quick)
    names = ("peers", "fuzz", "cost", "slcan")
    content = msgspec.json.encode(dict(zip(names, results, strict=True)))
    (out / "figures.json").write_bytes(msgspec.json.format(content))
    tables = _tables(results)
    write_report(_page(tables), out / "report.html")
    _print(tables)
    console().print(f"Figures and report in {out}")
    peers, fuzzed, _, _ = results
    if not (all(each.passed for each in peers) and all(each.passed for each in fuzzed)):
        raise typer.Exit(1)


def _measure(n_commands: int, n_frames: int, only: str, quick: bool) -> Results:
    from fricomp.cli.terminal import progress
    from fricomp.errors import ParameterError
    from fricomp.sim_bench.adapter_bench.bench import PROTOCOLS
    from fricomp.sim_bench.adapter_bench.cost import measure_cost
    from fricomp.sim_bench.adapter_bench.fuzz import fuzz_adapter
    from fricomp.sim_bench.adapter_bench.peers import PEERS, compare_with_peer
    from fricomp.sim_bench.adapter_bench.serial_can import compare_slcan

    if only and only not in PROTOCOLS:
        raise ParameterError(f"no protocol {only!r}; there are {', '.join(PROTOCOLS)}")
    protocols = [only] if only else list(PROTOCOLS)
    peers, fuzzed, costs = [], [], []
    with progress() as bar:
        task = bar.add_task("adapters", total=len(PEERS) + 2 * len(protocols) + 1)
        for name in PEERS:
            peers.append(compare_with_peer(name, n_commands))
            bar.advance(task)
        for name in protocols:
            costs += [measure_cost(name, n_joints, 300 if quick else 2000) for n_joints in JOINT_COUNTS]
            bar.advance(task)
        trips = [compare_slcan(together, 50 if quick else 300) for together in FRAME_COUNTS]
        bar.advance(task)
        for name in protocols:
            fuzzed.append(fuzz_adapter(name, n_frames))
            bar.advance(task)
    return peers, fuzzed, costs, trips


def _tables(results: Results) -> Sequence[tuple[str, Table]]:
    from fricomp.report import Table
    from fricomp.sim_bench.adapter_bench.cost import LARGEST_COST

    peers, fuzzed, costs, trips = results
    compared = tuple(
        (
            each.protocol,
            each.peer,
            f"{each.n_commands}",
            f"{each.n_identical}",
            "; ".join(f"{count}: {reason}" for reason, count in each.differences.items()) or "none",
            f"{len(each.unexplained)}",
        )
        for each in peers
    )
    garbage = tuple(
        (
            each.protocol,
            f"{each.n_frames}",
            f"{each.n_cycles}",
            f"{each.n_trips}",
            f"{len(each.foreign)}",
            f"{each.largest_torque:.4f} of {each.torque_limit:.4f}",
            f"{each.memory_growth / 1024:.0f}",
        )
        for each in fuzzed
    )
    timed = tuple(
        (each.protocol, f"{each.n_joints}", f"{1e6 * each.seconds:.1f}", f"{each.units:.1f}", f"{LARGEST_COST:g}")
        for each in costs
    )
    slcan = tuple(
        (f"{each.n_frames}", f"{1e6 * each.chunked:.0f}", f"{1e6 * each.bytewise:.0f}", f"{each.ratio:.1f}")
        for each in trips
    )
    return (
        (
            "Frames against independent encoders",
            Table(
                ("protocol", "peer", "commands", "identical", "differences and their reason", "unexplained"), compared
            ),
        ),
        (
            "Random and damaged frames",
            Table(
                (
                    "protocol",
                    "frames",
                    "cycles",
                    "stops",
                    "foreign exceptions",
                    "largest torque",
                    "memory growth [KiB]",
                ),
                garbage,
            ),
        ),
        (
            "Encode, gate and decode, a joint, without the bus",
            Table(("protocol", "joints", "µs", "× bare Stribeck", "wanted at most"), timed),
        ),
        (
            "Round trip over slcan on one pseudo-terminal",
            Table(("frames together", "in chunks [µs]", "python-can [µs]", "times faster"), slcan),
        ),
    )


def _page(tables: Sequence[tuple[str, Table]]) -> ReportPage:
    from fricomp.report import ReportPage, Section

    summary = (
        "Every adapter's frames beside those of an independent package, its behaviour under garbage, and what a "
        "control cycle costs it in units of one bare Stribeck curve timed beside it.",
    )
    return ReportPage("Adapters", summary, tuple(Section(title, (table,)) for title, table in tables))


def _print(tables: Sequence[tuple[str, Table]]) -> None:
    from rich.table import Table as Printed

    from fricomp.cli.terminal import console

    screen = console()
    for title, table in tables:
        printed = Printed(*table.columns, title=title)
        for row in table.rows:
            printed.add_row(*row)
        screen.print(printed)
