"""What is there: serial ports, CAN interfaces, and the drives that answer on one; drives are only read.

Frames of one protocol may be commands of another: an SDO request to CANopen's node 2 is the emergency stop of ODrive's
axis 48. A CAN bus is listened to first, therefore, and where ODrives are heard nothing is sent at all.
"""

from fricomp.joint import Clock

from .asking import AskedBus, AskedLine, FoundDrive
from .canopen.finding import find_canopen
from .dynamixel.finding import find_dynamixel
from .link import CanLink, SerialLink
from .mit.finding import find_cybergear, find_damiao
from .moteus.finding import find_moteus
from .odrive.finding import find_odrive

__all__ = ["BAUDRATES", "find_on_can", "find_on_serial", "is_slcan"]

LISTENING = 0.6
"""How long a bus is listened to first [s]; ODrives send six heartbeats meanwhile, as they are delivered."""
BAUDRATES = (1_000_000, 57_600)
"""What is tried on a port of which none is told [baud]: that of fricomp's configurations, and a Dynamixel's as it is
delivered; a moteus on USB answers at any."""
VERSION_TIME = 0.05  # [s]


def find_on_can(link: CanLink, clock: Clock) -> list[FoundDrive]:
    """The drives on a CAN bus.

    Args:
        link: Open already.
        clock: Real time unless a simulation brings its own.

    Raises:
        AdapterConnectionError: The bus is off or gone.
    """
    bus = AskedBus(link, clock)
    heard = bus.listen(LISTENING)
    odrives = find_odrive(heard, LISTENING)
    if odrives:
        return odrives
    return find_canopen(bus, heard) + find_damiao(bus) + find_cybergear(bus, heard)


def find_on_serial(link: SerialLink, clock: Clock, baudrate: int) -> list[FoundDrive]:
    """The drives on a serial line: moteus behind an fdcanusb, or Dynamixel servos.

    Args:
        link: Open already.
        clock: Real time unless a simulation brings its own.
        baudrate: Of the line [baud].

    Raises:
        AdapterConnectionError: The port is gone.
    """
    line = AskedLine(link, clock, baudrate)
    return find_moteus(line) or find_dynamixel(line)


def is_slcan(link: SerialLink, clock: Clock, baudrate: int) -> bool:
    """Whether a CAN adapter of the slcan kind answers: it tells its version, its channel stays as it is."""
    answer = AskedLine(link, clock, baudrate).ask(b"\r\rV\r", VERSION_TIME)
    return any(word[:1] == b"V" and len(word) == 5 for word in answer.replace(b"\a", b"\r").split(b"\r"))
