"""What a model leaves of a joint's torque: noise is not taken for something that pulls."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.confirmation import ConfirmedData, HeldOutErrors
from fricomp.arm.coordinates import ArmModel
from fricomp.arm.equations import build_equations
from fricomp.arm.examination import match_recordings
from fricomp.arm.prior import ArmPrior
from fricomp.arm.robust_fit import fit_robustly
from fricomp.arm.rows import build_rows
from fricomp.laws import FloatArray

from .moving_arm import Friction, record_arm, write_arm


def _measure(folder: Path, more: Friction | None, cutoff: float) -> HeldOutErrors:
    simulation, prior = write_arm(folder), ArmPrior()
    arm, recording = match_recordings(record_arm(simulation, more, noise=0.8), simulation)
    rows = build_rows(arm, recording, cutoff)
    bare = build_equations(arm, rows, rows.links @ arm.inertia.ravel())
    fit, equations = fit_robustly(arm, rows, bare, ArmModel.build_plain(3), prior)
    return ConfirmedData(arm, equations, prior, rows).measure_errors(fit)


@pytest.mark.parametrize("cutoff", [1.25, 10.0])
def test_noise_of_a_torque_does_not_last(tmp_path: Path, cutoff: float) -> None:
    errors = _measure(tmp_path, None, cutoff)
    assert np.all(errors.means[-1] > 0.05)  # more than a tenth of the wrist's friction of 0.4 N·m
    assert np.all(errors.lasting < 0.03)


def test_what_pulls_for_a_while_lasts(tmp_path: Path) -> None:
    def pull(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
        return np.asarray(0.3 * np.sin(np.arange(q.size) * 2.0 * np.pi * 0.37 / 250.0) * (joint == 2))

    errors = _measure(tmp_path, pull, 10.0)
    assert errors.lasting[2] == pytest.approx(0.3 / np.sqrt(2.0), rel=0.2)
    assert np.all(errors.lasting[:2] < 0.06)
