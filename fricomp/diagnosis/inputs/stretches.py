"""The stretches of a long recording that are searched: whole ones, from all of its time, where the joint shows most.

A search simulates every sample thousands of times, and beyond some minutes more samples hardly tell more. So that
nothing is lost that shows late or seldom, the choice looks at all samples once: each span of time gives the stretch
that adds most to the states that were seen, and stretches in which the torque stands out take part as well. What is
found is held against the whole recording at the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from .past import Past, build_past
from .settings import INPUT
from .signal import FloatArray, differentiate
from .track import choose_step

_OTHERS = frozenset({"load_torque", "temperature"})


class Stretch(NamedTuple):
    """What is searched of a recording, between two gaps or less.

    Attributes:
        recording: The samples.
        past: How the joint was driven over all of the recording; None where this is all of it.
    """

    recording: Recording
    past: Past | None


class _Block(NamedTuple):
    part: int
    first: int
    last: int


class _Motion(NamedTuple):
    """Means over cells. Shapes (n,)."""

    position: FloatArray
    velocity: FloatArray
    direction: FloatArray
    torque: FloatArray
    acceleration: FloatArray


class _Cells(NamedTuple):
    """Of a block: its states, what the torque of a joint consists of there, the torque, and where the joint moves one
    way throughout a cell. Shapes (n, p), (n, q), (n,), (n,)."""

    states: FloatArray
    columns: FloatArray
    torque: FloatArray
    moves: NDArray[np.bool_]


def choose_stretches(sources: Sequence[Sequence[Recording]]) -> list[list[Stretch]]:
    """Choose what is searched of each recording: all of it, where they are not long.

    Args:
        sources: The usable parts of each recording, in order of time; all of one rate.
    """
    every = [part for parts in sources for part in parts]
    total = sum(part.duration for part in every)
    most = INPUT.most_samples * _choose_period(every)
    if total <= INPUT.searched_whole * most:
        return [_keep_whole(parts) for parts in sources]
    return [_cut(parts, most * sum(part.duration for part in parts) / total) for parts in sources]


def _choose_period(recordings: Sequence[Recording]) -> float:
    """Time that a sample of a search stands for [s]: a step of the simulation, or a row where nothing is simulated."""
    periods = [one.sample_period for one in recordings]
    return max(periods) if max(periods) > INPUT.longest_simulated else choose_step(recordings)


def _keep_whole(parts: Sequence[Recording]) -> list[Stretch]:
    pasts = build_past(parts, parts) if len(parts) > 1 else [None] * len(parts)
    return [Stretch(part, past) for part, past in zip(parts, pasts, strict=True)]


def _cut(parts: Sequence[Recording], most: float) -> list[Stretch]:
    """Stretches of one recording that last `most` [s] together."""
    length = max(most / INPUT.stretches, INPUT.shortest_stretch)
    blocks = [
        _Block(number, int(first), int(last))
        for number, part in enumerate(parts)
        for first, last in pairwise(np.linspace(0, len(part), max(1, int(part.duration / length)) + 1).astype(int))
    ]
    count = max(1, round(most / length))
    if count >= len(blocks):
        return _keep_whole(parts)
    chosen = _join([blocks[i] for i in _choose(parts, blocks, count)])
    stretches = [parts[one.part].rows(slice(one.first, one.last)) for one in chosen]
    return [Stretch(one, past) for one, past in zip(stretches, build_past(parts, stretches), strict=True)]


def _join(blocks: Sequence[_Block]) -> list[_Block]:
    """Neighbours as one."""
    joined = [blocks[0]]
    for block in blocks[1:]:
        before = joined[-1]
        if (block.part, block.first) == (before.part, before.last):
            joined[-1] = before._replace(last=block.last)
        else:
            joined.append(block)
    return joined


def _choose(parts: Sequence[Recording], blocks: Sequence[_Block], count: int) -> list[int]:
    """Numbers of the blocks, in order."""
    cells = _average_blocks(parts, blocks)
    loudest = _measure_loudness(cells)
    loud = np.argsort(-loudest)[: int(INPUT.standing_out_share * count)]
    chosen = [int(i) for i in loud if loudest[i] > INPUT.stands_out * np.median(loudest)]
    grams = [one.states.T @ one.states for one in cells]
    seen = np.eye(grams[0].shape[0]) + sum((grams[i] for i in chosen), np.zeros_like(grams[0]))
    others = np.array([i for i in range(len(blocks)) if i not in chosen])
    for span in np.array_split(others, count - len(chosen)):
        best = max(span, key=lambda i: float(np.linalg.slogdet(seen + grams[i])[1]))
        seen = seen + grams[best]
        chosen.append(int(best))
    return sorted(chosen)


def _average_blocks(parts: Sequence[Recording], blocks: Sequence[_Block]) -> list[_Cells]:
    """Each block in cells, whose states count alike in all blocks."""
    size, shared = _count_cell(parts[0]), set.intersection(*(set(part.channels) for part in parts))
    motion = _Motion(*map(np.concatenate, zip(*map(_average_motion, parts), strict=True)))
    others = [np.concatenate([_average(part.channels[name], size) for part in parts]) for name in _OTHERS & shared]
    columns = _build_columns(motion, parts[0].metadata.motion == "rotary")
    states = np.concatenate([columns, _sort_into(motion), *(one[:, None] for one in others)], axis=1)
    states = states / np.maximum(np.sqrt(np.mean(states**2, axis=0)), 1e-12)
    begins = np.cumsum([0, *(len(part) // size for part in parts)])
    rows = [slice(begins[one.part] + one.first // size, begins[one.part] + one.last // size) for one in blocks]
    moves = np.abs(motion.direction) == 1.0
    return [_Cells(states[one], columns[one], motion.torque[one], moves[one]) for one in rows]


def _count_cell(recording: Recording) -> int:
    return max(1, round(INPUT.cell / recording.sample_period))


def _average_motion(part: Recording) -> _Motion:
    """The motion of a part over cells, without the last samples that fill none."""
    position, size = np.asarray(part.position), _count_cell(part)
    velocity = differentiate(position, part.sample_period)
    top = float(np.quantile(np.abs(velocity), 0.98))
    direction = np.sign(velocity) * (np.abs(velocity) > INPUT.moving_share * top)
    position, velocity, direction, torque = (
        _average(one, size) for one in (position, velocity, direction, np.asarray(part.torque))
    )
    acceleration = np.gradient(velocity, size * part.sample_period) if velocity.size > 1 else np.zeros(velocity.size)
    return _Motion(position, velocity, direction, torque, acceleration)


def _average(values: FloatArray, size: int) -> FloatArray:
    """Means over cells of so many samples, without the last ones that fill none. Shape (n // size,)."""
    result: FloatArray = values[: values.size // size * size].reshape(-1, size).mean(axis=1)
    return result


def _build_columns(motion: _Motion, rotary: bool) -> FloatArray:
    """What the torque of a joint consists of mostly. Shape (n, p)."""
    q, v = motion.position, motion.velocity
    place = [np.cos(q), np.sin(q)] if rotary else [q - q.mean()]
    top = max(float(np.quantile(np.abs(v), 0.98)), 1e-12)
    falls = [motion.direction * np.exp(-((v / (share * top)) ** 2)) for share in INPUT.falling_shares]
    return np.stack([np.ones_like(q), motion.acceleration, *place, motion.direction, v, *falls], axis=1)


def _sort_into(motion: _Motion) -> FloatArray:
    """Where each cell is: a column a part of the range of position, and of speed in each direction. Shape (n, q)."""
    q, v = motion.position, motion.velocity
    places = np.linspace(q.min(), q.max(), INPUT.places + 1)[1:-1]
    speeds = max(float(np.max(np.abs(v))), 1e-12) * np.array(INPUT.speeds)
    speeds = np.concatenate([-speeds[::-1], speeds])
    columns = [np.eye(edges.size + 1)[np.digitize(one, edges)] for one, edges in ((q, places), (v, speeds))]
    return np.concatenate(columns, axis=1)


def _measure_loudness(cells: Sequence[_Cells]) -> FloatArray:
    """Of each block the loudest second of the torque that a plain joint, fitted to all of them, leaves [N·m].

    Shape (n_blocks,).
    """
    columns, torque = (np.concatenate([one[k][one.moves] for one in cells]) for k in (1, 2))
    if torque.size <= columns.shape[1]:
        return np.zeros(len(cells))
    size = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-12)
    fit = np.linalg.lstsq(columns / size, torque, rcond=None)[0] / size
    return np.array([_find_loudest(np.where(one.moves, one.torque - one.columns @ fit, 0.0)) for one in cells])


def _find_loudest(left: FloatArray) -> float:
    width = max(1, round(1.0 / INPUT.cell))
    return max((compute_rms(left[i : i + width]) for i in range(0, left.size, width)), default=0.0)
