"""Tables that hold joints of the same names, each of one side of a robot: `left_arm.csv` beside `right_arm.csv`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from fricomp.arm.rigid.naming import match_joints
from fricomp.errors import SimulationFileError
from fricomp.recording import Recording

_WORD = re.compile(r"[A-Za-z]+|\d+")

Tables = Mapping[Path, tuple[Recording, ...]]
"""Recordings of the joints of each table."""


def list_called(paths: Sequence[Path]) -> list[str]:
    """What files are called: by their own names, or by those of their folders where their own are all the same."""
    stems = [path.stem for path in paths]
    return [path.parent.name for path in paths] if len(paths) > 1 and len(set(stems)) == 1 else stems


def join_sides(
    tables: Tables, simulated: Sequence[str], names: Mapping[str, str], notes: list[str]
) -> list[tuple[Recording, ...]]:
    """Recordings of all sides as one session, where each table is called after one; otherwise a session a table.

    Two sessions of one arm have the same joints as well. They are sides where the words in which the names of the files
    differ, before the names of their joints, make those of the simulation.

    Args:
        tables: In the order in which they were read.
        simulated: Names of the joints of the simulation.
        names: Names in the simulation by names in the log, where they differ by more than the word joint.
        notes: To which is added what was taken for what.
    """
    sessions = list(tables.values())
    sides = _list_sides(list(tables))
    joints = [one.metadata.joint for session in sessions for one in session]
    if len(sessions) < 2 or not all(sides) or len(set(joints)) == len(joints):
        return sessions
    joined = tuple(
        one.with_metadata(joint=f"{side}_{one.metadata.joint}")
        for side, session in zip(sides, sessions, strict=True)
        for one in session
    )
    try:
        match_joints([one.metadata.joint for one in joined], simulated, names)
    except SimulationFileError:
        return sessions
    told = ", ".join(f"{path} for {side}" for path, side in zip(_shorten(list(tables)), sides, strict=True))
    notes.append(f"Each table is taken for the side that it is called after: {told}.")
    return [joined]


def _list_sides(paths: Sequence[Path]) -> list[str]:
    """Words of each file's name that not all others have."""
    words = [_WORD.findall(name.lower()) for name in list_called(paths)]
    shared = set.intersection(*map(set, words)) if words else set()
    return ["_".join(word for word in each if word not in shared) for each in words]


def _shorten(paths: Sequence[Path]) -> list[str]:
    """Names of files that tell them from each other."""
    return [f"{path.parent.name}/{path.name}" if len({p.name for p in paths}) == 1 else path.name for path in paths]
