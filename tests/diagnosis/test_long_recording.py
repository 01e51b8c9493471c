"""A long recording is answered from stretches of it, and the answer is held against the rest."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fricomp.diagnosis import diagnose
from fricomp.diagnosis.inputs import stretches
from fricomp.diagnosis.inputs.settings import INPUT

from .toy_joint import ToyJoint, recording

pytestmark = pytest.mark.slow


def test_the_answer_is_that_of_all_of_it_within_its_intervals(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stretches, "INPUT", replace(INPUT, most_samples=20_000, stretches=4, shortest_stretch=5.0))
    joint = ToyJoint(quadratic_drag=0.4)
    diagnosis = diagnose(recording(joint, "rich", 60.0, every=2))
    assert [effect.name for effect in diagnosis.effects] == ["quadratic_drag"]
    low, high = diagnosis.effects[0].parameters["coefficient"].ci95
    assert low - 0.02 < joint.quadratic_drag < high + 0.02
    said = " ".join(diagnosis.sentences)
    assert "of a long recording" in said
    assert "s friction.json leaves" in said
    assert any("were searched" in line for line in diagnosis.record.summary)
