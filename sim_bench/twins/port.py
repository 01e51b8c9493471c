"""Byte streams that twins listen on: a pseudo-terminal that any serial program opens, or a TCP socket."""

import os
import socket
from contextlib import suppress
from typing import Protocol

__all__ = ["BytePort", "PtyPort", "SocketPort"]

CHUNK = 65536


class BytePort(Protocol):
    """Where bytes come from and go to, without ever blocking."""

    @property
    def address(self) -> str:
        """What pyserial opens to reach it."""

    def read(self) -> bytes:
        """What has come; empty if nothing has."""

    def write(self, data: bytes) -> None:
        """Send; what nobody takes is lost, as on a wire."""

    def close(self) -> None:
        """Let go of it."""


class PtyPort:
    """The device end of a pseudo-terminal."""

    def __init__(self) -> None:
        import tty

        self._device, self._user = os.openpty()
        tty.setraw(self._user)  # held open, so that nobody at the other end is silence and not an error
        os.set_blocking(self._device, False)
        self._address = os.ttyname(self._user)

    @property
    def address(self) -> str:
        """Path of the other end, such as /dev/pts/3."""
        return self._address

    def read(self) -> bytes:
        """What has come."""
        try:
            return os.read(self._device, CHUNK)
        except (BlockingIOError, OSError):
            return b""

    def write(self, data: bytes) -> None:
        """Send."""
        with suppress(BlockingIOError):
            os.write(self._device, data)

    def close(self) -> None:
        """Close both ends."""
        for descriptor in (self._device, self._user):
            with suppress(OSError):
                os.close(descriptor)


class SocketPort:
    """A listening TCP socket on this machine; the last client to connect has it.

    Args:
        port: TCP port; 0 for any free one.
    """

    def __init__(self, port: int = 0) -> None:
        self._listener = socket.create_server(("127.0.0.1", port))
        self._listener.setblocking(False)
        self._client: socket.socket | None = None

    @property
    def address(self) -> str:
        """URL that pyserial opens, such as socket://127.0.0.1:4001."""
        host, port = self._listener.getsockname()[:2]
        return f"socket://{host}:{port}"

    def read(self) -> bytes:
        """What has come."""
        with suppress(BlockingIOError):
            client, _ = self._listener.accept()
            client.setblocking(False)
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._drop()
            self._client = client
        if self._client is None:
            return b""
        try:
            data = self._client.recv(CHUNK)
        except BlockingIOError:
            return b""
        except OSError:
            data = b""
        if not data:
            self._drop()
        return data

    def write(self, data: bytes) -> None:
        """Send."""
        if self._client is not None:
            try:
                self._client.sendall(data)
            except OSError:
                self._drop()

    def close(self) -> None:
        """Close client and listener."""
        self._drop()
        self._listener.close()

    def _drop(self) -> None:
        if self._client is not None:
            self._client.close()
            self._client = None
