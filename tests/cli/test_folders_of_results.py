"""Commands that take a model take the folder that holds it, and what the model knows is not asked for again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from fricomp.cli.main import app
from fricomp.errors import ModelFileError, ParameterError
from fricomp.laws import Coulomb, FrictionLaw, Viscous
from fricomp.model import Covariance, FrictionModel, JointDynamics, Provenance, load_model, save_model

NAMES = ("coulomb.coulomb_torque", "viscous.viscous_coefficient")


def _call(*arguments: object) -> Result:
    return CliRunner().invoke(app, [*map(str, arguments)], env={"COLUMNS": "200"})


def _write(folder: Path, coulomb: float, dynamics: JointDynamics | None = None) -> Path:
    folder.mkdir(parents=True)
    model = FrictionModel(
        FrictionLaw((Coulomb(coulomb), Viscous(0.15))),
        provenance=Provenance(method="identify", created=f"2026-03-0{len(list(folder.parent.iterdir()))}T10:00:00Z"),
        covariance=Covariance(NAMES, np.diag([1e-8, 1e-8])),
        dynamics=dynamics,
    )
    save_model(model, folder / "friction.json")
    return folder


def test_a_model_is_loaded_from_its_folder(tmp_path: Path) -> None:
    assert load_model(_write(tmp_path / "elbow", 0.4)) == load_model(tmp_path / "elbow" / "friction.json")
    with pytest.raises(ModelFileError, match=r"friction\.json"):
        load_model(tmp_path)


@pytest.mark.parametrize(("coulomb", "said"), [(0.44, "has changed (p < 1e-16)"), (0.4, "No change: p = 1")])
def test_folders_are_compared(coulomb: float, said: str, tmp_path: Path) -> None:
    done = _call("compare", _write(tmp_path / "a", 0.4), _write(tmp_path / "b", coulomb))
    assert done.exit_code == 0, done.output
    assert said in done.output


def test_a_loop_is_checked_with_the_inertia_of_the_model(tmp_path: Path) -> None:
    known = _write(tmp_path / "known", 0.4, JointDynamics(0.03))
    given = _call("check-loop", known, "--bandwidth", 5, "--inertia", 0.03, "--json")
    taken = _call("check-loop", known, "--bandwidth", 5, "--json")
    assert given.exit_code == taken.exit_code == 0, taken.output
    assert taken.stdout == given.stdout
    refused = _call("check-loop", _write(tmp_path / "unknown", 0.4), "--bandwidth", 5).exception
    assert isinstance(refused, ParameterError)
    assert "--inertia" in str(refused)


def test_a_recording_in_the_place_of_the_model_is_told_the_order(tmp_path: Path) -> None:
    refused = _call("evaluate", tmp_path / "log.csv", tmp_path / "elbow").exception
    assert isinstance(refused, ParameterError)
    assert f"'fricomp evaluate {tmp_path / 'elbow'} {tmp_path / 'log.csv'}'" in str(refused)


def test_changes_are_told_with_both_numbers(tmp_path: Path) -> None:
    for name, coulomb in (("a", 0.4), ("b", 0.4), ("c", 0.5)):
        _write(tmp_path / name, coulomb)
    done = _call("watch", tmp_path)
    assert "coulomb_torque 0.4 → 0.5 N·m" in done.output
    assert "within an hour" not in done.output
