"""An exported MJCF is what MuJoCo can hold of a law, and the best of the ways by simulation."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricomp.errors import ExportError
from fricomp.evaluation import evaluate, fit_mjcf, read_motion
from fricomp.export import apply_to_mjcf, export_mjcf
from fricomp.laws import BidirectionalStribeck, FrictionLaw, LoadCoulomb, StribeckCurve
from fricomp.model import FrictionModel, JointDynamics
from fricomp.recording import Recording

from .made_joint import FORWARD, GRAVITY, INERTIA, LOAD, REVERSE, make_joint

CURVES = StribeckCurve(**FORWARD), StribeckCurve(**REVERSE)
DYNAMICS = JointDynamics(INERTIA, *GRAVITY)


@pytest.mark.slow
@pytest.mark.parametrize("loaded", [False, True])
def test_the_written_file_moves_far_more_like_the_joint_than_the_plain_export(loaded: bool, tmp_path: Path) -> None:
    made = make_joint("load" if loaded else "null")
    recording = Recording(made.time, made.position, made.torque)
    more = (LoadCoulomb(LOAD),) if loaded else ()
    model = FrictionModel(FrictionLaw((BidirectionalStribeck(*CURVES), *more)), dynamics=DYNAMICS)
    fit = fit_mjcf(model, read_motion(recording))
    (tmp_path / "fit.xml").write_text(fit.text)
    (tmp_path / "plain.xml").write_text(apply_to_mjcf(export_mjcf(model), fit.text, "joint"))
    fitted, plain = (evaluate(tmp_path / name, recording) for name in ("fit.xml", "plain.xml"))
    assert fitted.position[0].median < 0.6 * plain.position[0].median
    if not loaded:
        assert fitted.position[0].median < 4.0 * evaluate(model, recording).position[0].median
    assert "friction.json by" in fit.describe()
    assert ("load_coulomb" in fit.describe()) is loaded


def test_a_model_without_a_body_is_not_fitted() -> None:
    made = make_joint("null", duration=6.0)
    motion = read_motion(Recording(made.time, made.position, made.torque))
    with pytest.raises(ExportError, match=r"give it its dynamics"):
        fit_mjcf(FrictionModel(FrictionLaw((BidirectionalStribeck(*CURVES),))), motion)
