from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.calibration.benchmark.problem import PaperProblem
from fricomp.calibration.table import is_friction_table, read_friction_table
from fricomp.cli.identify import app
from fricomp.errors import RecordingError
from fricomp.model import load_model
from fricomp.recording import Recording, RecordingMetadata, write_recording


def _table(path: Path) -> Path:
    draw = PaperProblem().draw("absolute", 0)
    rows = "\n".join(f"{v!r},{t!r}" for v, t in zip(draw.velocity.tolist(), draw.torque.tolist(), strict=True))
    path.write_text(f"# a comment\nvelocity,torque\n{rows}\n")
    return path


def test_identifies_a_table_and_writes_model_network_and_report(tmp_path: Path) -> None:
    table, out = _table(tmp_path / "points.csv"), tmp_path / "out"
    done = CliRunner().invoke(app, [str(table), "--out", str(out), "--method", "least_squares", "--noise", "absolute"])
    assert done.exit_code == 0, done.output
    assert {"friction.json", "friction.onnx", "report.html"} <= {path.name for path in out.iterdir()}
    assert load_model(out / "friction.json").forward.static_torque == pytest.approx(0.6, rel=0.1)


def test_a_network_departs_where_held_out_points_ask_for_it(tmp_path: Path) -> None:
    side = np.linspace(0.02, 1.0, 30)
    speed, sign = np.concatenate([side, side]), np.repeat([1.0, -1.0], len(side))
    hump = 0.3 * np.exp(-(((speed - 0.45) / 0.12) ** 2))
    torque = sign * (0.15 + 0.45 * np.exp(-((speed / 0.05) ** 2)) + 0.02 * speed + hump)
    torque += 0.005 * np.random.default_rng(0).normal(size=len(torque))
    table = tmp_path / "points.csv"
    np.savetxt(table, np.column_stack([sign * speed, torque]), delimiter=",", header="velocity,torque", comments="")
    call = [str(table), "--out", str(tmp_path / "out"), "--method", "least_squares", "--noise", "absolute", "--depart"]
    done = CliRunner().invoke(app, call)
    assert done.exit_code == 0, done.output
    assert "the data depart from the law" in done.output
    assert "network, data alone" in done.output
    assert (tmp_path / "out" / "friction_departed.onnx").exists()


def test_a_table_is_told_from_a_recording(tmp_path: Path) -> None:
    recording = tmp_path / "recording.csv"
    recording.write_text("time,position,velocity,torque\n0,0,0,0\n")
    assert not is_friction_table(recording)
    assert is_friction_table(_table(tmp_path / "points.csv"))
    assert np.count_nonzero(read_friction_table(tmp_path / "points.csv").velocity) == 200


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty"),
        ("velocity,torque\n", "at least one row"),
        ("velocity,torque\n1,x\n", "row 1, column torque is 'x'"),
        ("velocity,torque\n1\n", "column torque is 'missing'"),
        ("velocity,torque\n1,nan\n", "not a finite number"),
    ],
)
def test_a_bad_table_is_refused_with_its_place(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(RecordingError, match=words):
        read_friction_table(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="No such file"):
        is_friction_table(tmp_path / "none.csv")


def test_degrees_in_a_table_are_noticed(tmp_path: Path) -> None:
    v = np.concatenate([-np.geomspace(0.3, 57.0, 40), np.geomspace(0.3, 57.0, 40)])
    torque = (0.15 + 0.45 * np.exp(-((v / 2.9) ** 2))) * np.sign(v)
    table = tmp_path / "degrees.csv"
    np.savetxt(table, np.column_stack([v, torque]), delimiter=",", header="velocity,torque", comments="")
    done = CliRunner().invoke(app, [str(table), "--method", "least_squares", "--out", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    assert "degrees per second" in done.output


def test_a_recording_in_degrees_is_refused(tmp_path: Path) -> None:
    t = np.arange(0.0, 20.0, 1e-3)
    q = np.degrees(0.5 * np.sin(t))
    recording = Recording.from_channels(
        {"time": t, "position": q, "torque": np.cos(t), "velocity": 0.5 * np.cos(t)}, RecordingMetadata(joint="elbow")
    )
    write_recording(recording, tmp_path / "degrees.csv")
    done = CliRunner().invoke(app, [str(tmp_path / "degrees.csv"), "--out", str(tmp_path / "out")])
    assert isinstance(done.exception, RecordingError)
    assert "degrees" in str(done.exception)


def _fleet(folder: Path) -> Path:
    folder.mkdir()
    for name in ("left", "right"):
        _table(folder / f"{name}.csv")
    return folder


def test_a_fleet_of_tables_gets_models_reports_and_a_page(tmp_path: Path) -> None:
    source, out = _fleet(tmp_path / "fleet"), tmp_path / "out"
    options = ["--method", "least_squares", "--executor", "serial", "--out", str(out)]
    done = CliRunner().invoke(app, [str(source), *options], env={"COLUMNS": "300"})
    assert done.exit_code == 0, done.output
    assert all((out / name / "report.html").exists() for name in ("left", "right"))
    assert "2 of 2: converged" in (out / "fleet.html").read_text()
    again = CliRunner().invoke(app, [str(source), *options, "--resume"])
    assert again.exit_code == 0, again.output


def test_a_batch_gives_every_joint_the_model_it_would_have_alone(tmp_path: Path) -> None:
    source, out = _fleet(tmp_path / "fleet"), tmp_path / "out"
    done = CliRunner().invoke(app, [str(source), "--batch", "--out", str(out)], env={"COLUMNS": "300"})
    assert done.exit_code == 0, done.output
    alone = tmp_path / "alone"
    CliRunner().invoke(app, [str(source / "left.csv"), "--method", "least_squares", "--out", str(alone)])
    together, single = (load_model(path / "friction.json") for path in (out / "left", alone))
    assert together.forward.static_torque == pytest.approx(single.forward.static_torque, rel=1e-6)
    assert (out / "fleet.parquet").exists()
