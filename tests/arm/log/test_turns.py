"""Positions that encoders count within one turn go on where they wrap round."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.examination import match_recordings
from fricomp.arm.log.turns import unwrap_turns
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata

from ..moving_arm import record_arm, write_arm

_TIME = np.arange(0.0, 10.0, 0.01)
_ANGLE = 0.3 + 2.5 * np.sin(_TIME)


def _record(position: FloatArray) -> Recording:
    return Recording(_TIME, position, np.cos(_TIME), metadata=RecordingMetadata(joint="a"))


@pytest.mark.parametrize(
    ("wrapped", "turn"),
    [
        (_ANGLE % (2.0 * np.pi), 2.0 * np.pi),
        (np.degrees(_ANGLE) % 360.0, 360.0),
        ((_ANGLE + 3.6) % (2.0 * np.pi), 2.0 * np.pi),
    ],
)
def test_a_position_that_wraps_goes_on(wrapped: FloatArray, turn: float) -> None:
    (whole,), names = unwrap_turns([_record(wrapped)], [True])
    assert names == ("a",)
    away = np.asarray(whole.position) / turn - _ANGLE / (2.0 * np.pi)
    assert np.ptp(away) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "position", [_ANGLE, 10.0 * np.sin(_TIME), 180.0 * np.sin(_TIME), 3.0 * np.sign(np.sin(_TIME))]
)
def test_what_does_not_wrap_stays(position: FloatArray) -> None:
    assert unwrap_turns([_record(position)], [True])[1] == ()


def test_an_axis_that_slides_does_not_wrap() -> None:
    assert unwrap_turns([_record(_ANGLE % (2.0 * np.pi))], [False])[1] == ()


def test_an_arm_whose_encoders_wrap_is_joined_as_it_moved(tmp_path: Path) -> None:
    """The joints of a Kinova count from 0 to 360 degrees, and each jump had been a motion of a turn in one row."""
    simulation = write_arm(tmp_path)
    series = record_arm(simulation, duration=10.0)
    wrapped = [one.with_channels(position=np.asarray(one.position) % (2.0 * np.pi)) for one in series]
    plain, joined = (match_recordings(each, simulation)[1] for each in (series, wrapped))
    assert joined.unwrapped
    away = (joined.parts[0].position - plain.parts[0].position) / (2.0 * np.pi)
    assert away == pytest.approx(np.round(away[:1]) * np.ones_like(away), abs=1e-6)
