"""Tables of a fleet in one call: models with what limits their use, and no joint that stops another."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration import identify
from fricomp.control import Compensator
from fricomp.errors import ParameterError
from fricomp.model import FrictionModel, load_model, save_model
from fricomp.sim_bench.fleet import FleetJoint
from fricomp.sim_bench.fleet.identification import identify_tables

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
    def refuse_left(model: FrictionModel, path: Path) -> str:
        if model.joint == "left":
            raise ParameterError("a covariance must be symmetric")
        return save_model(model, path)

    monkeypatch.setattr("fricomp.sim_bench.fleet.identification.save_model", refuse_left)
    joints = [_joint(tmp_path, name, _torque(0.2, seed)) for seed, name in enumerate(("left", "right"))]
    old = tmp_path / "out" / "left" / "friction.json"
    old.parent.mkdir(parents=True)
    old.write_text("of other data")
    rows = identify_tables(joints, tmp_path / "out", "auto")
    assert [row["error"] for row in rows] == ["a covariance must be symmetric", ""]
    assert not old.exists()
    assert (tmp_path / "out" / "right" / "friction.json").exists()
