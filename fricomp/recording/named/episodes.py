"""Episodes of one robot in one file, each in a group of its own: put one after the other."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.recording.validity import Samples

from .times.clock import find_stamps

_EPISODE = re.compile(r"(?<![^./])(demo|episode|ep|trial|traj|trajectory|rollout)_?(\d+)(?=[./])", re.IGNORECASE)
"""Group of an episode in the path of a name: `data.demo_3.obs.joint_pos`."""
_PAUSE = 1.0
"""Time between two episodes that hold no times [s]: a gap, in which the robot is put back."""


def join_episodes(columns: Mapping[str, Samples], row_rate: float | None) -> dict[str, Samples]:
    """The columns of all episodes as one each, in their order; as they are where fewer than two have the same columns.

    What an episode lacks is NaN in its rows; single numbers that it states are left out.

    Args:
        columns: All by name.
        row_rate: Rows a second where the episodes hold no times, or other ones [Hz].
    """
    found: dict[int, dict[str, Samples]] = {}
    for name, values in columns.items():
        match = _EPISODE.search(name)
        if match is not None and values.size > 1:
            found.setdefault(int(match.group(2)), {})[f"{name[: match.start()]}{name[match.end() + 1 :]}"] = values
    first = next(iter(found.values()), {})
    if len(found) < 2 or any(set(one) != set(first) for one in found.values()):
        return dict(columns)
    episodes = [found[number] for number in sorted(found)]
    lengths = [max(values.size for values in one.values()) for one in episodes]
    joined = {
        name: np.concatenate([_fill(one[name], length) for one, length in zip(episodes, lengths, strict=True)])
        for name in first
    }
    if row_rate is None:
        return joined
    kept = {name: values for name, values in joined.items() if name not in find_stamps(joined)}
    return {"time": _count_time(lengths, row_rate), **kept}


def _fill(values: Samples, length: int) -> Samples:
    return np.concatenate([values, np.full(length - values.size, np.nan)]) if values.size < length else values


def _count_time(lengths: Sequence[int], rate: float) -> Samples:
    """Times of the rows of episodes of these lengths [s]. Shape (n_rows,)."""
    starts = np.cumsum([0.0, *(length / rate + _PAUSE for length in lengths[:-1])])
    return np.concatenate([start + np.arange(length) / rate for start, length in zip(starts, lengths, strict=True)])
