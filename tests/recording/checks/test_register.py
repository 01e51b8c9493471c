"""A torque that is larger than its register holds comes back from the other end of the range."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import check_recording
from fricomp.recording.parts.parts import find_usable_parts

from ..joint_log import joint_log


@pytest.mark.parametrize("start", [0.0, 3.0])
@pytest.mark.parametrize("bits", [8, 12, 16])
def test_it_is_unfolded_and_told(bits: int, start: float) -> None:
    log = joint_log(20.0, 250.0, bits)
    log = log.window(log.time[0] + start, log.time[-1])
    span = 1.4 * float(np.max(np.abs(log.torque)))
    count = span / 2**bits
    torque = count * np.round(log.torque / count)
    folded = log.with_channels(torque=np.mod(torque + 0.5 * span, span) - 0.5 * span)
    (found,) = [one for one in check_recording(folded) if one.code == "folded_torque"]
    assert f"unwrap = {span:.6g}" in found.advice
    usable = find_usable_parts(folded)
    assert usable.kept.torque == pytest.approx(torque, abs=1e-6 * span)
    assert any("unfolded" in sentence for sentence in usable.sentences)


def test_a_torque_that_jumps_from_limit_to_limit_is_none() -> None:
    time = np.arange(0.0, 20.0, 4e-3)
    torque = 5.0 * np.sign(np.sin(3.0 * time))
    velocity = np.convolve(torque, np.exp(-np.arange(400) * 0.02), mode="full")[: time.size] * 0.02
    log = joint_log(20.0, 250.0, 3).with_channels(time=time, position=np.cumsum(velocity) * 4e-3, torque=torque)
    assert not [one for one in check_recording(log) if one.code == "folded_torque"]
