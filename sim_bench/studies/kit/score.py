"""What a diagnosis said, held against what is true: names, sets and intervals, the same for every generator."""

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

PARAMETERS = frozenset({"inertia_error", "payload_error", "torque_offset", "direction_asymmetry"})
"""Names of parameters that the simulation has, as against physics that it lacks."""

_SCHEMA = "fricomp.diagnosis/1"


def read_diagnosis(content: bytes) -> dict[str, Any]:
    """The content of `diagnosis.json`; an empty one reads as a failed diagnosis.

    Raises:
        DiagnosisError: It is of another schema.
    """
    from fricomp.errors import DiagnosisError

    if not content:
        return {"verdict": "failed", "effects": []}
    record: dict[str, Any] = json.loads(content)
    if record.get("schema") != _SCHEMA:
        raise DiagnosisError(f"a diagnosis has schema {record.get('schema')!r}; {_SCHEMA} can be scored")
    return record


def list_sets(said: Mapping[str, Any]) -> dict[str, frozenset[str]]:
    """Each name, strongest first, with what it cannot be told from and itself."""
    return {
        each["name"]: frozenset({each["name"], *each.get("indistinguishable_from", ())}) for each in said["effects"]
    }


@dataclass(frozen=True)
class JudgedNames:
    """The names of an answer that count, beside those that are right.

    Attributes:
        sets: Each name that counts, strongest first, with what it cannot be told from and itself.
        right: Names that are right.
    """

    sets: Mapping[str, frozenset[str]]
    right: frozenset[str]

    @property
    def first_is_right(self) -> bool:
        """Whether the strongest name is a right one."""
        return next(iter(self.sets), "") in self.right

    @property
    def first_set_is_right(self) -> bool:
        """Whether the strongest name is right or cannot be told from a right one."""
        return bool(next(iter(self.sets.values()), frozenset()) & self.right)

    @property
    def false_names(self) -> tuple[str, ...]:
        """Names that are not right and cannot be mistaken for a right one."""
        return tuple(name for name, group in self.sets.items() if not group & self.right)

    @property
    def false_parameters(self) -> tuple[str, ...]:
        """Those of the false names that are parameters of the simulation."""
        return tuple(name for name in self.false_names if name in PARAMETERS)


def judge_names(sets: Mapping[str, frozenset[str]], right: Collection[str], tolerated: Collection[str]) -> JudgedNames:
    """Hold the names of an answer against the truth.

    Args:
        sets: Of the answer, as `list_sets` gives them.
        right: Names that are right.
        tolerated: Names that are true besides; they count neither for nor against the answer.
    """
    counted = {name: group for name, group in sets.items() if name in right or name not in tolerated}
    return JudgedNames(counted, frozenset(right))
