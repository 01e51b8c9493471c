"""A link between adapter and drives that loses, repeats, delays and damages what it carries, or dies."""

import random
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from fricomp.errors import AdapterConnectionError

__all__ = ["FAULTS", "FaultyLink", "Link", "Traffic"]

Traffic = Any
"""What a link carries: a list of CAN frames (named tuples with a field `data`), or bytes."""

Fault = Callable[[Traffic], Traffic]


class Link(Protocol):
    """The links of `fricomp.adapters.link`, as far as this wrapper needs them."""

    def send(self, traffic: Traffic) -> None:
        """Hand over frames or bytes."""

    def receive(self) -> Traffic:
        """What has come."""

    def discard_output(self) -> None:
        """Drop what waits."""

    def close(self) -> None:
        """Let go."""


class FaultyLink:
    """Wraps a link. Healthy until told otherwise.

    Args:
        link: The link to the drives.

    Attributes:
        incoming: Applied to what comes from the drives; None for nothing.
        dead: Whether sending and receiving fail.
        full: Whether sending fails.
        silent: Whether sending is lost and nothing comes, without any error: a pulled cable.
        sent: Everything handed over while `recording`.
    """

    def __init__(self, link: Link) -> None:
        self._link = link
        self.incoming: Fault | None = None
        self.dead = self.full = self.silent = self.recording = False
        self.sent: list[Traffic] = []

    def send(self, traffic: Traffic) -> None:
        """Hand over frames or bytes, unless broken."""
        if self.dead or self.full:
            raise AdapterConnectionError("the link is broken" if self.dead else "the queue is full")
        if self.recording:
            self.sent.append(traffic)
        if not self.silent:
            self._link.send(traffic)

    def receive(self) -> Traffic:
        """What has come, as the faults leave it."""
        if self.dead:
            raise AdapterConnectionError("the link is broken")
        traffic = self._link.receive()
        if self.silent:
            return traffic[:0]
        return self.incoming(traffic) if self.incoming is not None else traffic

    def discard_output(self) -> None:
        """Drop what waits."""
        self._link.discard_output()

    def close(self) -> None:
        """Let go."""
        self._link.close()


def drop_some(rng: random.Random) -> Fault:
    """Lose a third of what comes."""

    def fault(traffic: Traffic) -> Traffic:
        if isinstance(traffic, bytes):
            return b"" if rng.random() < 0.3 else traffic
        return [frame for frame in traffic if rng.random() >= 0.3]

    return fault


def duplicate(rng: random.Random) -> Fault:
    """Repeat everything."""
    return lambda traffic: traffic + traffic


def delay(rng: random.Random) -> Fault:
    """Hold everything back for one to three calls."""
    held: list[Traffic] = []

    def fault(traffic: Traffic) -> Traffic:
        held.append(traffic)
        return held.pop(0) if len(held) > rng.randint(1, 3) else traffic[:0]

    return fault


def damage(rng: random.Random) -> Fault:
    """Flip a bit in half of what comes."""

    def flip(data: bytes) -> bytes:
        if not data or rng.random() < 0.5:
            return data
        damaged = bytearray(data)
        damaged[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        return bytes(damaged)

    return lambda traffic: flip(traffic) if isinstance(traffic, bytes) else _each_data(traffic, flip)


def cut_short(rng: random.Random) -> Fault:
    """Cut off the end of half of what comes."""

    def cut(data: bytes) -> bytes:
        return data[: rng.randrange(len(data))] if data and rng.random() < 0.5 else data

    return lambda traffic: cut(traffic) if isinstance(traffic, bytes) else _each_data(traffic, cut)


def _each_data(frames: Sequence[Any], change: Callable[[bytes], bytes]) -> list[Any]:
    return [frame._replace(data=change(frame.data)) for frame in frames]


FAULTS: dict[str, Callable[[random.Random], Fault]] = {
    "dropped": drop_some,
    "duplicated": duplicate,
    "delayed": delay,
    "damaged": damage,
    "cut short": cut_short,
}
"""Faults of a link by name, each made with a source of randomness."""
