"""Which MIT-mode motors answer to a question: Damiao about its registers, CyberGear and Robstride about a parameter.

T-Motor AK, and Robstride in its MIT protocol, answer nothing but commands, so that nobody can look for them.
"""

import struct
from collections.abc import Sequence

from ..asking import AskedBus, FoundDrive
from ..link import CanFrame
from .codec import MitRanges
from .cybergear import READ, RUNNING, STATE, CyberGearMotor
from .motor import DamiaoMotor
from .profile import Register, Registers, VendorProfile, vendor_profiles

__all__ = ["find_cybergear", "find_damiao"]

ADDRESSES = range(1, 128)
"""Motor ids that are asked; those of Damiao may be as high as 0x7FE, which nobody sets without need."""
ANSWER_TIME = 0.1  # of the slowest motor [s]
FEEDBACK_ID = Register(7, "uint32")  # of a Damiao [damiao2024]
OUR_ID = 0xFD  # the host's, as CyberGear's own tool has it [xiaomi2023]
ANY_RANGES = MitRanges(1.0, 1.0, 1.0)  # of no effect on questions


def find_damiao(bus: AskedBus) -> list[FoundDrive]:
    """Damiao motors, by the register that holds the identifier of their answers."""
    profile = vendor_profiles()["damiao"]
    questions = [_damiao(address, 0).read_frame(FEEDBACK_ID) for address in ADDRESSES]
    answers = {}
    for frame in bus.ask(questions, ANSWER_TIME):
        address = int.from_bytes(frame.data[:2], "little")
        answer = _damiao(address, frame.identifier).decode_register(frame) if address in ADDRESSES else None
        if not frame.extended and answer == (FEEDBACK_ID.number, frame.identifier.to_bytes(4, "little")):
            answers[address] = frame.identifier
    return [_look_at(bus, address, feedback_id, profile) for address, feedback_id in sorted(answers.items())]


def _damiao(address: int, feedback_id: int) -> DamiaoMotor:
    return DamiaoMotor(address, feedback_id, ANY_RANGES, Registers())


def _look_at(bus: AskedBus, address: int, feedback_id: int, profile: VendorProfile) -> FoundDrive:
    """Ask one motor for its ranges, which tell its model, and for its state."""
    motor, registers = _damiao(address, feedback_id), profile.registers
    wanted = [r for r in (registers.position, registers.velocity, registers.torque) if r is not None]
    heard = bus.ask([*(motor.read_frame(register) for register in wanted), motor.poll_frame], ANSWER_TIME)
    known = dict(filter(None, map(motor.decode_register, heard)))
    ranges = [struct.unpack("<f", known[r.number])[0] for r in wanted if r.number in known]
    states = list(filter(None, map(motor.decode, heard)))
    what = f"Damiao, feedback_id {feedback_id:#x}"
    if len(ranges) == len(wanted):
        what += f", ranges [{', '.join(f'{value:g}' for value in ranges)}]"
    if states and states[-1].fault:
        what += f", fault {states[-1].fault:#x}"
    return FoundDrive("mit", address, what, states[-1].enabled if states else None)


def find_cybergear(bus: AskedBus, heard: Sequence[CanFrame]) -> list[FoundDrive]:
    """CyberGear and Robstride in its native protocol, by their run mode; their state is told to commands alone.

    Args:
        bus: To ask on.
        heard: What came before anything was asked: answers to somebody else's commands tell that a motor runs.
    """
    mode = vendor_profiles()["robstride"].registers.mode
    if mode is None:
        return []
    questions = [CyberGearMotor(n, OUR_ID, ANY_RANGES, Registers()).read_frame(mode) for n in ADDRESSES]
    found: dict[int, bool | None] = {}
    for frame in bus.ask(questions, ANSWER_TIME):
        address, place = frame.identifier >> 8 & 0xFF, frame.data[:2]
        is_answer = frame.extended and frame.identifier >> 24 == READ and frame.identifier & 0xFF == OUR_ID
        if is_answer and address in ADDRESSES and place == mode.number.to_bytes(2, "little"):
            found[address] = None
    for frame in heard:
        address = frame.identifier >> 8 & 0xFF
        if frame.extended and frame.identifier >> 24 == STATE and address in found:
            found[address] = frame.identifier >> 22 & 0x3 == RUNNING
    return [FoundDrive("mit", n, "CyberGear or Robstride", energised) for n, energised in sorted(found.items())]
