"""Tables with a row for each joint or each signal in turn, and a word in it that says which."""

from __future__ import annotations

import itertools
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
"""Part of the rows at which another joint comes up: rows that follow joint by joint are several recordings."""


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
        if said in (*JOINT_LABELS, "name") and turns > _FEWEST_TURNS * len(cells):
            return _separate_joints(columns, name, cells)
    return columns


def _separate_signals(columns: dict[str, Samples], name: str, cells: list[str], value: str) -> dict[str, Samples]:
    rows = np.array(cells)
    kept = {one: column for one, column in columns.items() if one not in (value, name)}
    return kept | {one: np.where(rows == one, columns[value], np.nan) for one in dict.fromkeys(cells) if one}


def _separate_joints(columns: dict[str, Samples], name: str, cells: list[str]) -> dict[str, Samples]:
    rows = np.array(cells)
    separate = {one: values for one, values in columns.items() if read_column_name(one) is not None}
    kept = {one: values for one, values in columns.items() if one not in separate and one != name}
    return kept | {
        f"{joint}/{one}": np.where(rows == joint, values, np.nan)
        for joint in dict.fromkeys(cells)
        for one, values in separate.items()
    }
