"""A drive that follows its command late shows in command and torque alone, whatever the joint pushes against."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.evidence.effect_evidence import EffectEvidence
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.samples.drive_path import find_drive_path
from fricomp.diagnosis.samples.second_look import look_into_samples
from fricomp.diagnosis.verdict.judging import judge
from fricomp.diagnosis.verdict.writing import write_diagnosis
from fricomp.recording import Recording

from ..known import known_baseline, known_case, known_findings

_DT = 2e-3


def _command() -> FloatArray:
    """A torque that changes without end, as that of a leg that walks."""
    kicks = np.random.default_rng(0).standard_normal(6000)
    return np.asarray(lfilter([1.0], [1.0, -1.9, 0.905], kicks), dtype=np.float64)


def _follow(torque: FloatArray, command: FloatArray) -> Recording:
    time = np.arange(torque.size, dtype=np.float64) * np.float64(_DT)
    noise = 0.02 * np.std(torque) * np.random.default_rng(1).standard_normal(torque.size)
    return Recording(time, 0.3 * np.sin(2.0 * time), torque + noise, torque_command=command)


def _lag(command: FloatArray, constant: float) -> FloatArray:
    keep = float(np.exp(-_DT / constant))
    return np.asarray(lfilter([1.0 - keep], [1.0, -keep], command), dtype=np.float64)


def test_a_lag_is_told_from_a_delay_with_its_time_constant() -> None:
    command = _command()
    found = find_drive_path(_follow(_lag(command, 0.012), command))
    assert found is not None
    assert found.name == "drive_lag"
    assert found.value == pytest.approx(0.012, abs=1.5e-3)
    assert found.errors["drive_lag"] < 0.5 * found.errors["law"]


def test_a_delay_is_told_from_a_lag() -> None:
    command = _command()
    found = find_drive_path(_follow(np.roll(command, 5), command))
    assert found is not None
    assert found.name == "torque_delay"
    assert found.value == pytest.approx(5 * _DT, abs=1.5e-3)


def test_a_prompt_drive_and_one_whose_command_is_unknown_are_not_late() -> None:
    command = _command()
    assert find_drive_path(_follow(command, command)) is None
    assert find_drive_path(_follow(np.random.default_rng(3).standard_normal(command.size), command)) is None
    late = _follow(_lag(command, 0.012), command)
    assert find_drive_path(Recording(late.time, late.position, late.torque)) is None


def test_a_joint_that_obeys_no_law_of_its_own_motion_is_judged_by_its_drive_alone() -> None:
    command, baseline = _command(), known_baseline()
    late = _follow(_lag(command, 0.012), command)
    named = EffectEvidence(EFFECTS["cogging"], {}, 1.0, {}, ())
    held = known_findings(baseline).held
    lawless = known_findings(
        baseline,
        known_case(baseline, recordings=(late,)),
        effects=(named,),
        held=type(held)(float(np.std(late.torque)), 1.0, 1.0, (0.0, 0.0), 0.0),
    )
    verdict = judge(lawless, look_into_samples(lawless))
    assert (verdict.word, [one.name for one in verdict.effects]) == ("measurement", ["drive_lag"])
    diagnosis = write_diagnosis(lawless, verdict, None)
    assert diagnosis.sentences[0].endswith("its friction cannot be judged here.")
    assert diagnosis.record.base == {}
    assert diagnosis.base_model is None
    assert diagnosis.record.rivals[0].effects == ("drive_lag",)
