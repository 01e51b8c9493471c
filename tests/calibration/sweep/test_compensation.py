"""A drive that compensates friction by itself is found out, by what it reports beyond what it was told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration.sweep import (
    Calibration,
    CalibrationOptions,
    CalibrationRequest,
    IdentificationSettings,
    RunFolder,
    SweepContext,
    SweepSettings,
    calibrate,
)
from fricomp.calibration.sweep.report.check import compensation_check
from fricomp.sim_bench.stand_in import SimulatedJointAdapter

SETTINGS = SweepSettings(
    speeds="0.2,0.4,0.8,1.5,2.5", repeats=1, warm_up=0.5, dwell=0.4, breakaway_positions=0, loop="host", inertia=0.1
)


def calibrated(folder: Path, assistance: float) -> Calibration:
    """A sweep over commanded torque on a drive that adds `assistance` [N·m] in the direction of motion."""
    adapter = SimulatedJointAdapter()
    servo = adapter.stand_in.servos[0]
    told = servo.update

    def assisted(encoded: float) -> float:
        torque = told(encoded)
        return torque + assistance * float(np.tanh(servo.estimated_velocity / 0.02)) if servo.enabled else torque

    servo.update = assisted  # type: ignore[method-assign]
    options = CalibrationOptions(IdentificationSettings(method="least_squares"))
    request = CalibrationRequest("sim", settings=SETTINGS, options=options)
    with adapter:
        return calibrate(SweepContext(adapter, 0, SETTINGS), RunFolder.create(folder, request), options)


@pytest.mark.parametrize("assistance", [0.05, 0.1])
def test_torque_that_nobody_asked_for_is_told_with_its_size(tmp_path: Path, assistance: float) -> None:
    analysis = calibrated(tmp_path / "run", assistance).analysis
    assert analysis.assistance is not None
    assert analysis.assistance.value == pytest.approx(assistance, rel=0.03)
    check = compensation_check(analysis)
    assert check is not None
    assert check.outcome == "warning"
    assert "the drive adds" in check.detail
    assert "compensated twice" in check.detail


def test_a_drive_that_does_as_it_is_told_is_not_accused(tmp_path: Path) -> None:
    check = compensation_check(calibrated(tmp_path / "run", 0.0).analysis)
    assert check is not None
    assert check.outcome == "passed"
    assert "nothing added" in check.detail
