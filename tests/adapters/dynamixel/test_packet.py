"""Packets of protocol 2.0, against the examples of the vendor's manual, CRC included [robotis2024]."""

import random

import pytest

from fricomp.adapters.dynamixel.packet import (
    Instruction,
    SyncWriter,
    bulk_read_packet,
    encode_packet,
    read_packet,
    sync_read_packet,
    sync_write_packet,
    write_packet,
)

EXAMPLES = {
    "ping": (encode_packet(1, 0x01), "FF FF FD 00 01 03 00 01 19 4E"),
    "reboot": (encode_packet(1, Instruction.REBOOT), "FF FF FD 00 01 03 00 08 2F 4E"),
    "read": (read_packet(1, 132, 4), "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15"),
    "write": (write_packet(1, 116, (512).to_bytes(4, "little")), "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89"),
    "sync read": (sync_read_packet(132, 4, b"\x01\x02"), "FF FF FD 00 FE 09 00 82 84 00 04 00 01 02 CE FA"),
    "sync write": (
        sync_write_packet(116, {1: b"\x96\0\0\0", 2: b"\xaa\0\0\0"}),
        "FF FF FD 00 FE 11 00 83 74 00 04 00 01 96 00 00 00 02 AA 00 00 00 82 87",
    ),
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_packet_is_the_one_of_the_manual(name: str) -> None:
    packet, expected = EXAMPLES[name]
    assert packet == bytes.fromhex(expected)


def test_a_bulk_read_names_address_and_length_for_each_servo() -> None:
    packet = bulk_read_packet(2, {1: 144, 2: 0x1234})
    assert packet[:-2] == bytes.fromhex("FF FF FD 00 FE 0D 00 92 01 90 00 02 00 02 34 12 02 00")


def test_what_looks_like_a_header_is_stuffed() -> None:
    packet = write_packet(1, 116, b"\xff\xff\xfd\x01")
    assert packet[:-2] == bytes.fromhex("FF FF FD 00 01 0A 00 03 74 00 FF FF FD FD 01")


@pytest.mark.parametrize("n_bytes", [2, 4])
def test_a_writer_of_every_cycle_makes_the_same_packets(n_bytes: int) -> None:
    rng, identifiers = random.Random(5), b"\x01\x07\xfc"
    writer, edge = SyncWriter(102, n_bytes, identifiers), 1 << 8 * n_bytes - 1
    like_a_header = int.from_bytes(b"\xff\xff\xfd\x7f"[-n_bytes:], "little", signed=True)
    for counts in (
        [0, edge - 1, -edge],
        [-1, like_a_header, -3],
        *([rng.randrange(-edge, edge) for _ in range(3)] for _ in range(50)),
    ):
        values = {
            i: count.to_bytes(n_bytes, "little", signed=True) for i, count in zip(identifiers, counts, strict=True)
        }
        assert writer.encode(counts) == sync_write_packet(102, values)
