"""Tables of a fleet in one call: models with what limits their use, and no joint that stops another."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration import identify
from fricomp.control import Compensator
from fricomp.errors import IdentificationError, ParameterError
from fricomp.fleet import FleetJoint
from fricomp.fleet.identification import identify_tables, write_identification_fleet
from fricomp.model import FrictionModel, encode_model, load_model

pytest.importorskip("torch")
pytest.importorskip("pyarrow")

SPEED = np.linspace(0.05, 2.0, 20)
VELOCITY = np.concatenate([SPEED, -SPEED])


def _torque(bend: float, seed: int) -> np.ndarray:
    clean = np.sign(VELOCITY) * (1.0 + 0.5 * np.exp(-((VELOCITY / bend) ** 2))) + 0.3 * VELOCITY
    return np.asarray(clean * (1.0 + 0.02 * np.random.default_rng(seed).standard_normal(VELOCITY.size)))


def _joint(folder: Path, name: str, torque: np.ndarray) -> FleetJoint:
    path = folder / f"{name}.csv"
    np.savetxt(path, np.column_stack([VELOCITY, torque]), delimiter=",", header="velocity,torque", comments="")
    return FleetJoint(name, (path,))


def test_a_model_of_a_batch_is_trusted_as_far_as_that_of_one_joint(tmp_path: Path) -> None:
    torque = _torque(0.015, seed=4)
    rows = identify_tables([_joint(tmp_path, "fast", torque)], tmp_path / "out", "auto")
    model, alone = (
        load_model(tmp_path / "out" / "fast" / "friction.json"),
        identify(VELOCITY, torque, method="least_squares").model,
    )
    assert rows[0]["status"] == model.provenance.status == alone.provenance.status == "not_identifiable"
    assert "add speeds below 0.05" in rows[0]["message"] == model.provenance.message
    assert model.provenance.slowest_speeds == alone.provenance.slowest_speeds == (0.05, 0.05)
    assert model.provenance.largest_torque == pytest.approx(alone.provenance.largest_torque, rel=1e-4)
    assert model.provenance.data_sha256 == alone.provenance.data_sha256
    with pytest.raises(ParameterError, match="not usable"):
        Compensator(model)
    authority = [Compensator(one, any_status=True).settings.authority for one in (model, alone)]
    assert authority[0] == pytest.approx(authority[1], rel=1e-4)


def test_a_joint_whose_model_is_refused_stops_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse_left(model: FrictionModel) -> bytes:
        if model.joint == "left":
            raise ParameterError("a covariance must be symmetric")
        return encode_model(model)

    monkeypatch.setattr("fricomp.fleet.identification.encode_model", refuse_left)
    joints = [_joint(tmp_path, name, _torque(0.2, seed)) for seed, name in enumerate(("left", "right"))]
    rows = identify_tables(joints, tmp_path / "out", "auto")
    assert [row["error"] for row in rows] == ["a covariance must be symmetric", ""]
    assert not (tmp_path / "out" / "left").exists()
    assert (tmp_path / "out" / "right" / "friction.json").exists()


def test_a_model_of_somebody_else_in_the_place_of_a_joint_stays(tmp_path: Path) -> None:
    other = tmp_path / "out" / "left" / "friction.json"
    other.parent.mkdir(parents=True)
    other.write_text("of a calibration")
    (row,) = identify_tables([_joint(tmp_path, "left", _torque(0.2, 0))], tmp_path / "out", "auto")
    assert "holds friction.json of something else: choose another --out" in row["error"]
    assert other.read_text() == "of a calibration"


def test_one_extreme_table_stops_no_other(tmp_path: Path) -> None:
    joints = [_joint(tmp_path, "huge", 1e160 * _torque(0.2, 0)), _joint(tmp_path, "usual", _torque(0.2, 1))]
    huge, usual = identify_tables(joints, tmp_path / "out", "auto")
    assert "which is no measured value" in huge["error"]
    assert usual["error"] == ""


def test_a_device_that_is_not_there_leaves_no_fleet(tmp_path: Path) -> None:
    with pytest.raises(IdentificationError, match="there is no device 'abacus'"):
        identify_tables([_joint(tmp_path, "a", _torque(0.2, 0))], tmp_path / "out", "auto", device="abacus")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("damage", ["gone", "bad"])
def test_a_model_does_not_outlive_its_table(damage: str, tmp_path: Path) -> None:
    joint, out = _joint(tmp_path, "a", _torque(0.2, 0)), tmp_path / "out"
    identify_tables([joint], out, "auto")
    if damage == "gone":
        joint = replace(joint, recordings=(tmp_path / "b.csv",))
    else:
        joint.recordings[0].write_text("velocity,torque\n1,x\n")
    (row,) = identify_tables([joint], out, "auto", resume=True)
    assert row["error"]
    assert list((out / "a").iterdir()) == []


def test_degrees_in_a_table_are_in_its_row(tmp_path: Path) -> None:
    fast = np.geomspace(0.3, 115.0, 20)
    velocity = np.concatenate([fast, -fast])
    torque = np.sign(velocity) * (0.15 + 0.45 * np.exp(-((velocity / 2.9) ** 2))) + 0.002 * velocity
    path = tmp_path / "a.csv"
    np.savetxt(path, np.column_stack([velocity, torque]), delimiter=",", header="velocity,torque", comments="")
    (row,) = identify_tables([FleetJoint("a", (path,))], tmp_path / "out", "auto")
    assert row["warnings"].startswith("Careful: ")
    assert "is it in degrees" in row["warnings"]


def test_the_page_links_its_joints_and_an_unusable_one_does_not_set_the_scale(tmp_path: Path) -> None:
    name, deviation = "stribeck.forward.coulomb_torque", "stribeck.forward.coulomb_torque.standard_deviation"
    given = {"error": "", "seconds": 0.1, "noise": "absolute", "noise_level": 0.01, "torque_unit": "N·m", "message": ""}
    rows = [
        {"name": "elbow", "status": "converged", name: 0.3, deviation: 0.01, **given},
        {"name": "knee", "status": "not_identifiable", name: 7777.0, deviation: 900.0, **given},
    ]
    (tmp_path / "elbow").mkdir()
    (tmp_path / "elbow" / "report.html").write_text("")
    page = write_identification_fleet(rows, tmp_path).read_text()
    assert '<a href="elbow/report.html">elbow</a>' in page
    assert "Not drawn, as their models are not usable: knee." in page
    assert "1 of 2 not usable" in page
    chart = page[page.index("Plotly.newPlot(") :]
    assert "coulomb torque [N" in chart  # the dot of the unit is escaped there
    assert "knee" not in chart[: chart.index("</script>")]
    assert "data-filter" in page
