"""A CAN frame as the adapters see it."""

from typing import NamedTuple


class CanFrame(NamedTuple):
    """A classical CAN data frame, or a remote request.

    Attributes:
        identifier: 11 bits, or 29 if `extended`.
        data: At most 8 bytes.
        extended: Whether the identifier has 29 bits.
        remote: Whether it asks for the frame of this identifier.
    """

    identifier: int
    data: bytes = b""
    extended: bool = False
    remote: bool = False
