"""A torque or a current whose name states no unit and that is too large for a joint's in N·m or amperes."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.recording.recording import Recording
from fricomp.recording.unit_word import find_unit_words

from .column import ColumnMeaning
from .unstated import STATED_BY_MANUALS, SURE

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
