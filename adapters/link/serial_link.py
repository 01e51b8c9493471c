"""Bytes through pyserial, any address of it; reads everything that has come, never waits."""

from __future__ import annotations

import os
import select
from time import monotonic, sleep
from typing import TYPE_CHECKING, Protocol

from fricomp.errors import AdapterConnectionError
from fricomp.extras import needing

from ..configuration import SerialConfiguration
from ..ports import BY_SERIAL_NUMBER, find_device

if TYPE_CHECKING:
    import serial

__all__ = ["PySerialLink", "SerialLink", "open_serial_link"]

WRITE_TIMEOUT = 0.005
"""How long bytes may wait for a place in the operating system's queue [s]; longer, and the port is taken for dead."""

MOST_BYTES_AT_ONCE = 65536

HOW_TO_FIND = f"; fricomp adapters --scan lists the ports, and one named {BY_SERIAL_NUMBER}NUMBER is found again"


class SerialLink(Protocol):
    """What an adapter needs of a serial port. Errors are `AdapterConnectionError`."""

    def send(self, data: bytes) -> None:
        """Hand over all bytes; from any thread."""

    def receive(self) -> bytes:
        """All bytes that have come; empty at once if none has."""

    def discard_output(self) -> None:
        """Drop what still waits to be sent."""

    def close(self) -> None:
        """Let go of the port."""


class PySerialLink:
    """A pyserial port.

    Where it is a file descriptor of the operating system, that is read and written directly: pyserial asks for every
    piece first whether there is one, which doubles the system calls.

    Args:
        port: Opened already, without waiting for reading or writing; closed by `close`. pyserial's own write timeout
            is no use: on a busy machine it runs out after every byte has been taken.
    """

    def __init__(self, port: serial.SerialBase) -> None:
        self._port = port
        descriptor = getattr(port, "fd", None)
        self._descriptor = descriptor if isinstance(descriptor, int) else None

    def send(self, data: bytes) -> None:
        """Hand over all bytes.

        Raises:
            AdapterConnectionError: The queue stays full, or the port is gone.
        """
        left, deadline = memoryview(data), 0.0
        while left:
            try:
                written = self._write(left)
            except Exception as error:  # SerialException, OSError, termios.error
                raise AdapterConnectionError(f"cannot write to the serial port: {error}") from error
            left = left[written:]
            if not left:
                return
            now = monotonic()
            deadline = deadline or now + WRITE_TIMEOUT
            if now > deadline:
                raise AdapterConnectionError(f"the serial port takes no more: {len(left)} bytes wait in a full queue")

    def receive(self) -> bytes:
        """All bytes that have come.

        Raises:
            AdapterConnectionError: The port is gone.
        """
        try:
            if self._descriptor is None:
                return bytes(self._port.read(MOST_BYTES_AT_ONCE))
            return self._read(self._descriptor)
        except BlockingIOError:
            return b""
        except Exception as error:
            raise AdapterConnectionError(f"cannot read from the serial port: {error}") from error

    @staticmethod
    def _read(descriptor: int) -> bytes:
        """What has come. Nothing, although there is something to be read, is the end of the line."""
        data = os.read(descriptor, MOST_BYTES_AT_ONCE)
        if data or not select.select([descriptor], [], [], 0.0)[0]:
            return data
        data = os.read(descriptor, MOST_BYTES_AT_ONCE)
        if not data:
            raise OSError("it has been unplugged")
        return data

    def wait(self, seconds: float) -> None:
        """Wait until bytes come, at most so long [s]."""
        try:
            select.select([self._port.fileno()], [], [], seconds)
        except (AttributeError, OSError, ValueError):  # ports that cannot be waited for, such as those of Windows
            sleep(min(seconds, 0.0005))

    def fileno(self) -> int:
        """For waiting with select."""
        return int(self._port.fileno())

    def _write(self, data: memoryview) -> int:
        if self._descriptor is None:
            return self._port.write(data) or 0
        try:
            return os.write(self._descriptor, data)
        except BlockingIOError:
            return 0

    def discard_output(self) -> None:
        """Drop what still waits to be sent."""
        try:
            self._port.reset_output_buffer()
        except Exception:  # best effort on the way to a stop
            return

    def close(self) -> None:
        """Let go of the port.

        Raises:
            AdapterConnectionError: The port fails to close.
        """
        try:
            self._port.close()
        except Exception as error:
            raise AdapterConnectionError(f"the serial port does not close: {error}") from error


def open_serial_link(configuration: SerialConfiguration) -> PySerialLink:
    """The port that stands in the configuration; one that is named by its serial number is looked for anew.

    Raises:
        AdapterConnectionError: It cannot be opened, or no port has its serial number.
        MissingExtraError: pyserial is not installed.
    """
    with needing("pyserial", "serial"):
        import serial
    device = find_device(configuration.port)
    try:
        port = serial.serial_for_url(device, baudrate=configuration.baudrate, timeout=0.0, write_timeout=0.0)
    except Exception as error:
        hint = "" if configuration.port.startswith(BY_SERIAL_NUMBER) else HOW_TO_FIND
        raise AdapterConnectionError(f"cannot open serial port {device!r}: {error}{hint}") from error
    return PySerialLink(port)
