"""Which moteus controllers answer: all are asked for their state at once."""

from ..asking import AskedLine, FoundDrive
from .codec import MODE_FAULT, MODE_STOPPED, MODE_TIMEOUT, QUERY, MoteusState, decode_state, pad
from .fdcanusb import decode_line, encode_line

__all__ = ["find_moteus"]

EVERYBODY = 0x7F
ANSWER_TIME = 0.1  # [s]


def find_moteus(line: AskedLine) -> list[FoundDrive]:
    """Controllers behind an fdcanusb."""
    question = b"\n" + encode_line(EVERYBODY, pad(QUERY))  # the empty line ends whatever was cut short before
    found: dict[int, MoteusState] = {}
    for text in line.ask(question, ANSWER_TIME).split(b"\n"):
        frame = decode_line(text)
        state = None if frame is None else decode_state(frame.data)
        if frame is not None and state is not None:
            found[frame.source] = state
    return [_describe(address, state) for address, state in sorted(found.items())]


def _describe(address: int, state: MoteusState) -> FoundDrive:
    """After a timeout a controller stops or brakes, as it is set to: its mode alone does not tell."""
    energised = None if state.mode == MODE_TIMEOUT else state.mode not in (MODE_STOPPED, MODE_FAULT)
    fault = f", fault {state.fault}" if state.fault else ""
    return FoundDrive("moteus", address, f"moteus in mode {state.mode}{fault}", energised)
