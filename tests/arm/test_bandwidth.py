"""The band that is compared: it is chosen once more when what was missing is known."""

from __future__ import annotations

from pathlib import Path

from fricomp.arm.bandwidth import raise_cutoff
from fricomp.arm.coordinates import ArmModel
from fricomp.arm.equations import build_equations
from fricomp.arm.examination import match_recordings
from fricomp.arm.friction import JointForm
from fricomp.arm.prior import ArmPrior
from fricomp.arm.robust_fit import fit_robustly
from fricomp.arm.rows import build_rows

from .moving_arm import record_arm, write_arm
from .test_examination import follow_load


def test_a_wider_band_is_taken_where_what_was_found_leaves_far_less(tmp_path: Path) -> None:
    simulation, prior = write_arm(tmp_path), ArmPrior()
    arm, recording = match_recordings(record_arm(simulation, follow_load, duration=15.0, rate=100.0), simulation)
    model = ArmModel((JointForm().with_term("load_coulomb", 0), JointForm(), JointForm()))
    rows = build_rows(arm, recording, 1.25)
    bare = build_equations(arm, rows, rows.links @ arm.inertia.ravel())
    fit, equations = fit_robustly(arm, rows, bare, model, prior)
    noise = equations.weights.noise
    assert raise_cutoff(rows, equations, fit, recording, prior, noise) is None
    higher = raise_cutoff(rows, equations, fit, recording, prior, 3.0 * noise)
    assert higher is not None
    assert higher[0].cutoff > 5.0
