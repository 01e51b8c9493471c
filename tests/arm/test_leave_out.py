"""What a model leaves of rows held out of its fit does not hang on where that fit began."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fricomp.arm.confirmation import ConfirmedData
from fricomp.arm.coordinates import ArmModel
from fricomp.arm.equations import build_equations
from fricomp.arm.examination import match_recordings
from fricomp.arm.fit import fit_arm
from fricomp.arm.prior import ArmPrior
from fricomp.arm.rows import build_rows

from .moving_arm import record_arm, write_arm


def test_links_that_may_be_far_off_have_arrived_before_what_they_leave_is_compared(tmp_path: Path) -> None:
    simulation, prior = write_arm(tmp_path, (1.0, 2.5, 6.0)), ArmPrior()
    arm, recording = match_recordings(record_arm(write_arm(tmp_path), duration=12.0, noise=1e-5), str(simulation))
    rows = build_rows(arm, recording, 10.0)
    equations = build_equations(arm, rows, rows.links @ arm.inertia.ravel())
    near = fit_arm(arm, equations, ArmModel.build_plain(3), prior)
    far = replace(near.model, opened=frozenset(range(3)))
    there = fit_arm(arm, equations, far, prior, near, steps=300)
    data = ConfirmedData(arm, equations, prior, rows)
    begun, arrived = (data.measure_model(far, start)[0] for start in (near, there))
    assert begun == pytest.approx(arrived, rel=3e-3)
