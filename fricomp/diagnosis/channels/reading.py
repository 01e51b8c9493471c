"""All that two channels show of each other, of all recordings of a joint."""

from __future__ import annotations

from collections.abc import Sequence

from fricomp.recording import Recording

from ..record.result import NamedEffect
from .held_output import read_held_output
from .late_drive import find_late_drive
from .measured_load import read_measured_load
from .torque_sensor import compare_torques


def read_channels(recordings: Sequence[Recording]) -> tuple[NamedEffect, ...]:
    """What command, torque, and the torque of a sensor say of each other; a late drive first."""
    late = find_late_drive(recordings)
    longest = max(recordings, key=len)
    return (*(() if late is None else (late,)), *compare_torques(longest))


def read_loads(recordings: Sequence[Recording]) -> tuple[NamedEffect, ...]:
    """What a measured load shows of the friction, and all that other channels do; nothing where it shows nothing."""
    found = read_measured_load(recordings)
    return () if found is None else (found, *read_channels(recordings))


def read_held(recordings: Sequence[Recording]) -> tuple[NamedEffect, ...]:
    """What a held output shows of gear, shaft and clamp; nothing where one of the recordings has none."""
    found = [read_held_output(one) for one in recordings]
    return found[0] if all(found) else ()
