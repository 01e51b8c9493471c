"""All timings of `fricomp bench speed` in one run."""

import cProfile
import pstats
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .timing import Growth, Timing, fit_growth, measure_unit, time_call
from .work import SpeedCase, list_peers, list_work, make_case

_SHOWN = 10
"""Functions of the profile that are shown."""


@dataclass(frozen=True)
class PeerTiming:
    """Another package beside this one.

    Attributes:
        name: The package, and what it fits.
        ours: Name of the timing that it stands beside.
        units: Its processor time [units].
        of_ours: That over the one of this package.
    """

    name: str
    ours: str
    units: float
    of_ours: float


@dataclass(frozen=True)
class SpeedFigures:
    """What was measured.

    Attributes:
        unit: Processor time of the unit on this machine [s].
        timings: Of each call.
        growth: Of each group of them.
        peers: Of other packages.
        absent: Packages that are not installed here.
        first: What a diagnosis says first: the words, units and seconds until then.
        slowest: Name of the slowest diagnosis.
        profile: Its functions with the largest own time, and their share.
    """

    unit: float
    timings: tuple[Timing, ...]
    growth: tuple[Growth, ...]
    peers: tuple[PeerTiming, ...]
    absent: tuple[str, ...]
    first: tuple[tuple[str, float, float], ...]
    slowest: str
    profile: tuple[tuple[str, float], ...]


def measure_speed(folder: Path, *, quick: bool, progress: Callable[[str], None]) -> SpeedFigures:
    """Time everything.

    Args:
        folder: For the files of the cases.
        quick: Shorter recordings and smaller tables.
        progress: Called with what is timed next.
    """
    timings = []
    for group, name, size, call in list_work(folder, quick=quick):
        progress(name)
        timings.append(time_call(group, name, size, call))
    progress("other packages")
    peers, absent = _time_peers(timings, folder, quick)
    progress("first answers and profile")
    slow = make_case(2, 20.0 if quick else 60.0, folder / "slow")
    first = _time_first_answers(slow)
    slowest = f"two effects, {slow.recording.duration:.0f} s"
    return SpeedFigures(
        measure_unit(), tuple(timings), tuple(fit_growth(timings)), peers, absent, first, slowest, _profile(slow)
    )


def _time_peers(timings: list[Timing], folder: Path, quick: bool) -> tuple[tuple[PeerTiming, ...], tuple[str, ...]]:
    ours = {one.name: one.units for one in timings}
    peers = list_peers(folder, quick=quick)
    found = [
        (one, time_call("peers", one.name, 1.0, one.call)) for one in peers if one.call is not None and one.ours in ours
    ]
    rows = tuple(PeerTiming(one.name, one.ours, timing.units, timing.units / ours[one.ours]) for one, timing in found)
    return rows, tuple(one.name for one in peers if one.call is None)


def _time_first_answers(case: SpeedCase) -> tuple[tuple[str, float, float], ...]:
    """When each word of progress comes: units of processor time and seconds since the call."""
    from fricomp.diagnosis import diagnose

    unit, said = measure_unit(), []
    start, begin = time.process_time(), time.perf_counter()

    def say(words: str) -> None:
        said.append((words, (time.process_time() - start) / unit, time.perf_counter() - begin))

    diagnose(case.recording, case.folder / "joint.xml", progress=say)
    return tuple(said)


def _profile(case: SpeedCase) -> tuple[tuple[str, float], ...]:
    """Functions with the largest share of processor time of all threads; the kernel's is that of whoever waits."""
    profile = cProfile.Profile(time.process_time)
    profile.runcall(case.diagnose)
    stats = pstats.Stats(profile)
    rows: dict[tuple[str, int, str], tuple[int, int, float, float, object]] = stats.stats  # type: ignore[attr-defined]
    total = sum(row[2] for row in rows.values())
    ranked = sorted(rows.items(), key=lambda item: -item[1][2])[:_SHOWN]
    return tuple((_name(*place), row[2] / total) for place, row in ranked)


def _name(file: str, line: int, function: str) -> str:
    if "acquire" in function:
        return "the compiled kernel, in its threads"
    return f"{Path(file).stem}.{function}" if line else function.strip("<>{}")
