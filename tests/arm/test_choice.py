"""Which links are written, and that a joint which the files make no better is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace as change

from fricomp.arm import ArmExamination, examine_arm
from fricomp.arm.law_fit import fit_within_law
from fricomp.arm.output import best_gain, choice
from fricomp.arm.output.best_gain import find_best_gain
from fricomp.arm.output.choice import WrittenFiles, add_file_errors, prepare_files
from fricomp.arm.record import ArmRecord, FileErrors, JointEffect, PositionErrors
from fricomp.arm.rigid.inertia import N_INERTIA

from .moving_arm import record_arm, write_arm


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> tuple[ArmExamination, Path]:
    simulation = write_arm(tmp_path_factory.mktemp("plain"))
    return examine_arm(record_arm(simulation, duration=20.0), simulation), simulation


@pytest.mark.slow
def test_links_nearer_the_simulation_are_written_where_they_go_less_wrong(
    plain: tuple[ArmExamination, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    examination, simulation = plain
    scores = iter([1.0, 0.1])  # as found, and nearer the simulation
    monkeypatch.setattr(choice, "_score", lambda *_: next(scores))
    written = prepare_files(examination.answer, simulation)
    away, found = (
        float(np.abs(one.identification.fit.x[: 3 * N_INERTIA]).max()) for one in (written.answer, examination.answer)
    )
    assert written.notes
    assert away < found
    assert set(written.errors) == {"shoulder", "elbow", "wrist"}


def test_the_best_gain_is_that_on_what_the_files_hold(
    plain: tuple[ArmExamination, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = plain[0].answer.identification
    every = np.ones(len(found.rows), dtype=bool)
    whole = find_best_gain(found, 1, every)
    held = {name: 2.0 * value for name, value in fit_within_law(found, 1).items()}
    monkeypatch.setattr(best_gain, "fit_within_law", lambda *_: held)
    half = find_best_gain(found, 1, every)
    assert whole is not None
    assert half is not None
    assert whole.value == pytest.approx(1.0, abs=0.01)
    assert half.value == pytest.approx(0.5 * whole.value)
    assert whole.ci95[0] < whole.value < whole.ci95[1]


def test_a_joint_that_the_files_make_no_better_is_told(plain: tuple[ArmExamination, Path]) -> None:
    examination, _ = plain
    worse = FileErrors(
        torque_simulation=0.1,
        torque_fit=0.2,
        torque=0.2,
        band=5.0,
        positions=(PositionErrors(after=0.5, simulation=0.01, files=0.02, travel=0.1, unit="rad"),),
    )
    record = add_file_errors(examination.record, WrittenFiles(examination.answer, {"wrist": worse}))
    (said,) = (line for line in record.sentences if line.startswith("wrist: the files are no better"))
    assert "in torque (0.1 to 0.2 N·m) and simulated for 0.5 s (10 to 20 mrad)" in said
    assert "files are no better" in record.summary[-1]
    assert "wrist in torque" in record.summary[-1]
    assert not any(line.startswith("shoulder: the files are no better") for line in record.sentences)


def _write_equal(examination: ArmExamination, joint: str) -> ArmRecord:
    """The record with files of a joint that err by hardly more than its simulation."""
    equal = FileErrors(
        torque_simulation=0.1,
        torque_fit=0.1,
        torque=0.1001,
        band=5.0,
        positions=(PositionErrors(after=0.5, simulation=0.01, files=0.0101, travel=0.5, unit="rad"),),
    )
    return add_file_errors(examination.record, WrittenFiles(examination.answer, {joint: equal}))


def test_files_that_differ_by_chance_are_told_only_where_something_is_named(
    plain: tuple[ArmExamination, Path],
) -> None:
    examination, _ = plain
    assert "files are no better" not in _write_equal(examination, "wrist").summary[-1]
    joints = examination.record.joints
    effect = JointEffect(
        name="cogging", parameters={}, recurrence=1.0, log_bayes_factor=9.0, fall=0.5, equation="A sin(n q + phi)"
    )
    named = (*joints[:-1], change(joints[-1], effects=(effect,)))
    examined = replace(examination, record=change(examination.record, joints=named))
    assert "wrist in torque" in _write_equal(examined, "wrist").summary[-1]
