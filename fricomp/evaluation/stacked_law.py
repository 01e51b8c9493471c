"""Friction of several joints worked out at once: joints whose laws have the same form share one law of arrays.

The formula of a term is numpy's and takes its numbers as they are, so that numbers in columns, a joint each, give the
torques of all these joints in one call. Calls, not arithmetic, are what a simulation step by step costs.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from fricomp.laws import FrictionLaw


@dataclass(frozen=True)
class LawGroup:
    """Joints with laws of one form.

    Attributes:
        joints: Their numbers.
        law: One law for all of them; a number in which they differ is an array of shape (len(joints),).
    """

    joints: tuple[int, ...]
    law: FrictionLaw


def group_laws(laws: Sequence[FrictionLaw | None]) -> tuple[LawGroup, ...]:
    """Joints with friction, by the form of their laws.

    Args:
        laws: Of each joint; None for a joint without friction.
    """
    groups: dict[Any, list[int]] = {}
    for joint, law in enumerate(laws):
        if law is not None:
            groups.setdefault(_describe_form(law), []).append(joint)
    return tuple(LawGroup(tuple(joints), _stack([laws[j] for j in joints])) for joints in groups.values())


def _describe_form(value: Any) -> Any:
    """All of a law but its numbers."""
    if isinstance(value, tuple):
        return tuple(map(_describe_form, value))
    if is_dataclass(value):
        return type(value), tuple(_describe_form(getattr(value, field.name)) for field in fields(value))
    return float if isinstance(value, float) else value


def _stack(values: Sequence[Any]) -> Any:
    """Laws, terms, curves or numbers as one of their kind. A term checks single numbers, which these have passed."""
    first = values[0]
    if isinstance(first, tuple):
        return tuple(_stack(each) for each in zip(*values, strict=True))
    if is_dataclass(first):
        made = object.__new__(type(first))
        for field in fields(first):
            object.__setattr__(made, field.name, _stack([getattr(one, field.name) for one in values]))
        return made
    return np.array(values) if isinstance(first, float) and len(set(values)) > 1 else first
