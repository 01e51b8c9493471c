"""Whether an answer that was made again tells the same as the one that was sealed.

Processors round differently in the last digit, and a joint that sticks and slides lets such a digit grow: an answer
made on another kind of processor has another hash, with values that differ by up to 2 % on 33 cases tried.
"""

from __future__ import annotations

import json
import math
from typing import Any

__all__ = ["SAME_WITHIN", "same_answer"]

SAME_WITHIN = 0.05
"""Greatest difference of a value, relative to the larger one, between processors."""
_ROUNDING = 1e-12
"""Values below this are none, such as the ENR of a joint from which nothing is missing."""
_FOLLOWS = frozenset({"location", "truth_sha256"})
"""What follows from the torque sample by sample: the spans in which it is strong, and its hash."""


def same_answer(first: bytes, again: bytes) -> bool:
    """Whether two answers hold the same names, and values within `SAME_WITHIN`; where in time is left out."""
    return _same(json.loads(first), json.loads(again))


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, dict) and isinstance(other, dict):
        keys = (one.keys() | other.keys()) - _FOLLOWS
        return all(key in one and key in other and _same(one[key], other[key]) for key in keys)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=SAME_WITHIN, abs_tol=_ROUNDING)
    return bool(one == other)
