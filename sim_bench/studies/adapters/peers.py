"""Frames of the adapters against those of independent encoders, over random commands."""

import random
import struct
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import version
from importlib.resources import files
from math import nan, tau
from typing import Any

__all__ = ["PEERS", "PEER_MODULES", "PeerComparison", "compare_with_peer"]

PEER_MODULES = ("canopen", "cantools", "damiao_motor", "dynamixel_sdk", "moteus", "odrive_can", "robstride")
"""Import names of the independent encoders; only those who develop need most of them, so that `dev` brings them."""


@dataclass(frozen=True)
class PeerComparison:
    """What came out of one protocol.

    Attributes:
        protocol: Which, and what of it.
        peer: Package and version.
        n_commands: Random commands.
        n_identical: Frames identical to the byte.
        differences: How many of each kind of difference, by its reason.
        unexplained: Up to five frames that differ for no known reason: the command, ours and theirs.
    """

    protocol: str
    peer: str
    n_commands: int
    n_identical: int
    differences: dict[str, int] = field(default_factory=dict)
    unexplained: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every difference has its reason."""
        return not self.unexplained


Pair = tuple[str, bytes, bytes, str]
"""The command in words, our bytes, theirs, and the known reason of a difference, empty if there is none."""


def compare_with_peer(protocol: str, n_commands: int, seed: int = 1) -> PeerComparison:
    """Encode random commands with the adapter's codec and with the peer's.

    Args:
        protocol: One of `PEERS`.
        n_commands: How many.
        seed: Of the commands.
    """
    package, make = PEERS[protocol]
    differences: Counter[str] = Counter()
    unexplained: list[str] = []
    n_identical = n_made = 0
    for command, ours, theirs, reason in make(random.Random(seed), n_commands):
        n_made += 1
        if ours == theirs:
            n_identical += 1
        elif reason:
            differences[reason] += 1
        elif len(unexplained) < 5:
            unexplained.append(f"{command}: {ours.hex()} against {theirs.hex()}")
    peer = f"{package} {version(package)}"
    return PeerComparison(protocol, peer, n_made, n_identical, dict(differences), tuple(unexplained))


# -- MIT ------------------------------------------------------------------------------------------------------------

TRUNCATED = "the peer cuts off where the adapter rounds: one count lower in a field, and farther from the value"
CUT_ON_GRID = "the peer cuts off a value that lies on its code but for a rounding error of the 17th digit"


def _compare_mit(rng: random.Random, n: int) -> Iterator[Pair]:
    from damiao_motor.core.motor import DaMiaoMotor

    from fricomp.adapters.mit import MitCodec, MitRanges

    ranges = MitRanges(12.5, 30.0, 10.0)
    ours, peer = MitCodec(ranges), DaMiaoMotor(1, 0x11, None, motor_type="4310")
    spans = [(-12.5, 12.5, 65535), (-30.0, 30.0, 4095), (0.0, 500.0, 4095), (0.0, 5.0, 4095), (-10.0, 10.0, 4095)]
    for number in range(n):
        on_grid = number % 2 == 0
        shares = [rng.randrange(top + 1) / top if on_grid else rng.uniform(-0.05, 1.05) for _, _, top in spans]
        values = [low + share * (high - low) for share, (low, high, _) in zip(shares, spans, strict=True)]
        q, dq, kp, kd, torque = values
        mine, theirs = ours.encode(q, dq, kp, kd, torque), peer.encode_cmd_msg(q, dq, torque, kp, kd)
        yield repr(values), mine, theirs, _judge_mit(mine, theirs, values, spans, on_grid)


def _read_mit_fields(data: bytes) -> list[int]:
    packed = int.from_bytes(data, "big")
    return [packed >> 48, packed >> 36 & 0xFFF, packed >> 24 & 0xFFF, packed >> 12 & 0xFFF, packed & 0xFFF]


def _judge_mit(
    mine: bytes, theirs: bytes, values: list[float], spans: list[tuple[float, float, int]], on_grid: bool
) -> str:
    """The reason if every differing field is one count apart, and ours the nearer."""
    for a, b, value, (low, high, top) in zip(
        _read_mit_fields(mine), _read_mit_fields(theirs), values, spans, strict=True
    ):
        exact = (min(max(value, low), high) - low) / (high - low) * top
        if a != b and not (a - b == 1 and abs(a - exact) <= abs(b - exact)):
            return ""
    return CUT_ON_GRID if on_grid else TRUNCATED


def _compare_cybergear(rng: random.Random, n: int) -> Iterator[Pair]:
    """States: the peer has no encoder of commands, so that what both read from a random state is compared."""
    import can
    from robstride import Client

    from fricomp.adapters.link import CanFrame
    from fricomp.adapters.mit.cybergear import CyberGearMotor
    from fricomp.adapters.mit.profile import find_model

    profile, ranges = find_model("robstride/RS01")
    motor = CyberGearMotor(7, 0xAA, ranges, profile.registers)
    peer: Any = Client(None, host_can_id=0xAA)
    for _ in range(n):
        data = rng.randbytes(8)
        identifier = 2 << 24 | 7 << 8 | 0xAA
        state = motor.decode(CanFrame(identifier, data, True))
        theirs = peer._parse_feedback_resp(can.Message(arbitration_id=identifier, data=data), 7, 1)
        read = [theirs.angle, theirs.velocity, theirs.torque, theirs.temp]
        mine = [] if state is None else [state.position, state.velocity, state.torque, state.temperature]
        yield data.hex(), _format_six_digits(mine), _format_six_digits(read), ""


def _format_six_digits(values: list[float]) -> bytes:
    return struct.pack(f"<{len(values)}q", *(round(value * 1e6) for value in values))


# -- ODrive ---------------------------------------------------------------------------------------------------------


@cache
def _load_dbc(name: str) -> Any:
    import cantools

    return cantools.database.load_string((files("odrive_can") / "dbc" / name).read_text(), "dbc")


CUT_FEED_FORWARD = "the peer cuts off thousandths of feed-forward where the adapter rounds: one count nearer to zero"


def _compare_odrive(name: str) -> Callable[[random.Random, int], Iterator[Pair]]:
    def make(rng: random.Random, n: int) -> Iterator[Pair]:
        from fricomp.adapters.odrive.codec import input_frame

        dbc = _load_dbc(name)
        for number in range(n):
            torque, velocity, position = rng.uniform(-30, 30), rng.uniform(-100, 100), rng.uniform(-100, 100)
            mode, message, signals = (
                ("torque", "Set_Input_Torque", {"Input_Torque": torque}),
                ("velocity", "Set_Input_Vel", {"Input_Vel": velocity / tau, "Input_Torque_FF": torque}),
                ("position", "Set_Input_Pos", {"Input_Pos": position / tau, "Vel_FF": 0.0, "Torque_FF": torque}),
            )[number % 3]
            mode_name: Any = mode
            theirs = dbc.get_message_by_name(f"Axis0_{message}").encode(signals)
            mine = input_frame(0, mode_name, torque, velocity, position).data
            yield f"{mode} {torque!r} {velocity!r} {position!r}", mine, theirs, _judge_odrive(mine, theirs, torque)

    return make


def _judge_odrive(mine: bytes, theirs: bytes, torque: float) -> str:
    a, b = (int.from_bytes(data[6:8], "little", signed=True) for data in (mine, theirs))
    nearer = abs(a * 1e-3 - torque) <= abs(b * 1e-3 - torque)
    return CUT_FEED_FORWARD if mine[:6] == theirs[:6] and abs(a - b) == 1 and nearer else ""


# -- moteus, Dynamixel, CiA 402 -------------------------------------------------------------------------------------


def _compare_moteus(rng: random.Random, n: int) -> Iterator[Pair]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import moteus

    from fricomp.adapters.moteus.codec import encode_command

    peer = moteus.Controller(id=1)
    for number in range(n):
        torque, reference, highest = rng.uniform(-3, 3), rng.uniform(-20, 20), rng.uniform(3, 5)
        mode: Any = ("torque", "velocity", "position")[number % 3]
        gain = 0.0 if mode == "torque" else 1.0
        made = peer.make_position(
            position=reference / tau if mode == "position" else nan,
            velocity=reference / tau if mode == "velocity" else 0.0,
            feedforward_torque=torque,
            kp_scale=gain,
            kd_scale=gain,
            maximum_torque=highest,
            watchdog_timeout=0.1,
            query=True,
        )
        mine = encode_command(mode, torque, reference, highest, 0.1)
        yield f"{mode} {torque!r} {reference!r}", mine, bytes(made.data), ""


NOT_STUFFED = "the peer throws the result of its own stuffing away, so that FF FF FD goes out as it is"


class _SdkPort:
    """Catches what the vendor's package sends."""

    def __init__(self) -> None:
        self.is_using, self.sent = False, b""

    def clearPort(self) -> None:  # noqa: N802
        """Nothing to clear."""

    def writePort(self, packet: list[int]) -> int:  # noqa: N802
        """Keep it."""
        self.sent = bytes(packet)
        return len(packet)


