"""The control table of the XM430-W350: address, size, value as delivered, and what may be written."""

from dataclasses import dataclass

TABLE_SIZE = 252
EEPROM_END = 64
MODEL_XM430_W350 = 1020

ID, BAUD_RATE = 7, 8
OPERATING_MODE, CURRENT_LIMIT, VELOCITY_LIMIT, TORQUE_ENABLE, HARDWARE_ERROR, WATCHDOG = 11, 38, 44, 64, 70, 98
GOAL_CURRENT, GOAL_VELOCITY, GOAL_POSITION = 102, 104, 116
STATUS_RETURN_LEVEL = 68
# Each indirect datum shows the byte whose number stands in its indirect address: itself, as delivered.
INDIRECT_ADDRESS, INDIRECT_DATA = 168, 224


@dataclass(frozen=True)
class Entry:
    """One item of the control table.

    Attributes:
        size: Bytes.
        default: As delivered.
        lowest: Smallest value that may be written.
        highest: Largest; None where the item is read only.
    """

    size: int
    default: int = 0
    lowest: int = 0
    highest: int | None = None


TABLE: dict[int, Entry] = {
    0: Entry(2, MODEL_XM430_W350),
    2: Entry(4, 0),
    6: Entry(1, 48),
    7: Entry(1, 1, 0, 252),
    8: Entry(1, 3, 0, 7),
    9: Entry(1, 250, 0, 254),
    10: Entry(1, 0, 0, 13),
    11: Entry(1, 3, 0, 16),
    12: Entry(1, 255, 0, 255),
    13: Entry(1, 2, 1, 2),
    20: Entry(4, 0, -1_044_479, 1_044_479),
    24: Entry(4, 10, 0, 1023),
    31: Entry(1, 80, 0, 100),
    32: Entry(2, 160, 95, 160),
    34: Entry(2, 95, 95, 160),
    36: Entry(2, 885, 0, 885),
    38: Entry(2, 1193, 0, 1193),
    44: Entry(4, 200, 0, 1023),
    48: Entry(4, 4095, 0, 4095),
    52: Entry(4, 0, 0, 4095),
    60: Entry(1, 0, 0, 3),
    63: Entry(1, 52, 0, 255),
    64: Entry(1, 0, 0, 1),
    65: Entry(1, 0, 0, 1),
    68: Entry(1, 2, 0, 2),
    69: Entry(1),
    70: Entry(1),
    76: Entry(2, 1920, 0, 16383),
    78: Entry(2, 100, 0, 16383),
    80: Entry(2, 0, 0, 16383),
    82: Entry(2, 0, 0, 16383),
    84: Entry(2, 800, 0, 16383),
    88: Entry(2, 0, 0, 16383),
    90: Entry(2, 0, 0, 16383),
    98: Entry(1, 0, 0, 127),
    100: Entry(2, 0, -885, 885),
    102: Entry(2, 0, -1193, 1193),
    104: Entry(4, 0, -1023, 1023),
    108: Entry(4, 0, 0, 32767),
    112: Entry(4, 0, 0, 32767),
    116: Entry(4, 0, -1_048_575, 1_048_575),
    120: Entry(2),
    122: Entry(1),
    123: Entry(1),
    124: Entry(2),
    126: Entry(2),
    128: Entry(4),
    132: Entry(4),
    136: Entry(4),
    140: Entry(4),
    144: Entry(2, 120),
    146: Entry(1),
} | {
    INDIRECT_ADDRESS + 2 * number: Entry(2, INDIRECT_DATA + number, EEPROM_END, TABLE_SIZE - 1)
    for number in range(TABLE_SIZE - INDIRECT_DATA)
}
