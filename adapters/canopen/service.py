"""SDO through the canopen package, without its threads: waiting for an answer pumps the adapter's own link."""

import logging
import queue
from collections.abc import Callable
from typing import Any

from fricomp.errors import AdapterConfigurationError, AdapterError, AdapterTimeout
from fricomp.extras import needing

from .objects import CanOpenObject

__all__ = ["SERVER_ANSWER", "ServiceChannel"]

SERVER_ANSWER = 0x580

INITIATED = (2, 3)
"""Upper three bits of the answers that begin a transfer, to reading and to writing; they name the object [cia301]."""

# Abort codes that say an object is not there, rather than that something went wrong [cia301].
ABSENT = {0x06020000, 0x06090011}

Wait = Callable[[Callable[[], bool], float, str], None]


class ServiceChannel:
    """Reads and writes objects of one node.

    Args:
        node_id: The node.
        send: Sends a frame: identifier and data.
        wait: Pumps the link until a condition holds; the pump hands answers to `on_answer`.
        timeout: Longest time to an answer [s].

    Raises:
        MissingExtraError: canopen is not installed.
    """

    def __init__(self, node_id: int, send: Callable[[int, bytes], None], wait: Wait, timeout: float) -> None:
        self._node_id = node_id
        self._awaited: bytes | None = None  # index and subindex of the transfer under way
        self._client = _make_client(node_id, send, _PumpedQueue(wait, timeout))

    def on_answer(self, data: bytes) -> None:
        """Take in an answer of the node; one that nobody waits for any more, such as to a stop, is dropped."""
        if self._awaited is None or (len(data) == 8 and data[0] >> 5 in INITIATED and data[1:4] != self._awaited):
            return
        self._client.on_response(SERVER_ANSWER + self._node_id, data, 0.0)

    def read(self, entry: CanOpenObject) -> int:
        """Value of an object.

        Raises:
            AdapterTimeout: The node does not answer.
            AdapterError: It refuses.
        """
        return entry.unpack(self._transfer(lambda: self._client.upload(entry.index, entry.subindex), entry, "read"))

    def read_if_present(self, entry: CanOpenObject) -> int | None:
        """Value of an object, or None where the drive has none.

        Raises:
            AdapterTimeout: The node does not answer.
            AdapterError: It refuses for another reason.
        """
        try:
            return self.read(entry)
        except _ObjectAbsent:
            return None

    def write(self, entry: CanOpenObject, value: int) -> None:
        """Write an object.

        Raises:
            AdapterTimeout: The node does not answer.
            AdapterError: It refuses.
        """
        self._transfer(lambda: self._client.download(entry.index, entry.subindex, entry.pack(value)), entry, "write")

    def write_confirmed(self, entry: CanOpenObject, value: int) -> None:
        """Write an object and read it back.

        Raises:
            AdapterConfigurationError: The drive keeps another value.
        """
        self.write(entry, value)
        found = self.read(entry)
        if found != value:
            raise AdapterConfigurationError(
                f"node {self._node_id} keeps {found:#x} in object {entry.index:#06x}:{entry.subindex} "
                f"where {value:#x} was written"
            )

    def write_if_present(self, entry: CanOpenObject, value: int) -> bool:
        """Write an object that a drive may lack, and read it back; whether the drive has it.

        Some drives refuse the write of what only a PDO may change: what counts is what stands there afterwards.

        Raises:
            AdapterTimeout: The node does not answer.
            AdapterConfigurationError: The drive has the object and keeps another value in it.
            AdapterError: It cannot be read back.
        """
        refusal = ""
        try:
            self.write(entry, value)
        except _ObjectAbsent:
            return False
        except AdapterTimeout:
            raise
        except AdapterError as error:
            refusal = f": {error}"
        found = self.read(entry)
        if found != value:
            raise AdapterConfigurationError(
                f"node {self._node_id} keeps {found} in object {entry.index:#06x} where it must be {value}{refusal}"
            )
        return True

    def try_write(self, entry: CanOpenObject, value: int) -> bool:
        """Write an object that a drive may do without; whether it took it."""
        try:
            self.write(entry, value)
        except AdapterTimeout:
            raise
        except AdapterError:
            return False
        return True

    def _transfer(self, transfer: Callable[[], Any], entry: CanOpenObject, verb: str) -> bytes:
        from canopen import SdoAbortedError, SdoCommunicationError

        what = f"cannot {verb} object {entry.index:#06x}:{entry.subindex} of node {self._node_id}"
        self._awaited = entry.index.to_bytes(2, "little") + bytes((entry.subindex,))
        try:
            return bytes(transfer() or b"")
        except SdoAbortedError as error:
            kind = _ObjectAbsent if error.code in ABSENT else AdapterError
            raise kind(f"{what}: {error}") from error
        except SdoCommunicationError as error:
            raise AdapterTimeout(f"{what}: {error}") from error
        except AdapterError:
            raise
        except Exception as error:  # canopen raises struct and key errors on answers that are damaged
            raise AdapterError(f"{what}: damaged answer ({error!r})") from error
        finally:
            self._awaited = None


class _ObjectAbsent(AdapterError):
    """The drive has no such object."""


class _PumpedQueue(queue.Queue[bytes]):
    """A queue that fetches its own entries: `get` pumps the link."""

    def __init__(self, wait: Wait, seconds: float) -> None:
        super().__init__()
        self._wait, self._seconds = wait, seconds

    def get(self, block: bool = True, timeout: float | None = None) -> bytes:
        try:
            self._wait(lambda: not self.empty(), self._seconds, "no SDO answer")
        except AdapterTimeout as error:
            raise queue.Empty from error
        return super().get(block=False)


class _Wire:
    """What an SDO client needs of a network."""

    def __init__(self, send: Callable[[int, bytes], None]) -> None:
        self._send = send

    def send_message(self, can_id: int, data: bytes, remote: bool = False) -> None:
        """Send one frame."""
        self._send(can_id, bytes(data))


def _make_client(node_id: int, send: Callable[[int, bytes], None], answers: _PumpedQueue) -> Any:
    with needing("canopen", "can"):
        import canopen
        from canopen.sdo.client import SdoClient
    # What it logs is raised as an error, too; without a handler Python would print it on top.
    logging.getLogger("canopen").addHandler(logging.NullHandler())

    class PumpedClient(SdoClient):
        """Keeps its pumped queue: the client replaces it by a plain one to drop late answers, which empties it here."""

        @property
        def responses(self) -> _PumpedQueue:
            return answers

        @responses.setter
        def responses(self, _: object) -> None:
            while not answers.empty():
                answers.get_nowait()

    make: Any = PumpedClient  # canopen is typed in part only
    dictionary: Any = canopen.ObjectDictionary
    client = make(0x600 + node_id, SERVER_ANSWER + node_id, dictionary())
    client.network = _Wire(send)
    return client
