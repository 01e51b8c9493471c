"""Messages of several topics as one table: the rows are those of one topic, the others are read at its instants."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.recording.runs import find_covered, interpolate
from fricomp.recording.sources.columns import Columns, columns_of_records

_BARE = re.compile(r"data(\.\d+)?")
"""Field of a message that is a number, or a row of them, and nothing else: what it is, its topic says."""


@dataclass
class Topic:
    """Messages of one topic, in the order of the log.

    Attributes:
        log_time: When each was logged [s].
        records: Their fields, nested or flat.
    """

    log_time: list[float] = field(default_factory=list)
    records: list[dict[str, Any]] = field(default_factory=list)

    def add(self, log_time: float, record: dict[str, Any]) -> None:
        """Take one more message, logged at that time [s]."""
        self.log_time.append(log_time)
        self.records.append(record)

    def to_columns(self, *, clock: str = "stamp") -> Columns:
        """Its fields as columns, with `time` [s] from the stamps, or from the log where one has none.

        Args:
            clock: `stamp`, or `log` for the time of the log in any case.
        """
        columns = columns_of_records(self.records)
        return {**columns, "time": self.find_time(clock)}

    def find_time(self, clock: str = "stamp") -> NDArray[np.float64]:
        """Time of each message [s]. Shape (n,)."""
        logged = np.array(self.log_time)
        if clock == "log":
            return logged
        stamps = np.array([_find_stamp(record) for record in self.records])
        return np.where(np.isfinite(stamps), stamps, logged)

    @property
    def is_stamped(self) -> bool:
        """Whether every message has a stamp of its own."""
        return all(np.isfinite(_find_stamp(record)) for record in self.records)


def _find_stamp(record: Mapping[str, Any]) -> float:
    """Stamp of a message, or of its header unless that is zero, which nobody has set [s]; NaN where it has none."""
    if isinstance(record.get("time"), int | float):
        return float(record["time"])
    header = record.get("header")
    stamp = header.get("stamp") if isinstance(header, Mapping) else None
    if isinstance(stamp, Mapping):  # as JSON has the stamps of ROS 2, and of ROS 1
        stamp = _read_seconds(stamp, "sec", "nanosec") or _read_seconds(stamp, "secs", "nsecs")
    return float(stamp) if isinstance(stamp, int | float) and stamp > 0.0 else np.nan


def _read_seconds(stamp: Mapping[str, Any], whole: str, rest: str) -> float:
    seconds, nanoseconds = stamp.get(whole), stamp.get(rest)
    if isinstance(seconds, int | float) and isinstance(nanoseconds, int | float):
        return seconds + 1e-9 * nanoseconds
    return 0.0


def join_topics(topics: Mapping[str, Topic], lead: str, others: Sequence[str], *, clock: str = "stamp") -> Columns:
    """One table of several topics; its rows are the messages of `lead` that all others have messages around.

    Between two messages of another topic its columns are straight lines. A column keeps its name where no other topic
    has one of the same, and is called `<topic>.<column>` else; one that is called `data` has both names.

    Args:
        topics: All, by name.
        lead: Whose messages are the rows.
        others: Which are joined to it.
        clock: `stamp`: stamps, if all these topics have them, else the log; `log`: the time of the log.

    Raises:
        RecordingError: A topic is not there, or has no messages while `lead` has some.
    """
    for name in (lead, *others):
        if name not in topics:
            raise RecordingError(f"there is no topic {name!r} to read: it has {', '.join(sorted(topics)) or 'none'}")
    stamped = clock == "stamp" and all(topics[name].is_stamped for name in (lead, *others))
    axis = "stamp" if stamped else "log"
    instants = topics[lead].find_time(axis)
    covered = np.ones(instants.size, dtype=bool)
    for name in others:
        covered &= find_covered(np.sort(topics[name].find_time(axis)), instants)
    if not covered.any():
        raise RecordingError(
            f"topics {', '.join((lead, *others))} have no time in common: give 'clock = \"log\"' in the mapping if "
            "their stamps are of different clocks, or join fewer"
        )
    tables = {name: topics[name].to_columns(clock=clock) for name in (lead, *others)}
    names = [key for name in tables for key in tables[name]]
    joined: Columns = {key: values[covered] for key, values in tables[lead].items()}
    joined |= {f"{lead}.{key}": values for key, values in joined.items() if is_bare(key)}
    for name in others:
        time = topics[name].find_time(axis)
        for key, values in tables[name].items():
            if key == "time":
                continue
            at_instants = interpolate(instants[covered], time, values)
            joined |= {key: at_instants} if names.count(key) == 1 else {}
            joined |= {f"{name}.{key}": at_instants} if names.count(key) > 1 or is_bare(key) else {}
    return joined


def is_bare(column: str | int) -> bool:
    """Whether a column is called `data`, or is an entry of such a row, so that its topic alone says what it is."""
    return _BARE.fullmatch(str(column)) is not None