def _compare_dynamixel(rng: random.Random, n: int) -> Iterator[Pair]:
    from dynamixel_sdk import Protocol2PacketHandler

    from fricomp.adapters.dynamixel.packet import SyncWriter

    handler, port = Protocol2PacketHandler(), _SdkPort()
    items = ((102, 2, 1193), (104, 4, 1023), (116, 4, 1_048_575))
    writers = {address: SyncWriter(address, size, b"\x01\x02") for address, size, _ in items}
    for number in range(n):
        address, size, top = items[number % 3]
        counts = [rng.randint(-top, top) for _ in (1, 2)]
        goals = [(servo, *count.to_bytes(size, "little", signed=True)) for servo, count in enumerate(counts, 1)]
        parameters = [byte for goal in goals for byte in goal]
        port.is_using = False
        handler.syncWriteTxOnly(port, address, size, parameters, len(parameters))
        mine = writers[address].encode(counts)
        yield repr(goals), mine, port.sent, NOT_STUFFED if b"\xff\xff\xfd" in bytes(parameters) else ""


def _compare_canopen(rng: random.Random, n: int) -> Iterator[Pair]:
    import canopen

    from fricomp.adapters.canopen.drive import CanOpenDrive
    from fricomp.adapters.canopen.process_data import COMMAND_OBJECTS
    from fricomp.adapters.canopen.scaling import DriveScaling

    from ...twins.canopen.node import EDS

    node: Any = canopen.RemoteNode(1, str(EDS))
    nothing: Any = None
    drive = CanOpenDrive(1, nothing)
    drive.scaling = DriveScaling(tau / 65536, tau / 65536, 5e-3, 15.0, 1e3)
    for number in range(n):
        mode: Any = ("torque", "velocity", "position")[number % 3]
        torque, velocity, position = (
            rng.randint(-3000, 3000),
            rng.randint(-(10**6), 10**6),
            rng.randint(-(10**6), 10**6),
        )
        drive.use_mode(mode)
        mine = drive.command(15, torque * 5e-3, velocity * tau / 65536, position * tau / 65536).data
        pdo = node.rpdo[1]
        pdo.clear()
        counts = {"torque": (15, torque), "velocity": (15, velocity, torque), "position": (15, position, torque)}[mode]
        variables = [pdo.add_variable(entry.index) for entry in COMMAND_OBJECTS[mode]]
        for variable, count in zip(variables, counts, strict=True):
            variable.raw = count
        yield f"{mode} {counts}", mine, bytes(pdo.data), ""


PEERS: dict[str, tuple[str, Callable[[random.Random, int], Iterator[Pair]]]] = {
    "canopen": ("canopen", _compare_canopen),
    "dynamixel": ("dynamixel-sdk", _compare_dynamixel),
    "mit": ("damiao-motor", _compare_mit),
    "mit, CyberGear states": ("robstride", _compare_cybergear),
    "moteus": ("moteus", _compare_moteus),
    "odrive 0.5": ("odrive-can", _compare_odrive("odrive-cansimple-0.5.6.dbc")),
    "odrive 0.6": ("odrive-can", _compare_odrive("odrive-cansimple-0.6.10.dbc")),
}
