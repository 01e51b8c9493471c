"""A torque that is logged as a size is refused; one that is never negative is not."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording

from ..joint_log import joint_log


def _codes(log: Recording) -> set[str]:
    return {finding.code for finding in check_recording(log)}


@pytest.mark.parametrize("seed", [3, 8, 21])
@pytest.mark.parametrize("rate", [100.0, 500.0])
def test_a_size_without_its_sign_is_told(rate: float, seed: int) -> None:
    log = joint_log(20.0, rate, seed)
    assert "lost_sign" not in _codes(log)
    assert "lost_sign" in _codes(log.with_channels(torque=np.abs(log.torque)))
    assert "lost_sign" in _codes(log.with_channels(torque=-np.abs(log.torque)))


@pytest.mark.parametrize("load", [1.05, 3.0])
def test_a_joint_under_a_load_need_not_change_the_sign_of_its_torque(load: float) -> None:
    log = joint_log(20.0, 250.0, 5)
    lifted = log.with_channels(torque=log.torque + load * float(np.max(np.abs(log.torque))))
    assert float(np.min(lifted.torque)) > 0.0
    assert "lost_sign" not in _codes(lifted)


@pytest.mark.parametrize("channel", ["position", "velocity"])
def test_a_torque_that_is_another_channel_once_more_is_told(channel: str) -> None:
    log = joint_log(12.0, 250.0, 2)
    assert "copied_torque" not in _codes(log)
    assert "copied_torque" in _codes(log.with_channels(torque=log.channels[channel]))


@pytest.mark.parametrize(("bit", "one"), [(10, 0.004), (15, 2e-4), (11, 0.002)])
def test_a_sign_in_a_bit_is_told_with_the_line_that_reads_it(bit: int, one: float) -> None:
    log = joint_log(20.0, 200.0, 5)
    counts = np.round(log.torque / one)
    stored = np.where(counts < 0.0, 2.0**bit - counts, counts)
    told = check_recording(log.with_channels(torque=one * stored))
    (found,) = [finding for finding in told if finding.code == "sign_bit"]
    assert f"sign_bit = {bit}" in found.advice
    read = np.where(stored >= 2.0**bit, 2.0**bit - stored, stored)
    assert not {"sign_bit", "lost_sign"} & _codes(log.with_channels(torque=one * read))
