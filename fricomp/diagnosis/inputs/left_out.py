"""Linear fits with one block of the samples left out at a time."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from .signal import FloatArray


def fit_without_blocks(
    table: FloatArray, target: FloatArray, blocks: int, *, rcond: float, gap: tuple[int, int] = (0, 0)
) -> Iterator[tuple[np.ndarray, FloatArray]]:
    """Yield the samples of each block, and the weights of the columns that are fitted to all others.

    The samples are reduced to a triangle between every two places where a block begins or ends: its rows have the
    same products as they, and a fit takes the triangles of what it keeps instead of most samples once more.

    Args:
        table: Columns. Shape (n, p).
        target: What they fit. Shape (n,).
        blocks: Into how many blocks of about one length the samples are cut.
        rcond: Least singular value that counts, over the largest.
        gap: Samples before and behind a block that take no part in its fit either.
    """
    n = target.size
    parts = [part for part in np.array_split(np.arange(n), blocks) if part.size]
    spans = [(max(int(part[0]) - gap[0], 0), min(int(part[-1]) + 1 + gap[1], n)) for part in parts]
    cuts = sorted({0, n, *(end for span in spans for end in span)})
    both = np.column_stack([table, target])
    pieces = [(a, np.linalg.qr(both[a:b], mode="r")) for a, b in pairwise(cuts)]
    for part, (start, stop) in zip(parts, spans, strict=True):
        kept = np.concatenate([both[:0], *(triangle for a, triangle in pieces if not start <= a < stop)])
        yield part, np.linalg.lstsq(kept[:, :-1], kept[:, -1], rcond=rcond)[0]
