"""Process data of drives as they are: COB-IDs that keep their bits or another layout, mappings that are fixed."""

from __future__ import annotations

from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.testing.steps import run, start
from tests.adapters.canopen.rig import CanOpenRig
from tests.adapters.peers.cia402 import Cia402Peer

INVALID_VALUE, READ_ONLY = 0x06090030, 0x06010002


def refusing(peer: Cia402Peer, refuses: Any) -> None:
    """Let a drive refuse writes: `refuses` is given index, subindex and value, and returns an abort code or 0."""
    write = peer.on_write

    def guarded(index: int, subindex: int, data: bytes, check_writable: bool = False) -> None:
        if code := refuses(index, subindex, int.from_bytes(data, "little")):
            raise SdoAbortedError(code)
        write(index, subindex, data, check_writable)

    peer.node.set_data = guarded


def stored(peer: Cia402Peer, index: int, subindex: int, value: int) -> None:
    entry = peer.node.object_dictionary.get_variable(index, subindex)
    peer.set_data(index, subindex, entry.encode_raw(value))


def test_bit_30_of_a_cob_id_is_kept() -> None:
    rig = CanOpenRig()
    for peer in rig.drives:
        for index in (0x1800, 0x1801, 0x1802, 0x1803):
            stored(peer, index, 1, 0xC0000000 | 0x180 + 0x100 * (index & 3) + peer.node_id)
        kept = {index: peer.value(index, 1) & 0x60000000 for index in range(0x1800, 0x1804)}

        def refuses(index: int, subindex: int, value: int, kept: dict[int, int] = kept) -> int:
            is_other = subindex == 1 and index in kept and value & 0x60000000 != kept[index]
            return INVALID_VALUE if is_other else 0

        refusing(peer, refuses)
    rig.adapter.open()
    start(rig)
    assert run(rig, 5, torque=1.0)
    assert rig.drives[0].value(0x1800, 1) == 0x40000181


def test_identifiers_of_another_layout_are_used_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = CanOpenRig()
    stored(rig.drives[0], 0x1400, 1, 0x80000333)
    rig.adapter.open()
    rig.adapter.configure_failure = None  # type: ignore[attr-defined]
    rig.link.recording = True
    with pytest.raises(AdapterError):  # the peer listens on the standard identifier alone
        start(rig)
    assert rig.drives[0].value(0x1400, 1) == 0x333
    assert any(frame.identifier == 0x333 for sent in rig.link.sent for frame in sent)


def test_two_drives_on_one_identifier_are_refused_by_name() -> None:
    rig = CanOpenRig()
    stored(rig.drives[1], 0x1400, 1, 0x80000201)
    rig.adapter.open()
    with pytest.raises(AdapterConfigurationError, match=r"node 2 .* 0x201, which is in use"):
        rig.adapter.configure("torque", rig.period)


def test_a_mapping_that_is_right_is_not_written() -> None:
    rig = CanOpenRig()
    rig.adapter.open()
    start(rig)
    rig.adapter.close()
    for peer in rig.drives:
        refusing(peer, lambda index, subindex, value: READ_ONLY if 0x1600 <= index < 0x1C00 and index & 0x200 else 0)
    rig.adapter.open()
    start(rig)
    assert run(rig, 5, torque=1.0)


def test_a_fixed_mapping_that_is_another_is_refused_by_name() -> None:
    rig = CanOpenRig()
    refusing(rig.drives[0], lambda index, subindex, value: READ_ONLY if index == 0x1600 else 0)
    rig.adapter.open()
    with pytest.raises(AdapterConfigurationError, match=r"node 1 does not take the mapping .* 0x1600 .* fixed"):
        rig.adapter.configure("torque", rig.period)


def test_a_quick_stop_that_ends_energised_is_no_answer_to_our_silence() -> None:
    rig = CanOpenRig(abort_option=3)
    peer = rig.drives[0]
    from tests.adapters.peers.cia402 import I16, variable

    peer.node.object_dictionary.add_object(variable(0x605A, 0, I16, 6))
    rig.adapter.open()
    with pytest.raises(AdapterConfigurationError, match="605A is 6"):
        rig.adapter.configure("torque", rig.period)
