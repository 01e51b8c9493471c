"""Tables with a row for each joint or each signal in turn, and a word or a number in it that says which."""

import itertools
import re
from collections.abc import Mapping

import numpy as np

from fricomp.recording.sources.label_word import JOINT_LABELS, SIGNAL_LABELS
from fricomp.recording.validity import Samples

from .column import read_column_name

_VALUES = ("value", "_value", "values", "wert", "data")
"""Names of the only column of numbers, where each row says by a word what its number is."""
_MOST = 64
"""Joints, or signals, that are told apart; more different words are a remark in each row."""
_FEWEST_TURNS = 0.1
"""Part of the rows at which another name comes up: names of rows that follow each other are those of recordings."""
_DEVICE = re.compile(
    r"(joint|motor|axis|actuator|drive|servo|node|device|dev|can|dxl)?[_ ]?(id|index|idx|number|num|no|nr)?",
    re.IGNORECASE,
)
"""Names of columns that say by a number which device a row is of, for sure where they have both words."""
_SURE = ("joint", "axis", "actuator", "servo")
"""The first of these words that are sure alone: others, such as motor, may say whether it is on."""


def separate_long_rows(columns: dict[str, Samples], words: Mapping[str, list[str]]) -> dict[str, Samples]:
    """Columns of each joint or signal, of a table whose rows are of several in turns; else the columns as they are.

    Args:
        columns: By name; those of words hold no number. Shape (n_rows,) each.
        words: What stands in the latter.
    """
    for name, cells in words.items():
        said = name.rpartition(".")[2].lower()
        different = list(dict.fromkeys(cells))
        if not 1 < len(different) <= _MOST or cells[0][:1] in ("[", "("):  # lists are no names
            continue
        values = [one for one in columns if one.lower() in _VALUES]
        if said in SIGNAL_LABELS and len(values) == 1:
            return _separate_signals(columns, name, cells, values[0])
        turns = sum(a != b for a, b in itertools.pairwise(cells))
        if said in JOINT_LABELS or (said == "name" and turns > _FEWEST_TURNS * len(cells)):
            return _separate_joints(columns, name, cells)
    return _separate_devices(columns)


def _separate_devices(columns: dict[str, Samples]) -> dict[str, Samples]:
    """Columns of each device, of a table with a whole number that says which one a row is of."""
    for name, values in columns.items():
        said = _DEVICE.fullmatch(name.rpartition(".")[2])
        if said is None or not said.group() or not _are_few_numbers(values):
            continue
        turns = np.count_nonzero(np.diff(values))
        if all(said.groups()) or said.group().lower() in _SURE or turns > _FEWEST_TURNS * values.size:
            return _separate_joints(columns, name, [f"{value:.0f}" for value in values])
    return columns


def _are_few_numbers(values: Samples) -> bool:
    """Whether a column holds several whole numbers, and no more than there are devices."""
    numbers = np.unique(values)
    return 1 < numbers.size <= _MOST and numbers[0] >= 0.0 and bool(np.all(numbers == np.round(numbers)))


def _separate_signals(columns: dict[str, Samples], name: str, cells: list[str], value: str) -> dict[str, Samples]:
    rows = np.array(cells)
    kept = {one: column for one, column in columns.items() if one not in (value, name)}
    return kept | {one: np.where(rows == one, columns[value], np.nan) for one in dict.fromkeys(cells) if one}


def _separate_joints(columns: dict[str, Samples], name: str, cells: list[str]) -> dict[str, Samples]:
    rows = np.array(cells)
    alike = {one: values for one, values in columns.items() if values.size == rows.size}
    separate = {one: values for one, values in alike.items() if read_column_name(one) is not None}
    kept = {one: values for one, values in columns.items() if one not in separate and one != name}
    return kept | {
        f"{joint}/{one}": np.where(rows == joint, values, np.nan)
        for joint in dict.fromkeys(cells)
        for one, values in separate.items()
    }
