"""A changed joint is told from an unchanged one, at the stated error rate."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.calibration import identify
from fricomp.calibration.comparison import compare_models
from fricomp.calibration.normal_load import at_normal_load
from fricomp.cli.main import app
from fricomp.errors import ParameterError
from fricomp.laws import BidirectionalStribeck, Coulomb, FrictionLaw, StribeckCurve
from fricomp.model import Covariance, FrictionModel, Provenance, Validity, save_model

TRUTH = np.array([0.15, 0.60, 0.05, 0.02, 0.20, 0.70, 0.05, 0.03])
KEYS = ("coulomb_torque", "static_torque", "stribeck_velocity", "viscous_coefficient")
NAMES = tuple(f"stribeck.{side}.{key}" for side in ("forward", "reverse") for key in KEYS)
MIX = np.eye(8) + 0.3 * np.eye(8, k=1)
SPREAD = (0.01 * np.diag(TRUTH)) @ MIX
COVARIANCE = SPREAD @ SPREAD.T


def model(values: np.ndarray) -> FrictionModel:
    law = FrictionLaw((BidirectionalStribeck(StribeckCurve(*values[:4]), StribeckCurve(*values[4:])),))
    return FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0)), covariance=Covariance(NAMES, COVARIANCE))


def draw(rng: np.random.Generator, truth: np.ndarray = TRUTH) -> FrictionModel:
    return model(truth + SPREAD @ rng.standard_normal(8))


@pytest.mark.slow
def test_an_unchanged_joint_is_called_changed_at_the_stated_rate() -> None:
    rng = np.random.default_rng(1)
    called = [compare_models(draw(rng), draw(rng)) for _ in range(1000)]
    assert 0.03 < np.mean([c.changed for c in called]) < 0.07
    assert np.mean([bool(c.significant) for c in called]) < 0.065  # Holm keeps the family-wise rate


@pytest.mark.slow
@pytest.mark.parametrize("speeds", [6, 8])
def test_short_sweeps_of_an_unchanged_joint_are_called_changed_at_the_stated_rate(speeds: int) -> None:
    side = np.geomspace(0.01, 1.0, speeds)
    velocity = np.concatenate([-side, side])
    exact = np.asarray(model(TRUTH).torque(velocity))
    rng = np.random.default_rng([3, speeds])
    called = []
    for _ in range(60):
        pair = [identify(velocity, exact + rng.normal(0.0, 0.01, velocity.size), method="least_squares") for _ in "ab"]
        called.append(compare_models(pair[0].model, pair[1].model))
    assert np.mean([c.changed for c in called]) < 0.12  # 0.05 and three standard errors
    assert np.mean([bool(c.significant) for c in called]) < 0.12


@pytest.mark.parametrize("level", [0.0, 0.02])
def test_an_offset_that_was_taken_off_one_model_alone_is_no_change(level: float) -> None:
    notes = ("0.01 +- 2e-05", "0 assumed: it cannot be told")
    swept, logged = (Provenance(method="pinn", notes={"torque_offset": note}) for note in notes)
    shift = 0.1 * np.array([1, 1, 0, 0, -1, -1, 0, 0]) + level * np.array([1, 0, 0, 0, 1, 0, 0, 0])
    old, new = replace(model(TRUTH), provenance=swept), replace(model(TRUTH + shift), provenance=logged)
    assert compare_models(old, new).changed is (level > 0.0)
    assert compare_models(old, replace(new, provenance=swept)).changed


def test_the_parameter_that_changed_is_named() -> None:
    rng = np.random.default_rng(2)
    worn = TRUTH.copy()
    worn[4] *= 1.25
    result = compare_models(draw(rng), draw(rng, worn))
    assert result.changed
    assert result.changes[0].name == "stribeck.reverse.coulomb_torque"
    assert result.changes[0].difference == pytest.approx(0.05, abs=0.01)
    assert result.at_velocity < 0.0
    assert result.largest_torque_change == pytest.approx(-0.05, abs=0.02)


def test_terms_that_came_or_went_are_a_change() -> None:
    one = model(TRUTH)
    other = replace(one, law=one.law.with_term(Coulomb(0.1)))
    result = compare_models(one, other)
    assert (result.changed, result.added, result.removed) == (True, ("coulomb",), ())


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (replace(model(TRUTH), torque_unit="A"), "cannot be compared"),
        (replace(model(TRUTH), covariance=None), "new model has no covariance"),
        (replace(model(TRUTH), validity=Validity(velocity=(2.0, 3.0))), "do not overlap"),
    ],
)
def test_models_that_cannot_be_compared_say_why(other: FrictionModel, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        compare_models(model(TRUTH), other)


def test_a_model_of_a_diagnosis_is_refused_with_what_to_do() -> None:
    diagnosed = replace(model(TRUTH), covariance=None, provenance=Provenance(method="diagnosis"))
    with pytest.raises(ParameterError, match=r"diagnosis, which writes no covariance.*fricomp identify or fricomp cal"):
        compare_models(diagnosed, diagnosed)


def test_the_command_says_what_changed(tmp_path: Path) -> None:
    worn = TRUTH.copy()
    worn[0] *= 1.5
    save_model(model(TRUTH), tmp_path / "old.json")
    save_model(model(worn), tmp_path / "new.json")
    result = CliRunner().invoke(app, ["compare", str(tmp_path / "old.json"), str(tmp_path / "new.json")])
    assert result.exit_code == 0, result.output
    assert "The joint has changed" in result.output
    assert "stribeck.forward.coulomb_torque" in result.output.split("changed")[-1].replace("\n", "")


def test_the_command_warns_of_unusable_models_and_of_two_joints(tmp_path: Path) -> None:
    vague = replace(model(TRUTH), joint="knee", provenance=Provenance(status="not_identifiable", message="too fast"))
    save_model(replace(model(TRUTH), joint="elbow"), tmp_path / "old.json")
    save_model(vague, tmp_path / "new.json")
    call = ["compare", str(tmp_path / "old.json"), str(tmp_path / "new.json")]
    said = CliRunner().invoke(app, call, env={"COLUMNS": "300"}).output
    assert "Careful: the new model is not usable (not_identifiable: too fast)." in said
    assert "Careful: the old model is of joint 'elbow', the new one of 'knee'." in said
    assert "Careful" not in CliRunner().invoke(app, [*call[:2], call[1]]).output


def test_the_names_of_parameters_are_whole_on_a_narrow_screen(tmp_path: Path) -> None:
    save_model(model(TRUTH), tmp_path / "old.json")
    call = ["compare", str(tmp_path / "old.json"), str(tmp_path / "old.json")]
    assert "…" not in CliRunner().invoke(app, call, env={"COLUMNS": "80"}).output


def test_models_at_two_loads_are_compared_at_one() -> None:
    one = replace(at_load(model(TRUTH), 2.0, 1.0), validity=Validity(velocity=(-1.0, 1.0), normal_load=(1.0, 3.0)))
    other = at_normal_load(one, 5.0)
    other = replace(other, validity=replace(other.validity, normal_load=(4.0, 6.0)))
    result = compare_models(one, other)
    assert (result.normal_load, result.load_known) == (2.0, (True, True))
    assert max(abs(change.difference) for change in result.changes) < 1e-12
    assert abs(result.largest_torque_change) < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("sensitivity", [0.4, 1.0, 1.3])
def test_a_model_brought_to_another_load_is_the_same_model(sensitivity: float) -> None:
    names = (*NAMES, "stribeck.load.load_sensitivity")
    before = replace(at_load(model(TRUTH), 2.0, sensitivity), covariance=None)
    spread = np.diag([*(0.01 * TRUTH), 0.03])
    before = replace(before, covariance=Covariance(names, spread @ spread))
    after = at_normal_load(before, 5.0)
    velocity, load = np.linspace(-1.0, 1.0, 21), np.linspace(1.0, 8.0, 21)
    np.testing.assert_allclose(
        np.asarray(after.torque(velocity, normal_load=load)),
        np.asarray(before.torque(velocity, normal_load=load)),
        rtol=1e-12,
    )
    draws = np.random.default_rng(4).multivariate_normal([*TRUTH, sensitivity], spread @ spread, size=4000)
    moved = []
    for values in draws:
        drawn = replace(before, law=before.law.replace(dict(zip(names, values.tolist(), strict=True))), covariance=None)
        brought = at_normal_load(drawn, 5.0).law.parameters()
        moved.append([brought[name] for name in names])
    assert after.covariance is not None
    np.testing.assert_allclose(np.sqrt(np.diag(after.covariance.matrix)), np.std(moved, axis=0), rtol=0.06)


def test_a_load_without_dry_friction_is_refused() -> None:
    with pytest.raises(ParameterError, match="no dry friction left"):
        at_normal_load(at_load(model(TRUTH), 2.0, 3.0), 1.0)


def at_load(friction: FrictionModel, reference: float, sensitivity: float) -> FrictionModel:
    load = {"stribeck.load.reference_load": reference, "stribeck.load.load_sensitivity": sensitivity}
    return replace(friction, law=friction.law.replace(load))
