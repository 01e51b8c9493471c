"""`fricomp.diagnose`: recordings or their files, checked as the command checks them; the answer shows itself."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import fricomp
from fricomp import extras
from fricomp.diagnosis import (
    DIAGNOSIS_SCHEMA,
    Change,
    Diagnosis,
    DiagnosisRecord,
    Evidence,
    NamedEffect,
    Quantity,
    RowSeries,
    load_diagnosis,
)
from fricomp.errors import DiagnosisError, MissingExtraError, OutputError

TIME = np.arange(0.0, 8.0, 2e-3)


def _still(seconds: float = 8.0) -> fricomp.Recording:
    """A joint that never moves: no joint to diagnose, said at once."""
    time = TIME[seconds > TIME]
    return fricomp.Recording(time, np.zeros(time.size), np.sin(time)).with_metadata(joint="elbow")


def test_a_recording_and_its_file_give_the_same_answer(tmp_path: Path) -> None:
    fricomp.write_recording(_still(), tmp_path / "still.csv")
    from_memory, from_file = fricomp.diagnose(_still()), fricomp.diagnose([tmp_path / "still.csv"])
    assert from_memory.verdict == from_file.verdict == "bad_data"
    assert from_memory.sentences == from_file.sentences
    assert from_file.record.recordings == ("still",)


def test_it_is_written_where_wanted_and_not_written_over(tmp_path: Path) -> None:
    out = tmp_path / "why"
    fricomp.diagnose(_still(), out=out)
    assert load_diagnosis(out / "diagnosis.json").verdict == "bad_data"
    assert (out / "report.html").exists()
    with pytest.raises(OutputError, match="overwrite"):
        fricomp.diagnose(_still(), out=out)
    fricomp.diagnose(_still(), out=out, overwrite=True)


def test_what_cannot_be_diagnosed_is_refused_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(DiagnosisError, match=r"joint 'elbow' lasts 3 s, and a diagnosis needs at least 5 s"):
        fricomp.diagnose(_still(3.0))
    with pytest.raises(DiagnosisError, match="simulated is the simulation: leave out simulation and friction"):
        fricomp.diagnose(_still(), tmp_path / "joint.xml", simulated=_still())


def test_a_package_that_is_missing_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda name: None if name == "ruptures" else find_spec(name))
    with pytest.raises(MissingExtraError, match=r"ruptures .*pip install '\.\[diagnose\]'"):
        fricomp.diagnose(_still())


@pytest.fixture
def diagnosis() -> Diagnosis:
    order = Quantity(100.0, "1/rad", (99.9, 100.1))
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict="missing_physics",
        sentences=("The simulation leaves out physics.",),
        effects=(NamedEffect(name="cogging", kind="physics", parameters={"order": order}),),
        changes=(Change(name="inertia", given=0.1, refitted=Quantity(0.12, "kg·m²", (0.11, 0.13))),),
        joint="elbow",
    )
    wave = np.sin(TIME)
    rows = RowSeries("one", *(TIME,) * 6, None, wave, 0.1 * wave, np.full(TIME.size, 0.05))
    return Diagnosis(record, Evidence(series=(rows,)))


def test_a_diagnosis_shows_itself(diagnosis: Diagnosis) -> None:
    assert repr(diagnosis) == "<Diagnosis of joint elbow: missing_physics (cogging)>"
    text = diagnosis.summary()
    assert "cogging  order      100    99.9 to 100.1  1/rad" in text
    assert "inertia                      0.1    0.12      kg·m²" in text
    assert "The simulation leaves out physics." in text
    assert "<td>cogging</td>" in diagnosis._repr_html_()
    (axes,) = diagnosis.plot().axes
    assert axes.get_xlabel() == "time [s]"
    with pytest.raises(DiagnosisError, match="number 1 was asked for"):
        diagnosis.plot(1)
