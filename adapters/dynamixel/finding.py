"""Which Dynamixel servos answer to a ping, and whether their torque is on."""

from ..asking import AskedLine, FoundDrive
from .control_table import MODEL_NUMBER, TORQUE_ENABLE, Item, Model, models
from .packet import BROADCAST, Instruction, StatusPacket, encode_packet, read_packet
from .packet_buffer import PacketBuffer

__all__ = ["find_dynamixel"]

MOST_SERVOS = 253
TURN = 0.003
"""How long each servo may take until its answer begins [s]; the vendor's own software waits as long."""
LATENCY = 0.016  # of the host's serial port, as FTDI's drivers have it [s]
PING_BYTES, BITS = 14, 10  # of an answer to a ping, and of a byte on the wire
READ_TIME = 0.05  # [s]


def find_dynamixel(line: AskedLine) -> list[FoundDrive]:
    """Servos that speak protocol 2.0. Asking feeds their bus watchdogs, as any instruction does."""
    patience = MOST_SERVOS * (TURN + PING_BYTES * BITS / line.baudrate) + LATENCY
    answer = line.ask(encode_packet(BROADCAST, Instruction.PING), patience)
    found = []
    for servo, _, data in PacketBuffer().take(answer):
        if len(data) == 3:
            energised = _read(line, servo, TORQUE_ENABLE)
            model = models().get(
                number := int.from_bytes(data[: MODEL_NUMBER.size], "little"), Model(f"model {number}")
            )
            able = "" if model.current_count is not None else ", which cannot control current"
            what = f"{model.name}, firmware {data[2]}{able}"
            found.append(FoundDrive("dynamixel", servo, what, None if energised is None else bool(energised)))
    return found


def _read(line: AskedLine, servo: int, item: Item) -> int | None:
    """An item of a servo; None where it does not answer."""

    def parse(data: bytes) -> list[StatusPacket]:
        return [p for p in PacketBuffer().take(data) if p.identifier == servo and len(p.data) == item.size]

    answer = parse(line.ask(read_packet(servo, *item), READ_TIME, lambda data: bool(parse(data))))
    return int.from_bytes(answer[0].data, "little") if answer else None
