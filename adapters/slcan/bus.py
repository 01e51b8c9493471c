"""A python-can bus over slcan that reads the serial port in chunks, not byte by byte."""

import time
from collections import deque
from contextlib import suppress
from threading import Lock
from typing import Any

import can

from fricomp.errors import AdapterConnectionError, FricompError

from ..configuration import SerialConfiguration
from ..link import CanFrame
from ..link.serial_link import open_serial_link
from .codec import CARRIAGE_RETURN, decode_line, encode_frame

__all__ = ["ChunkedSlcanBus"]

BITRATES = {10_000: 0, 20_000: 1, 50_000: 2, 100_000: 3, 125_000: 4, 250_000: 5, 500_000: 6, 750_000: 7, 1_000_000: 8}
BELL = b"\a"
LONGEST_LINE = 1 + 8 + 1 + 16 + 4  # T, identifier, length, data, time stamp
LOCK_PATIENCE = 0.02
LONGEST_WAIT = 0.5


class ChunkedSlcanBus(can.BusABC):
    """Serial CAN adapters with the Lawicel protocol: CANable, CANtact, USBtin and others.

    Args:
        channel: Serial device or any pyserial address.
        bitrate: Of the CAN bus [bit/s].
        tty_baudrate: Of the serial line [baud]; USB devices ignore it.
        listen_only: Open without acknowledging or sending.

    Raises:
        can.CanInitializationError: The bit rate is not one of slcan's, or the port does not open.
    """

    def __init__(
        self,
        channel: str,
        bitrate: int = 1_000_000,
        tty_baudrate: int = 115_200,
        listen_only: bool = False,
        **kwargs: Any,
    ) -> None:
        if bitrate not in BITRATES:
            raise can.CanInitializationError(f"bit rate {bitrate} is not one of slcan's: {sorted(BITRATES)}")
        try:
            self._line = open_serial_link(SerialConfiguration(port=channel, baudrate=tty_baudrate))
        except FricompError as error:
            raise can.CanInitializationError(str(error)) from error
        self._channel = channel
        self._send_lock = Lock()
        self._buffer = b""
        self._frames: deque[CanFrame] = deque()
        self.n_damaged = 0
        self.channel_info = f"slcan on {channel}, read in chunks"
        super().__init__(channel=channel, **kwargs)
        # An empty line first: it ends whatever was cut short before us.
        self._put(b"\rC\r" + f"S{BITRATES[bitrate]}\r".encode() + (b"L\r" if listen_only else b"O\r"))

    def _put(self, data: bytes) -> None:
        held = self._send_lock.acquire(timeout=LOCK_PATIENCE)  # a hung writer must not hold up a stop
        try:
            self._line.send(data)
        except AdapterConnectionError as error:
            raise can.CanOperationError(str(error)) from error
        finally:
            if held:
                self._send_lock.release()

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Hand over one message.

        Raises:
            can.CanOperationError: The line is gone or its queue stays full.
        """
        data = bytes(msg.dlc) if msg.is_remote_frame else bytes(msg.data)
        self._put(encode_frame(CanFrame(msg.arbitration_id, data, msg.is_extended_id, msg.is_remote_frame)))

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self._frames:
            self._read_chunk()
            remaining = LONGEST_WAIT if deadline is None else min(deadline - time.monotonic(), LONGEST_WAIT)
            if self._frames:
                break
            if remaining <= 0.0:
                return None, False
            self._line.wait(remaining)
        frame = self._frames.popleft()
        message = can.Message(
            arbitration_id=frame.identifier,
            data=None if frame.remote else frame.data,
            dlc=len(frame.data),
            is_extended_id=frame.extended,
            is_remote_frame=frame.remote,
            timestamp=time.time(),
            channel=self._channel,
        )
        return message, False

    def _read_chunk(self) -> None:
        """Take all that has come."""
        try:
            chunk = self._line.receive()
        except AdapterConnectionError as error:
            raise can.CanOperationError(str(error)) from error
        if not chunk:
            return
        *lines, self._buffer = (self._buffer + chunk).replace(BELL, CARRIAGE_RETURN).split(CARRIAGE_RETURN)
        for line in lines:
            self._take_line(line)
        if len(self._buffer) > LONGEST_LINE:  # no line is as long: the stream is garbage up to the next end of line
            self._buffer = b""
            self.n_damaged += 1

    def _take_line(self, line: bytes) -> None:
        frame = decode_line(line)
        if frame is not None:
            self._frames.append(frame)
        elif line not in (b"", b"z", b"Z"):  # z and Z confirm a sent frame
            self.n_damaged += 1

    def flush_tx_buffer(self) -> None:
        """Drop what waits to be sent; the end of line keeps a cut frame from swallowing the next one."""
        self._line.discard_output()
        self._put(CARRIAGE_RETURN)

    def fileno(self) -> int:
        """For waiting with select."""
        return self._line.fileno()

    def shutdown(self) -> None:
        """Close the CAN channel and the port."""
        super().shutdown()
        with suppress(can.CanOperationError):  # the line may be gone already
            self._put(b"C\r")
        with suppress(AdapterConnectionError):
            self._line.close()
