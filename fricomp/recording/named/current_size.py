"""A current whose name states no unit and that is too large for a joint's in amperes."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.recording.recording import Recording
from fricomp.recording.unit_word import find_unit_words

from .column import ColumnMeaning

_LARGE = 60.0
"""Current that few drives of a joint give [A]; those of legged robots and large arms reach some 50."""


def say_current_size(path: Path, recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]]) -> list[str]:
    """What to write where a current without a unit is as large as one in milliamperes.

    Args:
        path: Of the file, for messages.
        recording: Its torque is what was taken for one.
        own: Column and meaning of the joint by channel.
    """
    column, meaning = own["torque"]
    most = float(np.quantile(np.abs(recording.torque), 0.99))
    if recording.metadata.torque_unit != "A" or meaning.unit or find_unit_words(column, -1) or most < _LARGE:
        return []
    line = f'torque = {{ column = "{column}", unit = "mA" }}'
    return [
        f"{path.name}: {column!r} reaches {most:.3g} and names no unit: it was taken as A, and few joints draw that. "
        f"If it is in mA, friction and inertia come out 1000 times too large: write {line} in a mapping, or call it "
        f"{column}_mA. In units of a drive, write scale in place of unit."
    ]
