"""The text of slcan: `t`, 3 hex digits of identifier, length, data; `T` with 8, `r` and `R` remote [lawicel2013]."""

import re

from ..link import CanFrame

__all__ = ["decode_line", "encode_frame"]

CARRIAGE_RETURN = b"\r"
_HEX_DIGITS = re.compile(rb"[0-9A-Fa-f]+")  # `int` and `fromhex` take signs, underscores and blanks, too


def encode_frame(frame: CanFrame) -> bytes:
    """One line, carriage return included."""
    kind = ("R" if frame.extended else "r") if frame.remote else ("T" if frame.extended else "t")
    digits = 8 if frame.extended else 3
    data = "" if frame.remote else frame.data.hex().upper()
    return f"{kind}{frame.identifier:0{digits}X}{len(frame.data)}{data}\r".encode("ascii")


def decode_line(line: bytes) -> CanFrame | None:
    """The frame in a line without its carriage return; None if it is none, damaged or cut short.

    The length must match the digits exactly, four digits of time stamp aside.
    """
    kind = line[:1]
    if kind not in (b"t", b"T", b"r", b"R") or not _HEX_DIGITS.fullmatch(line, 1):
        return None
    extended, remote = kind in (b"T", b"R"), kind in (b"r", b"R")
    start = 10 if extended else 5
    length = line[start - 1 : start]
    if not (length.isdigit() and length <= b"8"):
        return None
    end = start + (0 if remote else 2 * int(length))
    if len(line) not in (end, end + 4):
        return None
    identifier, data = int(line[1 : start - 1], 16), bytes.fromhex(line[start:end].decode("ascii"))
    if identifier > (0x1FFFFFFF if extended else 0x7FF):
        return None
    return CanFrame(identifier, data, extended, remote)
