"""What of a long recording is searched, and that a joint stays warm between its stretches."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fricomp.diagnosis.effects.warming import compute_warming
from fricomp.diagnosis.inputs import past, stretches
from fricomp.diagnosis.inputs.checks import PART_OF, take_usable
from fricomp.diagnosis.inputs.settings import INPUT
from fricomp.diagnosis.inputs.stretches import Stretch, choose_stretches
from fricomp.recording import Recording

_RATE = 200.0


@pytest.fixture(autouse=True)
def short_searches(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if 60 s were much: at 200 Hz the simulations run at 400 Hz."""
    fewer = replace(INPUT, most_samples=24_000, stretches=6)
    monkeypatch.setattr(stretches, "INPUT", fewer)


def _record(duration: float, *, fast: tuple[float, float] = (0.0, 0.0), pushed: float = -1.0) -> Recording:
    """A joint that swings; faster between two times [s], and pushed for two seconds from another one on."""
    time = np.arange(0.0, duration, 1.0 / _RATE)
    speed = np.where((time >= fast[0]) & (time < fast[1]), 3.0, 1.0)
    phase = np.cumsum(speed) / _RATE
    position = np.sin(1.3 * phase) + 0.4 * np.sin(4.1 * phase)
    velocity = np.gradient(position, time)
    acceleration = np.gradient(velocity, time)
    torque = 0.1 * acceleration + 1.2 * np.sign(velocity) + 0.3 * velocity + 2.0 * np.sin(position)
    torque += 0.02 * np.random.default_rng(1).standard_normal(time.size)
    torque[(time >= pushed) & (time < pushed + 2.0)] += 1.0
    return Recording(time, position, torque)


def _spans(found: list[Stretch]) -> list[tuple[float, float]]:
    return [(float(one.recording.time[0]), float(one.recording.time[-1])) for one in found]


def test_what_is_not_long_is_searched_whole() -> None:
    recording = _record(70.0)
    (found,) = choose_stretches([[recording]])
    assert [one.recording for one in found] == [recording]
    assert found[0].past is None


def test_what_is_too_slow_to_be_simulated_is_searched_whole() -> None:
    recording = _record(400.0)
    slow = recording.rows(slice(None, None, 10))
    (found,) = choose_stretches([[slow]])
    assert [one.recording for one in found] == [slow]


def test_stretches_are_bounded_and_come_from_all_of_the_time() -> None:
    spans = _spans(choose_stretches([[_record(600.0)]])[0])
    assert sum(end - start for start, end in spans) == pytest.approx(60.0, abs=2.0)
    assert spans[0][0] < 150.0
    assert spans[-1][1] > 450.0
    assert max(after[0] - before[1] for before, after in pairwise(spans)) < 220.0


def test_the_stretch_that_moves_otherwise_and_the_one_that_is_pushed_are_searched() -> None:
    spans = _spans(choose_stretches([[_record(600.0, fast=(333.0, 343.0), pushed=517.0)]])[0])
    assert any(start < 343.0 and end > 333.0 for start, end in spans)
    assert any(start <= 518.0 <= end for start, end in spans)


def test_several_recordings_share_what_is_searched() -> None:
    found = choose_stretches([[_record(300.0)], [_record(100.0)]])
    lengths = [sum(end - start for start, end in _spans(one)) for one in found]
    assert lengths[0] == pytest.approx(45.0, abs=8.0)
    assert lengths[1] == pytest.approx(15.0, abs=8.0)


def test_what_is_searched_is_told_and_the_whole_is_kept() -> None:
    recording = _record(600.0)
    usable = take_usable([recording], None)
    assert {one.metadata.extra[PART_OF] for one in usable.recordings} == {0}
    assert sum(map(len, usable.whole)) == len(recording)
    (said,) = usable.remarks
    assert said.startswith("Used: 60")
    assert "stretches from all of its time" in said


def test_a_stretch_is_as_warm_as_the_whole_is_there() -> None:
    recording = _record(600.0)
    power = np.abs(np.gradient(np.asarray(recording.position), 1.0 / _RATE))
    whole = compute_warming(power, 1.0 / _RATE, 100.0)
    cut = slice(40_000, 44_000)
    (known,) = past.build_past([recording], [recording.rows(cut)])
    assert known is not None
    stretch = compute_warming(power[cut], 1.0 / _RATE, 100.0, known.speed, known.begin)
    np.testing.assert_allclose(stretch.rise, whole.rise[cut], rtol=0.02)
    assert stretch.usual == pytest.approx(whole.usual, rel=0.02)
