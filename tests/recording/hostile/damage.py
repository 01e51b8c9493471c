"""Copies of a file's bytes that are damaged, or that mean something else."""

from __future__ import annotations

import re

import numpy as np

_VALUE = re.compile(rb'"[^"\n]*"(?!\s*:)|(?<![\w"])-?\d+\.?\d*(?:[eE][-+]?\d+)?|\btrue\b|\bfalse\b|\bnull\b')
_VALUES = (
    *(b"0", b"-1", b"-0.0", b"1e308", b"-1e308", b"1e-320", b"nan", b"inf", b"99999999999999999999", b"true", b"null"),
    *(b'""', b'"x"', b'"nan"', b'"../../x"', b'"\\u0000"', b"[]", b"{}", b"[1, 2]", b"[[1]]", b'{"a": 1}', b"{a = 1}"),
)
_SIZES = tuple(
    size.to_bytes(width, order)  # type: ignore[arg-type]
    for width, order in ((8, "little"), (4, "little"), (4, "big"), (2, "little"))
    for size in (0, 1, 2 ** (8 * width - 1) - 1, 2 ** (8 * width) - 1, 2 ** (4 * width))
)
_EXTREMES = (
    *(b"nan", b"1e999", b"-", b"9" * 5000, b"[" * 2000, b'{"a":' * 2000, b"\xff\xfe", b"\x00", b",,,", b"\r\n\r\n"),
    b'"',
)
_SECTOR = 512  # bytes that disks write or lose together


def damage(data: bytes, rng: np.random.Generator) -> bytes:
    """A copy with a few places changed, cut, repeated, moved, inserted, or replaced by extreme sizes and numbers."""
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 6))):
        at, length = int(rng.integers(0, max(len(changed), 1))), int(rng.integers(1, 17))
        match int(rng.integers(0, 9)):
            case 0:
                changed[at : at + length] = rng.bytes(length)
            case 1:
                del changed[at : at + length * int(rng.integers(1, 40))]
            case 2:
                changed[at:at] = changed[at : at + length] * int(rng.integers(1, 60))
            case 3:
                size = _SIZES[int(rng.integers(0, len(_SIZES)))]
                changed[at : at + len(size)] = size
            case 4:
                changed[at : at + 1] = bytes([changed[at] ^ (1 << int(rng.integers(0, 8)))]) if changed else b"x"
            case 5:
                to = int(rng.integers(0, max(len(changed), 1)))
                changed[to : to + 16 * length] = changed[at : at + 16 * length]
            case 6:
                sector = at - at % _SECTOR
                changed[sector:sector] = changed[sector : sector + _SECTOR]
            case 7 if length == 1:
                del changed[at:]
            case _:
                changed[at:at] = _EXTREMES[int(rng.integers(0, len(_EXTREMES)))]
    return bytes(changed)


def flip(data: bytes, rng: np.random.Generator) -> bytes:
    """A copy with a few bytes changed in their places, so that lengths stay true."""
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 4)) if data else 0):
        changed[int(rng.integers(0, len(changed)))] = int(rng.integers(0, 256))
    return bytes(changed)


def exchange(data: bytes, rng: np.random.Generator) -> bytes:
    """A copy of a text that is well formed but for its meaning: one or two of its values are others."""
    for _ in range(int(rng.integers(1, 3))):
        values = list(_VALUE.finditer(data))
        if not values:
            return data
        found = values[int(rng.integers(0, len(values)))]
        data = data[: found.start()] + _VALUES[int(rng.integers(0, len(_VALUES)))] + data[found.end() :]
    return data
