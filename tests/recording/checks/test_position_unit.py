"""Positions in turns are told by the encoder's step, a wrap or a reference; others are not taken for such."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording
from fricomp.recording.parts.parts import find_usable_parts

from ..joint_log import joint_log


def _told(recording: Recording) -> list[str]:
    return [str(one) for one in check_recording(recording) if one.code == "turns"]


def _count(log: Recording, counts: int, turn: float) -> Recording:
    """The log by an encoder of so many counts a turn, which is written as `turn`."""
    position = np.round(np.asarray(log.position) / (2.0 * np.pi) * counts) / counts * turn
    return log.with_channels(position=position).with_metadata(encoder_resolution=None)


@pytest.mark.parametrize(("counts", "rate", "seed"), [(2**12, 100.0, 1), (2**14, 500.0, 2), (2**16, 1000.0, 3)])
def test_the_step_of_an_encoder_in_turns_is_told(counts: int, rate: float, seed: int) -> None:
    log = joint_log(30.0, rate, seed)
    (said,) = _told(_count(log, counts, 1.0))
    assert f"which is 1 / 2^{counts.bit_length() - 1}" in said
    assert 'unit = "turns"' in said
    assert _told(_count(log, counts, 2.0 * np.pi)) == []


@pytest.mark.parametrize("step", [1e-3, 5e-4, 25.0 / 65535.0, 0.088 * np.pi / 180.0])
def test_other_steps_say_nothing_of_turns(step: float) -> None:
    log = joint_log(30.0, 250.0, 4)
    assert _told(log.with_channels(position=np.round(np.asarray(log.position) / step) * step)) == []


def test_numbers_in_single_precision_are_no_steps() -> None:
    log = joint_log(60.0, 1000.0, 5)
    assert _told(log.with_channels(position=np.float64(np.float32(log.position)))) == []


def test_a_stated_encoder_decides() -> None:
    log = _count(joint_log(30.0, 250.0, 6), 4096, 1.0)
    assert _told(log.with_metadata(encoder_resolution=2.0 * np.pi / 4096))
    assert _told(log.with_metadata(encoder_resolution=1.0 / 4096)) == []


def test_a_reference_in_radians_beside_turns_is_told() -> None:
    log = joint_log(30.0, 250.0, 7)
    turns = np.asarray(log.position) / (2.0 * np.pi) + np.random.default_rng(7).normal(0.0, 1e-5, len(log))
    assert "position_reference" in _told(log.with_channels(position=turns, position_reference=log.position))[0]
    assert _told(log.with_channels(position_reference=log.position)) == []


def test_a_position_that_wraps_at_one_is_told_and_not_unwrapped_as_radians() -> None:
    log = joint_log(30.0, 250.0, 8)
    angle = 3.0 * (np.asarray(log.position) - log.position[0])
    wrapped = replace(log, position=np.mod(angle / (2.0 * np.pi), 1.0), velocity=None)
    assert any("wraps round at 1" in one for one in _told(wrapped))
    assert "turns" in {one.code for one in check_recording(find_usable_parts(wrapped).kept)}
    assert _told(replace(log, position=np.mod(angle, 2.0 * np.pi), velocity=None)) == []
