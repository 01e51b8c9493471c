"""A simulation known by its own recording: what is told where that was not made under the same commands."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Recording
from fricomp.sim_bench.diagnosis.diagnose import with_remarks
from fricomp.sim_bench.diagnosis.result import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord
from fricomp.sim_bench.diagnosis.simulated import motion_remarks
from fricomp.sim_bench.diagnosis.track import FloatArray

_TIME = np.arange(20_000, dtype=np.float64) * np.float64(1e-3)


def _moved(position: FloatArray, duration: float = 20.0) -> Recording:
    kept = duration > _TIME
    return Recording(_TIME[kept], position[kept], np.zeros(int(kept.sum())))


_WAVE = np.sin(3.0 * _TIME)


@pytest.mark.parametrize("tracking", [0.0, 0.05])
def test_the_same_motion_is_not_remarked(tracking: float) -> None:
    assert motion_remarks([_moved(_WAVE)], _moved(np.sin(3.0 * _TIME - tracking))) == ()


def test_a_shorter_one_and_another_motion_are_told() -> None:
    (shorter,) = motion_remarks([_moved(_WAVE)], _moved(_WAVE, 9.0))
    assert "lasts 9 s and the recording 20 s" in shorter
    (other,) = motion_remarks([_moved(_WAVE)], _moved(np.sin(2.0 * _TIME + 1.0)))
    assert "another motion" in other
    assert motion_remarks([_moved(np.cos(2.0 * _TIME)), _moved(_WAVE)], _moved(_WAVE)) == ()


def test_remarks_come_last() -> None:
    record = DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict="consistent", sentences=("first",))
    assert with_remarks(Diagnosis(record), ("last",)).sentences == ("first", "last")
