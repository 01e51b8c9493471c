"""A position with its sign in a bit of its register is told, and read as signed; a counter that wraps is none."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording
from fricomp.recording.checks.position_size import find_sign_bit
from fricomp.recording.parts.parts import find_usable_parts
from fricomp.recording.validity import Samples

from ..joint_log import joint_log

STEP = 2.0 * np.pi / 4096


def _count(recording: Recording) -> Samples:
    position = np.asarray(recording.position)
    return np.asarray(np.round((position - 0.5 * (position.min() + position.max())) / STEP), dtype=np.float64)
    return np.asarray(np.round((position - 0.5 * (position.min() + position.max())) / STEP))


@pytest.mark.parametrize("bit", [11, 15])
@pytest.mark.parametrize("rate", [100.0, 500.0])
def test_the_sign_in_a_bit_is_found_and_read(rate: float, bit: int) -> None:
    log = joint_log(20.0, rate, 4)
    counts = _count(log)
    stored = np.where(counts < 0.0, 2.0**bit - counts, counts)
    assert find_sign_bit(stored) == (bit, 1.0)
    scaled = log.with_channels(position=stored * STEP, velocity=None)
    codes = {one.code for one in check_recording(scaled) if one.column == "position"}
    assert "sign_bit" in codes
    assert not codes & {"wrap", "jump"}
    usable = find_usable_parts(scaled)
    assert np.allclose(usable.parts[0].position, counts[: len(usable.parts[0])] * STEP)
    assert any("read as signed" in sentence for sentence in usable.sentences)


@pytest.mark.parametrize("bits", [10, 12, 16])
def test_a_counter_that_wraps_has_no_sign_in_a_bit(bits: int) -> None:
    counts = _count(joint_log(20.0, 250.0, 4))
    assert find_sign_bit(np.mod(counts, 2.0**bits)) is None
    assert find_sign_bit(np.mod(4.0 * counts, 2.0**bits)) is None
    assert find_sign_bit(counts) is None
    assert find_sign_bit(np.abs(counts)) is None
