"""Which joint of a simulation each recorded joint is."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import combinations

from fricomp.errors import SimulationFileError
from fricomp.recording.named.column import simplify_joint
from fricomp.recording.named.joints.joint_name import count_from_one

_MOST_STRANGERS, _LEAST_JOINTS = 2, 2
"""Joints that a simulation may lack, and must have for that."""


def parse_names(pairs: Sequence[str]) -> dict[str, str]:
    """Names in the simulation by names in the recordings, from RECORDED=SIMULATED, several with commas between.

    Raises:
        SimulationFileError: One has no equals sign.
    """
    each = [pair.strip() for text in pairs for pair in text.split(",") if pair.strip()]
    for pair in each:
        if "=" not in pair:
            raise SimulationFileError(f"--match {pair!r} has no '=': write RECORDED=SIMULATED, as in joint_1=elbow")
    return {recorded.strip(): simulated.strip() for recorded, simulated in (pair.split("=", 1) for pair in each)}


def match_joints(recorded: Sequence[str], simulated: Sequence[str], given: Mapping[str, str]) -> dict[str, str]:
    """Name in the simulation of each recorded joint.

    Equal names are the same joint, and so are those that differ by the word joint, by case, marks or leading zeros,
    where that leaves no choice: `joint_1`, `J1`, and `panda_joint1` where all names of one side have `panda` before
    those of the other. Recordings that count from zero are those of a simulation that counts from one. Where every
    joint of the simulation was recorded, names that are among the words of just one of its names are that joint:
    `shoulder`, or `axis1`, of `j1_shoulder`.

    Args:
        recorded: Names in the recordings.
        simulated: Names of the joints that turn or slide, in the order of the file.
        given: What the user says; it goes before all else.

    Raises:
        SimulationFileError: A name is of no joint, or two joints would be the same; the message has the line to write.
    """
    unknown = [name for name in given if name not in recorded]
    if unknown:
        raise SimulationFileError(
            f"--match names {unknown[0]!r}, which was not recorded: the recordings are of {', '.join(recorded)}"
        )
    called = count_from_one([name for name in recorded if name not in given], simulated)
    free = [called.get(name, name) for name in recorded if name not in given]
    free = [name for name in free if name not in simulated]
    prefixes = _find_prefix(free, simulated), _find_extra(free, simulated)
    found = {name: given.get(name) or _find(called.get(name, name), simulated, prefixes) for name in recorded}
    missing = [name for name, there in found.items() if there not in simulated]
    twice = [name for name, there in found.items() if list(found.values()).count(there) > 1]
    if not missing and not twice:
        return {name: str(there) for name, there in found.items()}
    by_words = {name: given.get(name) or _find_by_words(name, simulated) for name in recorded}
    if sorted(map(str, by_words.values())) == sorted(simulated):
        return {name: str(there) for name, there in by_words.items()}
    taken = [there for name, there in found.items() if name not in {*missing, *twice}]
    raise SimulationFileError(_write_refusal([*missing, *twice], [one for one in simulated if one not in taken]))


def match_in_order(recorded: Sequence[str], chain: Sequence[str]) -> dict[str, str]:
    """Name in the simulation of each recorded joint, where recordings have numbers alone and joints are one chain.

    Logs number joints from the base outwards, as a chain has them. Names of the simulation that are numbered otherwise
    contradict that.

    Args:
        recorded: Names in the recordings.
        chain: Names of all joints of the simulation that turn or slide by themselves, from the base outwards; none
            where they branch.

    Returns:
        Nothing where that does not tell them.
    """
    numbers = {name: int(simplify_joint(name)) for name in recorded if simplify_joint(name).isdigit()}
    first = min(numbers.values(), default=0)
    counted = sorted(numbers.values()) == list(range(first, first + len(chain))) and first in (0, 1)
    own = [int(found[0]) for found in (re.findall(r"\d+", name) for name in chain) if found]
    if len(numbers) < len(recorded) or not counted or own != sorted(own):
        return {}
    return {name: chain[number - first] for name, number in numbers.items()}


def find_strangers(recorded: Sequence[str], simulated: Sequence[str], given: Mapping[str, str]) -> tuple[str, ...]:
    """Recorded joints that a simulation lacks, such as those of a gripper, where all of its own are recorded too.

    None where fewer or other names could be them as well, or where more than two joints are too many.

    Args:
        recorded: As for `match_joints`.
        simulated: As for `match_joints`.
        given: As for `match_joints`; what it names is no stranger.
    """
    count = len(recorded) - len(simulated)
    if not 0 < count <= _MOST_STRANGERS or len(simulated) < _LEAST_JOINTS:
        return ()
    found = []
    for apart in combinations([name for name in recorded if name not in given], count):
        with suppress(SimulationFileError):
            match_joints([name for name in recorded if name not in apart], simulated, given)
            found.append(apart)
    return found[0] if len(found) == 1 else ()


def _find(name: str, simulated: Sequence[str], prefixes: tuple[str, str]) -> str | None:
    """The joint of a simulation that has this name, or the only one that has it but for the words before it.

    Args:
        name: In the recordings.
        simulated: Names in the simulation.
        prefixes: Words that stand before it in the simulation alone, and in the recordings alone.
    """
    if name in simulated:
        return name
    wanted = prefixes[0] + simplify_joint(name).removeprefix(prefixes[1])
    alike = [one for one in simulated if simplify_joint(one) == wanted]
    return alike[0] if len(alike) == 1 else None


def _find_by_words(name: str, simulated: Sequence[str]) -> str | None:
    """The only joint of a simulation among the words of whose name are all of this one."""
    wanted = set(simplify_joint(name).split("_"))
    alike = [one for one in simulated if wanted <= set(simplify_joint(one).split("_"))]
    return alike[0] if len(alike) == 1 else None


def _find_prefix(recorded: Sequence[str], simulated: Sequence[str]) -> str:
    """Words before every recorded name in the simulation, such as that of the robot; the shortest that fits all."""
    wanted = [simplify_joint(name) for name in recorded]
    there = {simplify_joint(name) for name in simulated}
    if not wanted:
        return ""
    prefixes = {name.removesuffix(wanted[0]) for name in there if name == wanted[0] or name.endswith(f"_{wanted[0]}")}
    fitting = sorted((one for one in prefixes if all(one + name in there for name in wanted)), key=_count_words)
    alone = len(fitting) == 1 or (len(fitting) > 1 and _count_words(fitting[0]) < _count_words(fitting[1]))
    return fitting[0] if alone else ""


def _find_extra(recorded: Sequence[str], simulated: Sequence[str]) -> str:
    """Words before every recorded name that the simulation does without; the fewest with which all are in it."""
    there, names = {simplify_joint(name) for name in simulated}, [simplify_joint(name) for name in recorded]
    words = names[0].split("_") if names else []
    for count in range(1, len(words)):
        extra = "_".join(words[:count]) + "_"
        if all(name.startswith(extra) and name.removeprefix(extra) in there for name in names):
            return extra
    return ""


def _count_words(prefix: str) -> int:
    return prefix.count("_")


def _write_refusal(recorded: Sequence[str], free: Sequence[str]) -> str:
    """What does not match, and the line that says it if the order is the same on both sides."""
    names = list(dict.fromkeys(recorded))
    guess = ",".join(f"{name}={there}" for name, there in zip(names, free, strict=False))
    head = (
        f"the simulation has no joint called {', '.join(map(repr, names))}; still free are {', '.join(free) or 'none'}"
    )
    if not guess:
        return f"{head}: record the joints of this arm, or give its simulation"
    return f"{head}. Say which is which; if the order is the same: --match {guess}"
