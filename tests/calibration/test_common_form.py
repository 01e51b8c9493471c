"""Models whose laws differ in form are compared by what both can tell, at the stated error rate."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.calibration import identify
from fricomp.calibration.common_form import bring_to_form, find_common_form
from fricomp.calibration.comparison import compare_models
from fricomp.calibration.history import read_histories
from fricomp.cli.main import app
from fricomp.errors import ParameterError
from fricomp.laws import Cogging
from fricomp.model import FrictionModel, Provenance, Validity, save_model

SIDE = np.geomspace(0.01, 1.0, 14)
VELOCITY = np.concatenate([-SIDE, SIDE])
FORMS = ("stribeck", "symmetric_stribeck", "asymmetric_coulomb_viscous", "coulomb_viscous")


def identified(law: str, seed: int, *, rise: float = 0.02, coulomb: float = 0.5) -> FrictionModel:
    """A joint whose friction falls by `rise` from rest, by a law that may not hold that [N·m]."""
    level = coulomb + rise * np.exp(-((VELOCITY / 0.05) ** 2)) + 0.2 * np.abs(VELOCITY)
    torque = np.sign(VELOCITY) * level + np.random.default_rng(seed).normal(0.0, 0.01, VELOCITY.size)
    return identify(VELOCITY, torque, law=law, method="least_squares").model


def test_an_unchanged_joint_is_not_called_changed_for_the_form_of_its_law() -> None:
    called = [
        compare_models(identified(old, 10 * i, rise=0.03), identified(new, 10 * i + 1, rise=0.03)).changed
        for i, (old, new) in enumerate([(a, b) for a in FORMS for b in FORMS if a != b] * 3)
    ]
    assert np.mean(called) < 0.14  # 0.05 and three standard errors


@pytest.mark.parametrize("form", FORMS[1:])
def test_friction_that_grew_is_told_whatever_form_each_law_has(form: str) -> None:
    result = compare_models(identified("stribeck", 1, rise=0.1), identified(form, 2, rise=0.1, coulomb=0.7))
    assert result.changed
    assert any(change.name.endswith("coulomb_torque") for change in result.significant)
    assert all(abs(change.difference - 0.2) < 0.04 for change in result.changes if "coulomb" in change.name[-14:])
    assert (result.added, result.removed) == ((), ())


def test_a_curve_of_the_common_form_keeps_its_parameters_and_their_covariance() -> None:
    flat, bent = identified("coulomb_viscous", 3), identified("stribeck", 4)
    form = find_common_form((flat, bent))
    assert form is not None
    assert bring_to_form((flat, bent), form)[0] == flat


def test_what_depends_on_the_speeds_of_the_motion_counts_as_unknown() -> None:
    flat, sharp, soft = identified("coulomb_viscous", 5), *(identified("stribeck", 6, rise=rise) for rise in (0.3, 0.0))
    form = find_common_form((flat, sharp))
    assert form is not None
    sharp, soft = (bring_to_form((flat, one), form)[1] for one in (sharp, soft))
    assert sharp.covariance is not None
    assert soft.covariance is not None
    wide, narrow = (one.standard_deviations()["coulomb.coulomb_torque"] for one in (sharp.covariance, soft.covariance))
    assert wide > 3.0 * narrow


def test_laws_that_hold_over_no_common_speed_or_ask_for_more_than_it_are_refused() -> None:
    one, other = identified("stribeck", 7), identified("coulomb_viscous", 8)
    with pytest.raises(ParameterError, match="do not overlap"):
        compare_models(one, replace(other, validity=Validity(velocity=(2.0, 3.0))))
    more = replace(other, law=other.law.with_term(Cogging(0.1, 4.0, 0.0)))
    with pytest.raises(ParameterError, match="share no identified parameter"):
        compare_models(one, more)


def test_commands_say_as_what_curves_were_compared_and_follow_them(tmp_path: Path) -> None:
    for day, form in enumerate(("stribeck", "coulomb_viscous", "symmetric_stribeck"), 1):
        made = Provenance(created=f"2026-03-0{day}T12:00:00")
        (tmp_path / form).mkdir()
        save_model(replace(identified(form, day), provenance=made), tmp_path / form / "friction.json")
    files = [str(tmp_path / form / "friction.json") for form in ("stribeck", "coulomb_viscous")]
    said = CliRunner().invoke(app, ["compare", *files], env={"COLUMNS": "300"}).output
    assert "both curves are compared as straight lines of both directions" in said
    (history,), _ = read_histories(tmp_path)
    assert history.refusals == ("", "")
    assert [trend.name for trend in history.trends] == ["coulomb.coulomb_torque", "viscous.viscous_coefficient"]


def test_models_in_other_units_are_followed_apart(tmp_path: Path) -> None:
    for day, unit in enumerate(("A", "N·m", "A", "N·m"), 1):
        made = Provenance(created=f"2026-03-0{day}T12:00:00")
        folder = tmp_path / f"{day}"
        folder.mkdir()
        save_model(replace(identified("stribeck", day), provenance=made, torque_unit=unit), folder / "friction.json")
    histories, _ = read_histories(tmp_path)
    assert [history.title for history in histories] == ["joint, A", "joint, N·m"]
    assert all(history.refusals == ("",) and len(history.models) == 2 for history in histories)
    assert {trend.unit for trend in histories[0].trends} <= {"A", "A·s/rad", "rad/s"}
