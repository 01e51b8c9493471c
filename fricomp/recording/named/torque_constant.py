"""A torque constant that stands beside the current which it makes a torque of."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.recording.validity import Samples

from .head_fact import HeadFact, read_head_facts

_CALLED = re.compile(r"(?:^|[._/ ])(?:k_?t|k_?tau|torque_?constant)(?![A-Za-z])", re.IGNORECASE)
"""Names of a torque constant, whatever path is before and unit behind them: `Kt`, `motor.kt_NmA`, `torqueConstant`."""


def say_torque_constant(path: Path, columns: Mapping[str, Samples], current: str) -> list[str]:
    """What to write for a friction in N·m, where a log of a current holds the constant that leads there.

    It is said and not done: whether it is that of the motor or of the joint behind its gear, no log tells.

    Args:
        path: Of the file, for messages.
        columns: All columns by name.
        current: Name of the one that stands for the torque.
    """
    found = [(name, float(values.flat[0])) for name, values in columns.items() if _is_constant(name, values)]
    facts = read_head_facts(path)
    if not found and "KT" in facts:
        found = [(facts["KT"].said, facts["KT"].value)]
    if len(found) != 1:
        return []
    name, value = found[0]
    return [
        f"{path.name}: {name!r} = {value:.6g} is called as a torque constant, and what is found is in A: for N·m write "
        f'torque = {{ column = "{current}", scale = {value:.6g} }} and torque_unit = "N·m" in a mapping, the scale '
        f"times the gear ratio{_say_ratio(facts)} where the position is behind a gear."
    ]


def _say_ratio(facts: Mapping[str, HeadFact]) -> str:
    return f", {facts['RATIO'].value:.6g} by {facts['RATIO'].said!r}," if "RATIO" in facts else ""


def _is_constant(name: str, values: Samples) -> bool:
    """Whether a column is called as a torque constant and has one value, and that above zero."""
    if not _CALLED.search(name) or not values.size:
        return False
    return bool(np.ptp(values) == 0.0 and values.flat[0] > 0.0)
