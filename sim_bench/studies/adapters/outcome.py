"""The figures of all measurements, as one outcome."""

from collections.abc import Sequence
from dataclasses import dataclass

from fricomp.report import Section, Table

from ..kit.outcome import StudyOutcome
from .calibration import CalibrationComparison, chance_explains
from .cost import LARGEST_COST, CycleCost
from .fuzz import FuzzResult
from .peers import PeerComparison
from .serial_can import RoundTrip
from .soak import SoakResult


@dataclass(frozen=True)
class AdapterFigures:
    """What was measured.

    Attributes:
        peers: Against independent encoders.
        calibrations: Through every adapter and its twin.
        fuzz: Under garbage.
        soak: In a loop, with faults at random.
        cost: Of a cycle.
        slcan: Over a serial line.
    """

    peers: tuple[PeerComparison, ...]
    calibrations: tuple[CalibrationComparison, ...]
    fuzz: tuple[FuzzResult, ...]
    soak: tuple[SoakResult, ...]
    cost: tuple[CycleCost, ...]
    slcan: tuple[RoundTrip, ...]

    @property
    def passed(self) -> bool:
        """Whether frames, calibrations and behaviour under garbage are as they should be; times are only told."""
        verdicts = [
            *(each.passed for each in self.peers),
            *(each.passed for each in self.calibrations),
            *(each.passed for each in self.fuzz),
            *(each.passed for each in self.soak),
        ]
        return all(verdicts) and chance_explains(self.calibrations)


def summarise_adapters(figures: AdapterFigures) -> StudyOutcome:
    """A table for each measurement."""
    summary = (
        "Every adapter's frames beside those of an independent package, a joint calibrated through it, its behaviour "
        "under garbage, and what a control cycle costs it in units of one bare Stribeck curve timed beside it.",
    )
    tables = {
        "Frames against independent encoders": _tabulate_peers(figures.peers),
        "Calibration of one joint through adapter and twin, beside the same joint alone": _tabulate_calibrations(
            figures
        ),
        "Random and damaged frames": _tabulate_fuzz(figures.fuzz),
        "A joint in its loop, with faults at random": _tabulate_soak(figures.soak),
        "Encode, gate and decode, a joint, without the bus": _tabulate_cost(figures.cost),
        "Round trip over slcan on one pseudo-terminal": _tabulate_slcan(figures.slcan),
    }
    sections = tuple(Section(title, (table,)) for title, table in tables.items() if table.rows)
    return StudyOutcome("Adapters", summary, figures, sections, figures.passed)


def _tabulate_peers(peers: Sequence[PeerComparison]) -> Table:
    rows = tuple(
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
    return Table(("protocol", "peer", "commands", "identical", "differences and their reason", "unexplained"), rows)


def _tabulate_calibrations(figures: AdapterFigures) -> Table:
    rows = []
    for each in figures.calibrations:
        worst = each.worst
        largest = max(abs(p.error) for p in each.parameters)
        rows.append(
            (
                each.protocol,
                "on" if each.noise else "off",
                each.mode,
                f"{each.n_used} of {each.n_planned}",
                f"{largest:.2%}",
                f"{each.n_within} of {len(each.parameters)}",
                f"{worst.name.removeprefix('stribeck.')}: {worst.error:+.2%}, {worst.normalised:+.1f}",
            )
        )
    heads = ("protocol", "noise", "mode", "plateaus used", "largest difference", "within two standard errors")
    return Table((*heads, "farthest off: difference, in standard errors"), tuple(rows))


def _tabulate_fuzz(results: Sequence[FuzzResult]) -> Table:
    rows = tuple(
        (
            each.protocol,
            f"{each.n_frames}",
            f"{each.n_cycles}",
            f"{each.n_trips}",
            f"{len(each.foreign)}",
            f"{each.largest_torque:.4f} of {each.torque_limit:.4f}",
            f"{each.memory_growth / 1024:.0f}",
        )
        for each in results
    )
    heads = ("protocol", "frames", "cycles", "stops", "foreign exceptions", "largest torque")
    return Table((*heads, "memory growth in the second half [KiB]"), rows)


def _tabulate_soak(results: Sequence[SoakResult]) -> Table:
    rows = tuple(
        (
            each.protocol,
            f"{each.n_ticks}",
            f"{each.n_healthy}",
            f"{len(each.false_trips)}",
            f"{sum(each.n_faults.values())}",
            f"{sum(each.n_stops.values())}",
            f"{1e3 * max(each.slowest.values(), default=0.0):.0f}",
            f"{len(each.foreign)}",
            f"{each.largest_torque:.3f}",
            f"{each.still_torque}",
            f"{each.memory_growth / 1024:.0f}",
        )
        for each in results
    )
    heads = ("protocol", "cycles", "healthy", "of them stopped", "faults", "stops", "slowest stop of a lie [ms]")
    return Table((*heads, "foreign", "largest torque [of the limit]", "torque after an end", "memory [KiB]"), rows)


def _tabulate_cost(costs: Sequence[CycleCost]) -> Table:
    rows = tuple(
        (each.protocol, f"{each.n_joints}", f"{1e6 * each.seconds:.1f}", f"{each.units:.1f}", f"{LARGEST_COST:g}")
        for each in costs
    )
    return Table(("protocol", "joints", "µs", "× bare Stribeck", "wanted at most with seven"), rows)


def _tabulate_slcan(trips: Sequence[RoundTrip]) -> Table:
    rows = tuple(
        (f"{each.n_frames}", each.echo, f"{1e6 * each.chunked:.0f}", f"{1e6 * each.bytewise:.0f}", f"{each.ratio:.1f}")
        for each in trips
    )
    return Table(("frames together", "sent back by", "in chunks [µs]", "python-can [µs]", "times faster"), rows)
