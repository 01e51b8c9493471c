"""`fricomp watch` on joints whose history is known."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.cli.main import app
from fricomp.laws import Cogging, Coulomb, FrictionLaw, SmoothedCoulomb, Viscous
from fricomp.model import Covariance, FrictionModel, Provenance, Validity, load_model, save_model

DEVIATION = 1e-3


def call(*arguments: object) -> Any:
    return CliRunner().invoke(app, ["watch", *map(str, arguments)], env={"COLUMNS": "60"})


def write_models(folder: Path, joint: str, coulomb: list[float], temperature: float | None = None) -> None:
    """A model a day, of these Coulomb torques [N·m] and a viscous coefficient that stays."""
    noise = DEVIATION * np.random.default_rng(4).standard_normal((len(coulomb), 2))
    for day, torque in enumerate(coulomb):
        law = FrictionLaw((Coulomb(torque + noise[day, 0]), Viscous(0.1 + noise[day, 1])))
        names = ("coulomb.coulomb_torque", "viscous.viscous_coefficient")
        at = None if temperature is None else (temperature + day, temperature + day + 2.0)
        model = FrictionModel(
            law,
            joint=joint,
            validity=Validity(velocity=(-1.0, 1.0), temperature=at),
            covariance=Covariance(names, DEVIATION**2 * np.eye(2), 1000),
            provenance=Provenance(method="least_squares", created=f"2026-03-{day + 1:02d}T12:00:00+00:00"),
        )
        (folder / f"{joint}-{day}").mkdir(parents=True)
        save_model(model, folder / f"{joint}-{day}" / "friction.json")


def test_a_drift_a_jump_and_a_joint_that_stays_are_told_apart(tmp_path: Path) -> None:
    write_models(tmp_path, "drifts", [0.30 + 0.002 * day for day in range(8)], temperature=20.0)
    write_models(tmp_path, "jumps", [0.3] * 4 + [0.4] * 4)
    write_models(tmp_path, "stays", [0.3] * 8)
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "friction.json").write_text("{}")
    done = call(tmp_path, "--json", "--out", tmp_path / "watch.html")
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    joints = {one["joint"]: one for one in answer["joints"]}
    slopes = {name: {t["name"]: t for t in one["trends"]} for name, one in joints.items()}
    drift = slopes["drifts"]["coulomb.coulomb_torque"]
    assert abs(drift["slope"] - 0.002) < drift["reach"] < 5e-4
    assert drift["significant"]
    assert not any(trend["significant"] for trend in slopes["stays"].values())
    assert joints["stays"]["changes"] == []
    assert [(one["when"], one["what"]) for one in joints["jumps"]["changes"]] == [
        ("2026-03-05 12:00", "coulomb.coulomb_torque")
    ]
    assert joints["drifts"]["models"][2]["temperature"] == pytest.approx(23.0)
    assert "broken" in answer["left_out"][0]
    page = (tmp_path / "watch.html").read_text()
    assert "Joint drifts over temperature" in page
    assert "Joint jumps over temperature" not in page
    assert page.index("Changed or drifting: drifts, jumps.") < page.index("Joint drifts: 8 models")


def test_dates_are_those_of_the_recordings_where_they_are_known(tmp_path: Path) -> None:
    write_models(tmp_path, "elbow", [0.3, 0.3, 0.4])
    files = [tmp_path / f"elbow-{day}" / "friction.json" for day in range(3)]
    for day, file in zip((20, 10, 30), files, strict=True):
        model = load_model(file)
        notes = {"recorded": f"2025-01-{day:02d}T08:00:00+00:00"}
        save_model(replace(model, provenance=replace(model.provenance, notes=notes)), file)
    (joint,) = json.loads(call(tmp_path, "--json").stdout)["joints"]
    assert [one["when"][:10] for one in joint["models"]] == ["2025-01-10", "2025-01-20", "2025-01-30"]
    assert [one["when"] for one in joint["changes"]] == ["2025-01-30 08:00"]
    write_models(tmp_path / "later", "elbow", [0.3])
    assert "dates of 3 of 4 models are those of their recordings" in " ".join(call(tmp_path).output.split())


def write_diagnoses(folder: Path, joint: str, coulomb: list[float], effects: list[list[str]]) -> None:
    """A diagnosis a day, of these Coulomb torques [N·m] and these effects, each with an amplitude of 0.1 N·m."""
    for day, (torque, named) in enumerate(zip(coulomb, effects, strict=True)):
        own = folder / f"{joint}-diagnosis-{day}"
        own.mkdir(parents=True)
        created = f"2026-03-{day + 1:02d}T12:00:00+00:00"
        made = Provenance(method="diagnosis", created=created)
        save_model(FrictionModel(FrictionLaw((Coulomb(torque),)), joint=joint, provenance=made), own / "friction.json")

        def told(value: float) -> dict[str, Any]:
            return {"value": value, "unit": "N·m", "ci95": [value - 0.002, value + 0.002], "at_bound": False}

        record = {
            "base": {"forward.coulomb_torque": told(torque)},
            "effects": [{"name": name, "parameters": {"amplitude": told(0.1)}} for name in named],
        }
        (own / "diagnosis.json").write_text(json.dumps(record))


def test_diagnoses_are_followed_by_what_they_name_and_by_their_intervals(tmp_path: Path) -> None:
    write_models(tmp_path, "elbow", [0.3, 0.3])
    write_diagnoses(tmp_path, "elbow", [0.3, 0.3005, 0.31, 0.31], [[], [], [], ["cogging"]])
    write_diagnoses(tmp_path, "wrist", [0.3, 0.32, 0.34, 0.36], [["cogging"]] * 4)
    answer = json.loads(call(tmp_path, "--json", "--out", tmp_path / "watch.html").stdout)
    found = {(one["joint"], one["diagnosed"]): one for one in answer["joints"]}
    assert found["elbow", False]["changes"] == []
    assert found["elbow", True]["changes"] == [
        {"when": "2026-03-03 12:00", "what": "forward.coulomb_torque"},
        {"when": "2026-03-04 12:00", "what": "new cogging"},
    ]
    trends = {one["name"]: one for one in found["wrist", True]["trends"]}
    assert trends["base.forward.coulomb_torque"]["slope"] == pytest.approx(0.02)
    assert trends["base.forward.coulomb_torque"]["significant"]
    assert not trends["cogging.amplitude"]["significant"]
    page = (tmp_path / "watch.html").read_text()
    assert "2 joints over time" in page
    assert "Joint elbow, diagnoses: 4 models" in page


def test_a_record_that_is_damaged_is_left_out(tmp_path: Path) -> None:
    write_diagnoses(tmp_path, "elbow", [0.3, 0.3], [[], []])
    (tmp_path / "elbow-diagnosis-1" / "diagnosis.json").write_text("{}")
    answer = json.loads(call(tmp_path, "--json").stdout)
    assert "no record of a diagnosis" in answer["left_out"][0]


def test_the_last_change_can_be_failed_on(tmp_path: Path) -> None:
    write_models(tmp_path, "elbow", [0.3, 0.3, 0.4])
    done = call(tmp_path, "--fail-if-changed")
    assert done.exit_code == 1
    assert "Changed at 2026-03-03 12:00 UTC" in done.output
    assert max(map(len, done.output.splitlines())) <= 60
    assert call(tmp_path).exit_code == 0


def test_a_folder_without_models_is_refused(tmp_path: Path) -> None:
    assert "no model (friction.json) that can be followed" in str(call(tmp_path).exception)
    assert "is no folder" in str(call(tmp_path / "none").exception)


def test_a_model_that_is_not_usable_takes_no_part(tmp_path: Path) -> None:
    write_models(tmp_path, "elbow", [0.3, 0.3, 0.3])
    file = sorted(tmp_path.rglob("friction.json"))[-1]
    model = load_model(file)
    save_model(replace(model, provenance=replace(model.provenance, status="not_identifiable")), file)
    answer = json.loads(call(tmp_path, "--json").stdout)
    assert len(answer["joints"][0]["models"]) == 2
    assert "its identification is not usable (not_identifiable" in answer["left_out"][0]


@pytest.mark.parametrize("created", ["", "last week", "9999-12-31T23:59:59-10:00"])
def test_a_model_of_no_known_date_is_left_out_with_the_reason(created: str, tmp_path: Path) -> None:
    law = FrictionLaw((Coulomb(0.3), Viscous(0.1)))
    (tmp_path / "undated").mkdir()
    save_model(FrictionModel(law, provenance=Provenance(created=created)), tmp_path / "undated" / "friction.json")
    assert "when it was made is not known" in str(call(tmp_path).exception)
    write_models(tmp_path, "elbow", [0.3, 0.3])
    left_out = json.loads(call(tmp_path, "--json").stdout)["left_out"]
    assert len(left_out) == 1
    assert "provenance.created" in left_out[0]


def test_a_copy_of_a_model_counts_once(tmp_path: Path) -> None:
    write_models(tmp_path, "elbow", [0.3, 0.3, 0.4])
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "friction.json").write_bytes((tmp_path / "elbow-1" / "friction.json").read_bytes())
    answer = json.loads(call(tmp_path, "--json").stdout)
    assert len(answer["joints"][0]["models"]) == 3
    assert "a copy of" in answer["left_out"][0]


def test_one_model_alone_is_said_to_be_one(tmp_path: Path) -> None:
    write_models(tmp_path, "elbow", [0.3])
    output = call(tmp_path).output
    assert "Joint elbow: one model" in output
    assert "No change" not in output


def test_models_of_two_laws_are_said_to_be_uncompared_and_not_unchanged(tmp_path: Path) -> None:
    write_models(tmp_path, "elbow", [0.3, 0.3])
    last = tmp_path / "elbow-1" / "friction.json"
    model = load_model(last)
    assert model.covariance is not None
    other = FrictionLaw((SmoothedCoulomb(0.9, 0.1), Cogging(0.1, 4.0, 0.0)))  # of the angle as well
    names = tuple(other.parameters())[:2]
    save_model(replace(model, law=other, covariance=replace(model.covariance, names=names)), last)
    done = call(tmp_path, "--out", tmp_path / "watch.html")
    said = " ".join(done.output.split())
    assert "No change" not in said
    assert "Not all models could be compared" in (tmp_path / "watch.html").read_text()
    assert "since their laws differ" in said
    assert "--law symmetric_stribeck" in said
    (joint,) = json.loads(call(tmp_path, "--json").stdout)["joints"]
    assert [one["when"] for one in joint["not_compared"]] == ["2026-03-02T12:00:00+00:00"]
