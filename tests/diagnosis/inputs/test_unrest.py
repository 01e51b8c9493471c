"""Where a loop chatters a torque is more restless than usual; a kick, a motion or coarse steps are no unrest."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.inputs.signal import FloatArray
from fricomp.diagnosis.inputs.unrest import measure_unrest

_DT = 1e-3
_TIME = np.arange(10_000) * _DT
_SMOOTH = 3.0 * np.sin(2.0 * np.pi * 0.7 * _TIME)
_NOISE = 0.02 * np.random.default_rng(4).standard_normal(_TIME.size)
_CHATTER = (_TIME > 4.0) & (_TIME < 4.5)


def _unrest(torque: FloatArray) -> FloatArray:
    return measure_unrest(torque, np.ones(torque.size), _DT)


@pytest.mark.parametrize("step", [0.0, 0.05])
def test_a_loop_that_chatters_for_a_while_is_seen_there(step: float) -> None:
    torque = _SMOOTH + np.where(_CHATTER, 10.0, 1.0) * _NOISE
    found = _unrest(np.round(torque / step) * step if step else torque)
    inside, outside = (_TIME > 4.05) & (_TIME < 4.45), (_TIME < 3.9) | (_TIME > 4.6)
    assert found[inside].min() > 2.5
    assert found[inside].max() < 10.0
    np.testing.assert_array_equal(found[outside], 1.0)


def test_kicks_and_fast_motion_are_no_unrest() -> None:
    kicked = _SMOOTH + _NOISE + np.where(np.isin(np.arange(_TIME.size), [2000, 5000, 7000]), 2.0, 0.0)
    shaken = _SMOOTH + _NOISE + np.where(_CHATTER, 0.5, 0.0) * np.sin(2.0 * np.pi * 12.0 * _TIME)
    for torque in (kicked, shaken):
        np.testing.assert_array_equal(_unrest(torque), 1.0)


def test_rest_does_not_say_what_is_usual() -> None:
    """A joint that rests most of the time is quiet there, and its noise in motion is the usual one."""
    moves = (_TIME > 7.0).astype(np.float64)
    found = measure_unrest(_SMOOTH + (0.1 + moves) * _NOISE, moves, _DT)
    np.testing.assert_array_equal(found, 1.0)


def test_too_few_samples_and_a_torque_without_noise_say_nothing() -> None:
    for torque in (_NOISE[:400], np.zeros(5000)):
        np.testing.assert_array_equal(_unrest(torque), 1.0)
