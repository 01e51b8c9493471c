"""Which joint of a log is meant by a name that need not be written as the log has it."""

import re
from collections.abc import Sequence

from fricomp.recording.quantity_word import split_words

from ..column import simplify_joint

_ANY = frozenset(
    [
        *("joint", "joints", "jnt", "axis", "axes", "dof", "motor", "motors", "drive", "actuator", "servo", "rotor"),
        *("shaft", "output", "main", "encoder", "sensor", "channel", "ch", "ax", "act", "m", "j", "d", "test", "data"),
        *("state", "states", "log", "field", "msg", "robot", "rig", "device", "dev", "unit", "feedback", "fb"),
    ]
)
"""Words of what any joint may be called."""
_ADDRESS = re.compile(r"0[xX][0-9A-Fa-f]{1,8}")
"""Number of a device as buses write it."""


def select_joint(names: Sequence[str], wanted: str, simulated: Sequence[str] = ()) -> str | None:
    """The name of the joint that is meant; None where none is, or several could be.

    That of the same name; of one that differs by the word joint, by case or marks; the only one whose name has the
    wanted one's words in it, or the other way round: `left_arm_elbow` and `elbow_joint` are `elbow`; the only joint
    there is, where its name says no more than that it is one.

    Args:
        names: Of the joints of a log.
        wanted: As the user, or a simulation, calls it.
        simulated: Of all joints of the simulation: where these count from one, a log that counts from zero does too.
    """
    wanted = str(int(wanted, 16)) if _ADDRESS.fullmatch(wanted) else wanted
    called = count_from_one(names, simulated)
    called = {called.get(name, name): name for name in names}
    if wanted in called:
        return called[wanted]
    alike = [one for one in called if simplify_joint(one) == simplify_joint(wanted)]
    alike = alike or [one for one in called if _has_in_it(one, wanted) or _ends_with(wanted, one)]
    if not alike and len(names) == 1 and all(word in _ANY or word.isdigit() for word in _list_words(names[0])):
        return names[0]
    return called[alike[0]] if len(alike) == 1 else None


def count_from_one(recorded: Sequence[str], simulated: Sequence[str]) -> dict[str, str]:
    """Names counted from one of recorded joints that are counted from zero; none where the simulation does so too.

    By their numbers all but one would be found, each as the joint before it.
    """
    parts = [re.fullmatch(r"(.*?)(\d+)", simplify_joint(name)) for name in recorded]
    counted = sorted((one[1], int(one[2])) for one in parts if one)
    if not counted or counted != [(counted[0][0], k) for k in range(len(parts))]:
        return {}
    called = {name: f"{one[1]}{int(one[2]) + 1}" for name, one in zip(recorded, parts, strict=True) if one}
    there = [simplify_joint(name) for name in simulated]

    def is_there(name: str) -> bool:
        return any(one == name or one.endswith(f"_{name}") for one in there)

    return called if all(map(is_there, called.values())) and not is_there(f"{counted[0][0]}0") else {}


def _list_words(name: str) -> list[str]:
    return [word for word, _ in split_words(simplify_joint(name))]


def _has_in_it(longer: str, shorter: str) -> bool:
    """Whether the words of one name stand side by side in another one, and are no number alone."""
    words, few = _list_words(longer), _list_words(shorter)
    if all(word.isdigit() for word in few):
        return False
    return any(words[k : k + len(few)] == few for k in range(len(words) - len(few) + 1))


def _ends_with(longer: str, shorter: str) -> bool:
    """The same where nothing but words of any joint stand behind them: `hip` is no `hip_roll`."""
    while (words := _list_words(longer)) and words[-1] in _ANY:
        longer = "_".join(words[:-1])
    few = _list_words(shorter)
    return words[-len(few) :] == few and _has_in_it(longer, shorter)
