"""Answers for programs: one JSON value on stdout, exit statuses that can be asked for."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from fricomp.cli.main import app
from fricomp.cli.output import print_json
from fricomp.diagnosis import DIAGNOSIS_SCHEMA, DiagnosisRecord
from fricomp.diagnosis.report import build_fleet_row
from fricomp.errors import FricompError
from fricomp.fleet import FleetJoint, FleetRow, Severity, rate_row
from fricomp.laws import Coulomb, FrictionLaw, Viscous
from fricomp.model import Covariance, FrictionModel, Validity, save_model

VERDICTS = {"elbow": "consistent", "knee": "bad_data", "hip": "missing_physics", "wrist": "parameters"}


def call(*arguments: object) -> Result:
    return CliRunner().invoke(app, [*map(str, arguments)], env={"COLUMNS": "80"})


def write_model(path: Path, coulomb: float) -> Path:
    names = ("coulomb.coulomb_torque", "viscous.viscous_coefficient")
    model = FrictionModel(
        FrictionLaw((Coulomb(coulomb), Viscous(0.1))),
        joint="elbow",
        validity=Validity(velocity=(-1.0, 1.0)),
        covariance=Covariance(names, np.diag([1e-6, 1e-6]), 1000),
    )
    save_model(model, path)
    return path


def test_a_number_that_is_not_finite_is_null(capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"a": float("inf"), "b": np.float64(0.5), "c": np.arange(2), "d": Path("x")})
    assert json.loads(capsys.readouterr().out) == {"a": None, "b": 0.5, "c": [0, 1], "d": "x"}


def test_compare_answers_in_json_and_fails_where_the_joint_has_changed(tmp_path: Path) -> None:
    old, new = write_model(tmp_path / "old.json", 0.3), write_model(tmp_path / "new.json", 0.4)
    same = call("compare", old, old, "--fail-if-changed", "--json")
    assert same.exit_code == 0, same.output
    assert json.loads(same.stdout)["changed"] is False
    changed = call("compare", old, new, "--fail-if-changed", "--json")
    assert changed.exit_code == 1
    answer = json.loads(changed.stdout)
    assert answer["changed"] is True
    assert answer["changes"][0]["new"] - answer["changes"][0]["old"] == pytest.approx(0.1)
    assert call("compare", old, new).exit_code == 0


def test_cases_list_their_effects_as_json() -> None:
    answer = json.loads(call("cases", "list", "--json").stdout)
    assert "lugre" in answer["effects"]["presliding_hysteresis"]["forms"]


def test_a_table_of_points_is_identified_into_json(tmp_path: Path) -> None:
    velocity = np.concatenate([-np.linspace(0.05, 2.0, 60), np.linspace(0.05, 2.0, 60)])
    torque = 0.3 * np.sign(velocity) + 0.1 * velocity + 1e-3 * np.random.default_rng(5).standard_normal(120)
    table = tmp_path / "points.csv"
    np.savetxt(table, np.column_stack([velocity, torque]), delimiter=",", header="velocity,torque", comments="")
    done = call(
        "identify", table, "--law", "coulomb_viscous", "--method", "least_squares", "--out", tmp_path / "o", "--json"
    )
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    assert answer["usable"] is True
    found = {name.rpartition(".")[2]: each["value"] for name, each in answer["parameters"].items()}
    assert found["coulomb_torque"] == pytest.approx(0.3, abs=2e-3)
    assert all(Path(path).exists() for path in answer["files"])


@pytest.fixture
def fleet(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A folder of recordings that are diagnosed at once, by their names."""

    def at_once(joint: FleetJoint, out: Path, **_: Any) -> FleetRow:
        if joint.name == "broken":
            raise FricompError("cannot be read")
        return build_fleet_row(DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict=VERDICTS[joint.name]))  # type: ignore[arg-type]

    monkeypatch.setattr("fricomp.cli.diagnosis.fleet._diagnose_one", at_once)
    return tmp_path


def diagnose_fleet(folder: Path, names: tuple[str, ...], *options: object) -> Result:
    for name in names:
        (folder / f"{name}.csv").write_text("time,position,torque\n")
    out = ("--each", "--executor", "serial", "--out", folder / "out", *options)
    return call("diagnose", *(folder / f"{name}.csv" for name in names), *out)


def test_a_fleet_lists_the_worst_first(fleet: Path) -> None:
    pytest.importorskip("pyarrow")
    done = diagnose_fleet(fleet, ("elbow", "wrist", "hip", "knee"), "--json")
    assert done.exit_code == 0, done.output
    assert [row["name"] for row in json.loads(done.stdout)["joints"]] == ["knee", "hip", "wrist", "elbow"]


@pytest.mark.parametrize(
    ("names", "fail_if", "status"),
    [
        (("elbow",), "any", 0),
        (("elbow", "wrist"), "any", 1),
        (("elbow", "wrist"), "missing", 0),
        (("elbow", "hip"), "missing", 1),
        (("elbow", "hip"), "unusable", 0),
        (("elbow", "knee"), "unusable", 1),
        (("elbow", "broken"), "unusable", 1),
    ],
)
def test_a_fleet_fails_only_on_what_it_is_told_to(
    fleet: Path, names: tuple[str, ...], fail_if: str, status: int
) -> None:
    pytest.importorskip("pyarrow")
    assert diagnose_fleet(fleet, names, "--fail-if", fail_if).exit_code == status


@pytest.mark.parametrize(
    ("row", "severity"),
    [
        ({"error": "", "verdict": "consistent"}, Severity.FINE),
        ({"error": "", "verdict": "unknown_physics"}, Severity.MISSING),
        ({"error": "", "status": "converged"}, Severity.FINE),
        ({"error": "", "status": "not_identifiable"}, Severity.UNUSABLE),
    ],
)
def test_rows_are_rated_by_their_answer(row: Mapping[str, Any], severity: Severity) -> None:
    assert rate_row(row) is severity
