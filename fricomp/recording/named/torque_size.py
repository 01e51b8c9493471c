"""How large a torque is: whether its unit may be another one, and a torque constant beside a current."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import find_unit_words
from fricomp.recording.validity import Samples

from .column import ColumnMeaning
from .head_fact import HeadFact, read_head_facts
from .unstated import STATED_BY_MANUALS, SURE

_CALLED = re.compile(r"(?:^|[._/ ])(?:k_?t|k_?tau|torque_?constant)(?![A-Za-z])", re.IGNORECASE)
"""Names of a torque constant, whatever path is before and unit behind them: `Kt`, `motor.kt_NmA`, `torqueConstant`."""
_LARGE = {"A": (60.0, "mA", "few joints draw that"), "N·m": (250.0, "mN·m", "only the joints of large arms give that")}
"""Size that few joints reach, what else it may be in, and what is said of it: drives of legged robots and large arms
give some 50 A, their joints 220 N·m and those of a wrist of 20 kg 250 N·m."""


def say_torque_size(path: Path, recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]]) -> list[str]:
    """What to write where a torque or a current without a unit is as large as one in thousandths.

    Args:
        path: Of the file, for messages.
        recording: Its torque is what was taken for one.
        own: Column and meaning of the joint by channel.
    """
    column, meaning = own["torque"]
    unit = recording.metadata.torque_unit
    large, other, why = _LARGE.get(unit, (np.inf, "", ""))
    most = float(np.quantile(np.abs(recording.torque), 0.99))
    if most < large or meaning.unit or meaning.certainty >= SURE or find_unit_words(column, -1):
        return []
    if STATED_BY_MANUALS.search(column):
        return []
    line = f'torque = {{ column = "{column}", unit = "{other}" }}'
    return [
        f"{path.name}: {column!r} reaches {most:.3g} and names no unit: it was taken as {unit}, and {why}. "
        f"If it is in {other}, friction and inertia come out 1000 times too large: write {line} in a mapping, or call "
        f"it {column}_{other.replace('·', '')}. In units of a drive, write scale in place of unit."
    ]


def say_torque_constant(path: Path, columns: Mapping[str, Samples], current: tuple[str, ColumnMeaning]) -> list[str]:
    """What to write for a friction in N·m, where a log of a current holds the constant that leads there.

    It is said and not done: whether it is that of the motor or of the joint behind its gear, no log tells.

    Args:
        path: Of the file, for messages.
        columns: All columns by name.
        current: Name and meaning of the one that stands for the torque.
    """
    found = [(name, float(values.flat[0])) for name, values in columns.items() if _is_constant(name, values)]
    facts = read_head_facts(path)
    if not found and "KT" in facts:
        found = [(facts["KT"].said, facts["KT"].value)]
    if len(found) != 1:
        return []
    (name, value), (column, meaning) = found[0], current
    unit = find_unit(meaning.unit) if meaning.unit else None
    worth = value * meaning.scale * (unit.factor if unit is not None else 1.0)
    return [
        f"{path.name}: {name!r} = {value:.6g} is called as a torque constant, and what is found is in A: for N·m write "
        f'torque = {{ column = "{column}", scale = {worth:.6g} }} and torque_unit = "N·m" in a mapping, the scale '
        f"times the gear ratio{_say_ratio(facts)} where the position is behind a gear."
    ]


def _say_ratio(facts: Mapping[str, HeadFact]) -> str:
    return f", {facts['RATIO'].value:.6g} by {facts['RATIO'].said!r}," if "RATIO" in facts else ""


def _is_constant(name: str, values: Samples) -> bool:
    """Whether a column is called as a torque constant and has one value, and that above zero."""
    if not _CALLED.search(name) or not values.size:
        return False
    return bool(np.ptp(values) == 0.0 and values.flat[0] > 0.0)
