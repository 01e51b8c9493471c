"""`fricomp bench adapters`: peers, calibration through twins, fuzz, cost of a cycle, and slcan."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args

import typer

from fricomp.cli.option.panel import Overwrite

if TYPE_CHECKING:
    from fricomp.sim_bench.studies.adapters.outcome import AdapterFigures

app = typer.Typer(add_completion=False)

JOINT_COUNTS = (1, 7)
FRAME_COUNTS = (1, 14)

Part = Literal["cost", "slcan", "peers", "calibration", "fuzz", "soak"]


@app.command(epilog="fricomp bench adapters --quick --out runs/adapters\n\nfricomp bench adapters --out runs/adapters")
def adapters(
    out: Annotated[Path, typer.Option(help="Folder for figures.json and report.html.")] = Path("runs/bench_adapters"),
    quick: Annotated[bool, typer.Option("--quick", help="A fiftieth of the frames, short sweeps.")] = False,
    frames: Annotated[int, typer.Option(help="Random and damaged frames a protocol; 0 for the size's own.")] = 0,
    commands: Annotated[int, typer.Option(help="Random commands a protocol against its peer.")] = 10_000,
    ticks: Annotated[int, typer.Option(help="Cycles of the soak a protocol; 0 for the size's own.")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Of the soak's motions and faults.")] = 1,
    part: Annotated[Part | None, typer.Option(help="Measure this part alone.")] = None,
    only: Annotated[str, typer.Option(help="One protocol alone for calibration, fuzz, soak and cost.")] = "",
    overwrite: Overwrite = False,
) -> None:
    """Every adapter against an independent encoder, through its twin, under garbage, in time; and slcan in chunks.

    The soak runs a joint's loop with faults of links, drives and sensors at random. Exit status 1 if a difference has
    no reason, a calibration does not agree, something foreign was raised, a healthy joint was stopped, or torque went
    beyond the gate's limit.
    """
    from fricomp.cli.bench.outcome import claim_study, end_study
    from fricomp.extras import require
    from fricomp.sim_bench.studies.adapters.outcome import summarise_adapters
    from fricomp.sim_bench.studies.adapters.peers import PEER_MODULES
    from fricomp.sim_bench.studies.kit.outcome import write_outcome

    with claim_study(out, "serial", overwrite=overwrite):
        require(*PEER_MODULES, extra="dev")
        full = 20_000 if quick else 1_000_000
        parts = (part,) if part else get_args(Part)
        outcome = summarise_adapters(_measure(parts, commands, frames or full, ticks or full, seed, only, quick))
        write_outcome(outcome, out)
    end_study(outcome, out)


def _measure(
    parts: Collection[Part], n_commands: int, n_frames: int, n_ticks: int, seed: int, only: str, quick: bool
) -> AdapterFigures:
    from fricomp.cli.terminal import progress
    from fricomp.errors import ParameterError
    from fricomp.sim_bench.studies.adapters.bench import PROTOCOLS
    from fricomp.sim_bench.studies.adapters.calibration import compare_all
    from fricomp.sim_bench.studies.adapters.cost import measure_cost
    from fricomp.sim_bench.studies.adapters.fuzz import fuzz_adapter
    from fricomp.sim_bench.studies.adapters.outcome import AdapterFigures
    from fricomp.sim_bench.studies.adapters.peers import PEERS, compare_with_peer
    from fricomp.sim_bench.studies.adapters.serial_can import ECHOES, compare_slcan
    from fricomp.sim_bench.studies.adapters.soak import soak_adapter

    if only and only not in PROTOCOLS:
        raise ParameterError(f"no protocol {only!r}; there are {', '.join(PROTOCOLS)}")
    protocols = [only] if only else list(PROTOCOLS)
    n_rounds = 300 if quick else 2000
    jobs: dict[Part, list[Callable[[], Any]]] = {
        "cost": [partial(measure_cost, name, n, n_rounds) for name in protocols for n in JOINT_COUNTS],
        "slcan": [partial(compare_slcan, n, echo, 50 if quick else 300) for echo in ECHOES for n in FRAME_COUNTS],
        "peers": [partial(compare_with_peer, name, n_commands) for name in PEERS],
        "calibration": [partial(compare_all, noise, protocols, quick=quick) for noise in (False, True)],
        "fuzz": [partial(fuzz_adapter, name, n_frames) for name in protocols],
        "soak": [partial(soak_adapter, name, n_ticks, seed) for name in protocols],
    }
    found: dict[Part, list[Any]] = {part: [] for part in jobs}
    with progress() as bar:
        task = bar.add_task("adapters", total=sum(len(jobs[part]) for part in parts))
        for part in parts:
            for job in jobs[part]:
                found[part].append(job())
                bar.advance(task)
    calibrations = (comparison for both in found["calibration"] for comparison in both)
    return AdapterFigures(
        tuple(found["peers"]),
        tuple(calibrations),
        tuple(found["fuzz"]),
        tuple(found["soak"]),
        tuple(found["cost"]),
        tuple(found["slcan"]),
    )
