"""`fricomp diagnose` end to end: bad input is named as such and never as physics; the answer is in plain words."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.cli.diagnose import EXIT_BAD_DATA
from fricomp.cli.diagnosis.warnings import diagnosis_warnings, distinct_names
from fricomp.cli.main import app
from fricomp.diagnosis import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord, Quantity, diagnosis_json_schema
from fricomp.diagnosis.inputs import given
from fricomp.diagnosis.inputs.checks import Usable
from fricomp.diagnosis.record.result import Change
from fricomp.errors import DiagnosisError, FricompError, RecordingError
from fricomp.fleet import find_recordings
from fricomp.laws import Coulomb, FrictionLaw
from fricomp.model import FrictionModel, Provenance, save_model
from fricomp.recording import Recording, RecordingMetadata, read_recording, write_recording

from .called import call

_JOINT = """<mujoco><worldbody><body><joint name="elbow" axis="0 1 0"/>
<inertial pos="0.2 0 0" mass="1" diaginertia="0.3 0.3 0.3"/></body></worldbody></mujoco>"""


def _columns(seconds: float = 20.0, rate: float = 500.0) -> dict[str, np.ndarray]:
    """A joint that swings with Coulomb and viscous friction, as an encoder and a torque sensor see it."""
    t = np.arange(int(seconds * rate)) / rate
    w = np.array([1.1, 2.3])[:, None]
    q, v, a = (np.sum(f, axis=0) for f in (0.8 * np.sin(w * t), 0.8 * w * np.cos(w * t), -0.8 * w**2 * np.sin(w * t)))
    noise = 0.02 * np.random.default_rng(0).standard_normal(t.size)
    torque = 0.34 * a + 1.96 * np.cos(q) + 1.5 * np.sign(v) + 0.4 * v + noise
    return {"time": t, "position": np.round(q / 1e-5) * 1e-5, "velocity": v, "torque": torque}


def _standing(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """30 s of rest, then 10 s of motion."""
    moving = {name: values[:5000] for name, values in columns.items()}
    rest = {name: np.full(15000, values[0]) for name, values in moving.items()}
    rest["velocity"][:], rest["torque"] = 0.0, rest["torque"] + 0.02 * np.random.default_rng(1).standard_normal(15000)
    joined = {name: np.concatenate([rest[name], values]) for name, values in moving.items()}
    return joined | {"time": np.arange(20000) / 500.0}


def _save(folder: Path, columns: dict[str, np.ndarray], **metadata: object) -> Path:
    facts = RecordingMetadata(**{"joint": "elbow", "encoder_resolution": 1e-5, **metadata})  # type: ignore[arg-type]
    path = folder / "elbow.csv"
    write_recording(Recording.from_channels(columns, facts), path)
    return path


def _changed(name: str) -> dict[str, np.ndarray]:
    columns = _columns()
    if name == "no motion":
        return columns | {"position": np.zeros(10_000), "velocity": np.zeros(10_000)}
    if name == "degrees":
        return columns | {"position": np.degrees(columns["position"])}
    if name == "sign flipped":
        return columns | {"torque": -columns["torque"]}
    if name == "standstill":
        return _standing(columns)
    if name == "two sample rates":
        keep = np.concatenate([np.arange(5000), np.arange(5000, 10_000, 4)])
        return {key: values[keep] for key, values in columns.items()}
    return columns


@pytest.mark.parametrize(
    ("case", "metadata", "says"),
    [
        ("no motion", {}, "position"),
        ("degrees", {}, "degrees"),
        ("sign flipped", {}, "torque"),
        ("motor side", {"torque_side": "motor"}, "motor side"),
        ("wrong joint", {"joint": "wrist"}, "'wrist'"),
    ],
)
def test_bad_input_is_bad_data_and_never_a_name(
    case: str, metadata: dict[str, object], says: str, tmp_path: Path
) -> None:
    path = _save(tmp_path, _changed(case), **metadata)
    model, out = tmp_path / "joint.xml", tmp_path / "out"
    model.write_text(_JOINT)
    options = ["--simulation", str(model), "--joint", "elbow", "--out", str(out)]
    result = CliRunner().invoke(app, ["diagnose", str(path), *options])
    assert result.exit_code == EXIT_BAD_DATA, result.output
    record = json.loads((out / "diagnosis.json").read_text())
    assert record["verdict"] == "bad_data"
    assert record["effects"] == []
    assert says in " ".join(record["sentences"])
    assert says in result.stdout.replace("\n", " ")
    assert (out / "report.html").exists()
    assert not (out / "friction.json").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "says"),
    [
        pytest.param("standstill", "13999 rows of long rests", marks=pytest.mark.slow),
        ("two sample rates", "it changes from 500 to 125 Hz"),
    ],
)
def test_what_is_left_of_a_log_is_diagnosed_and_told(case: str, says: str, tmp_path: Path) -> None:
    path, out = _save(tmp_path, _changed(case)), tmp_path / "out"
    (tmp_path / "joint.xml").write_text(_JOINT)
    options = ["--simulation", str(tmp_path / "joint.xml"), "--joint", "elbow", "--out", str(out)]
    result = CliRunner().invoke(app, ["diagnose", str(path), *options])
    assert result.exit_code == 0, result.output
    assert says in " ".join(json.loads((out / "diagnosis.json").read_text())["sentences"])


def _run(*arguments: str) -> CompletedProcess[str]:
    return call("diagnose", *arguments)


def test_nan_is_one_clear_sentence_with_its_row(tmp_path: Path) -> None:
    path = _save(tmp_path, _columns(4.0))
    lines = path.read_text().splitlines()
    lines[-5] = lines[-5].rpartition(",")[0] + ",nan"
    path.write_text("\n".join(lines) + "\n")
    done = _run(str(path), "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert done.stderr.startswith("fricomp: ")
    assert "Traceback" not in done.stderr
    assert "not a finite number" in done.stderr
    assert "row" in done.stderr


def test_a_joint_that_the_simulation_lacks_is_named_with_those_it_has(tmp_path: Path) -> None:
    path, model = _save(tmp_path, _columns(6.0)), tmp_path / "joint.xml"
    model.write_text(_JOINT)
    done = _run(str(path), "--simulation", str(model), "--joint", "knee", "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert "knee" in done.stderr
    assert "elbow" in done.stderr


@pytest.mark.parametrize("opening", [0.0, 0.01])
@pytest.mark.parametrize("name", ["elbow", "elbow_joint"])
def test_of_a_log_with_a_gripper_beside_it_the_only_joint_of_a_simulation_is_taken(
    name: str, opening: float, tmp_path: Path
) -> None:
    columns = _columns()
    own = [columns["position"], columns["velocity"], -columns["torque"]]
    grip = 0.01 + opening * np.sin(columns["time"])
    beside = [grip, np.gradient(grip, 2e-3), 0.1 * np.ones(grip.size)]
    names = [f"{joint}.{channel}" for joint in (name, "gripper") for channel in ("position", "velocity", "effort")]
    (tmp_path / "joint.xml").write_text(_JOINT)
    table = np.column_stack([columns["time"], *own, *beside])
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header=",".join(["time", *names]), comments="")
    said = call("diagnose", tmp_path / "log.csv", "--simulation", tmp_path / "joint.xml", "--out", tmp_path / "out")
    assert said.returncode == EXIT_BAD_DATA
    assert "flip its sign" in " ".join(said.stdout.split())
    assert "'elbow' alone" in " ".join(said.stderr.split())


def test_simulated_and_simulation_exclude_each_other(tmp_path: Path) -> None:
    path, model = _save(tmp_path, _columns(6.0)), tmp_path / "joint.xml"
    model.write_text(_JOINT)
    arguments = [str(path), "--simulated", str(path), "--simulation", str(model), "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(app, ["diagnose", *arguments])
    assert "leave out --simulation" in str(result.exception)


@pytest.mark.parametrize("seconds", [0.8, 2.0, 4.9])
def test_a_short_recording_is_refused_with_its_length(seconds: float, tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = CliRunner().invoke(app, ["diagnose", str(_save(tmp_path, _columns(seconds))), "--out", str(out)])
    assert isinstance(result.exception, DiagnosisError)
    assert f"elbow.csv lasts {seconds - 0.002:.3g} s, and a diagnosis needs at least 5 s" in str(result.exception)
    assert not out.exists()


def _answer_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Diagnose as if the data were bad, which takes no time and names nothing."""
    monkeypatch.setattr(given, "take_usable", lambda *_: Usable([], [], ["a stub"]))


def test_what_the_checks_warn_of_stands_above_the_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _answer_at_once(monkeypatch)
    columns = _columns()
    columns = {"time": columns["time"], "position": np.degrees(columns["position"]), "torque": columns["torque"]}
    path, out = _save(tmp_path, columns, encoder_resolution=None), tmp_path / "out"
    wide = {"COLUMNS": "300"}
    result = CliRunner().invoke(app, ["diagnose", str(path), "--out", str(out)], env=wide)
    assert result.exit_code == EXIT_BAD_DATA, result.output
    assert result.stdout.startswith("Careful: position covers")
    assert "seems to be in degrees (factor 57.3)" in result.stdout
    assert result.stdout.index("Careful") < result.stdout.index("a stub")
    assert "seems to be in degrees" in (out / "report.html").read_text()
    call = ["diagnose", str(path), "--each", "--executor", "serial", "--out", str(tmp_path / "fleet")]
    fleet = CliRunner().invoke(app, call, env=wide)
    assert fleet.exit_code == 0, fleet.output
    assert "elbow: Careful: position covers" in fleet.stdout


def test_a_diagnosis_leaves_nothing_of_an_earlier_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _answer_at_once(monkeypatch)
    path, out = _save(tmp_path, _columns()), tmp_path / "out"
    out.mkdir()
    earlier = ["friction.onnx", "friction.xml", "motion.csv", "motion.png", "over-time-2.png", "where.png"]
    others = ["recording.csv", "mine.png", "over-time.png"]
    for name in (*earlier, *others):
        (out / name).write_text("of another recording")
    (out / "diagnosis.json").write_text('{"schema": "fricomp.diagnosis/1"}')
    model = FrictionModel(FrictionLaw((Coulomb(1.0),)), provenance=Provenance(method="diagnosis"))
    save_model(model, out / "friction.json")
    call = ["diagnose", str(path), "--overwrite", "--out", str(out)]
    result = CliRunner().invoke(app, call, env={"COLUMNS": "300"})
    assert result.exit_code == EXIT_BAD_DATA, result.output
    left = {name.name for name in out.iterdir()}
    assert left == {"diagnosis.json", "report.html", *others}
    assert result.stdout.rstrip().endswith(f"In {out}: diagnosis.json, report.html")


def _refused(tmp_path: Path, out: Path, *options: str) -> str:
    """What a diagnosis that is refused says, before it has read anything."""
    missing = str(tmp_path / "not_there.csv")
    result = CliRunner().invoke(app, ["diagnose", missing, "--out", str(out), *options])
    assert isinstance(result.exception, FricompError), result.output
    return str(result.exception)


def test_a_model_that_is_given_is_not_written_over(tmp_path: Path) -> None:
    model = tmp_path / "friction.json"
    save_model(FrictionModel(FrictionLaw((Coulomb(1.0),)), provenance=Provenance(method="calibrate")), model)
    before = model.read_bytes()
    said = _refused(tmp_path, tmp_path, "--friction", str(model))
    assert f"over its input {model}: choose another --out" in said
    assert model.read_bytes() == before


@pytest.mark.parametrize("diagnosed", [False, True])
@pytest.mark.parametrize("name", ["friction.json", "report.html"])
def test_a_file_that_is_no_diagnosis_is_not_written_over(name: str, diagnosed: bool, tmp_path: Path) -> None:
    (tmp_path / name).write_text("of somebody else")
    if diagnosed:
        (tmp_path / "diagnosis.json").write_text('{"schema": "fricomp.diagnosis/1"}')
    said = _refused(tmp_path, tmp_path)
    assert f"{tmp_path} holds {name}, which a diagnosis writes too" in said
    assert "choose another --out, or move it away" in said
    assert (tmp_path / name).read_text() == "of somebody else"


@pytest.mark.parametrize("below", ["", "deeper/still"])
@pytest.mark.parametrize("options", [[], ["--each"]])
def test_a_file_in_the_place_of_the_folder_is_told_at_once(below: str, options: list[str], tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    told = f"{tmp_path / 'taken'} is a file; choose another --out"
    assert told in _refused(tmp_path, tmp_path / "taken" / below, *options)


def test_a_diagnosis_is_repeated_in_its_folder_when_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _answer_at_once(monkeypatch)
    call = ["diagnose", str(_save(tmp_path, _columns())), "--out", str(tmp_path)]
    assert CliRunner().invoke(app, call).exit_code == EXIT_BAD_DATA
    before = (tmp_path / "report.html").read_bytes()
    refused = CliRunner().invoke(app, call)
    assert "holds diagnosis.json, report.html already: replace them (--overwrite)" in str(refused.exception)
    assert (tmp_path / "report.html").read_bytes() == before
    assert CliRunner().invoke(app, [*call, "--overwrite"]).exit_code == EXIT_BAD_DATA


def test_recordings_of_one_name_are_called_by_their_folders_too() -> None:
    assert distinct_names([Path("a/one.csv"), Path("b/two.csv")]) == ["one", "two"]
    assert distinct_names([Path("a/one.csv"), Path("b/one.csv")]) == ["a/one", "b/one"]
    assert distinct_names([Path("x/a/one.csv"), Path("y/a/one.csv")]) == ["x/a/one.csv", "y/a/one.csv"]


def _scaled(factor: float, gravity: float | None = None) -> DiagnosisRecord:
    """A record in which inertia, and gravity of 2 and 1 N·m, are multiplied by these factors."""
    gravity = factor if gravity is None else gravity
    moved = {"inertia": (0.3, factor), "gravity_cos": (2.0, gravity), "gravity_sin": (1.0, gravity)}
    changes = tuple(
        Change(name=name, given=given, refitted=Quantity(given * scale, "", (0.0, 9.0)))
        for name, (given, scale) in moved.items()
    )
    return DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict="parameters", changes=changes)


@pytest.mark.parametrize(
    ("record", "metadata", "says"),
    [
        (_scaled(1 / 6), {}, "both 0.167 times those of the simulation, as torque of the motor side"),
        (_scaled(1 / 6), {"gear_ratio": 6.0}, "(the recording states gear_ratio 6)"),
        (_scaled(0.5), {"gear_ratio": 6.0, "torque_side": "motor"}, "check the gear_ratio 6 of the recording"),
        (_scaled(1.05), {}, ""),
        (_scaled(1.2), {}, ""),  # no gear does that
        (_scaled(0.5, gravity=0.8), {}, ""),
    ],
)
def test_one_factor_on_inertia_and_gravity_is_said_to_look_like_a_gear(
    record: DiagnosisRecord, metadata: dict[str, object], says: str, tmp_path: Path
) -> None:
    path = _save(tmp_path, _columns(), **metadata)
    said = " ".join(diagnosis_warnings({path: read_recording(path)}, Diagnosis(record)))
    assert says in said
    assert bool(said) == bool(says)


def test_an_interrupted_diagnosis_says_what_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(given, "take_usable", interrupted)
    out = tmp_path / "out"
    result = CliRunner().invoke(app, ["diagnose", str(_save(tmp_path, _columns())), "--out", str(out)])
    assert result.exit_code == 130
    assert f"Interrupted; nothing was written into {out}." in result.stderr


def test_the_schema_is_printed_without_a_recording_and_stands_in_the_documentation() -> None:
    result = CliRunner().invoke(app, ["diagnose", "--schema"])
    assert result.exit_code == 0
    schema = json.loads(result.stdout)
    assert schema == json.loads(json.dumps(diagnosis_json_schema()))
    written = Path(__file__).parents[2] / "docs" / "diagnosis.schema.json"
    assert schema == json.loads(written.read_text("utf-8")), f"fricomp diagnose --schema > {written}"


def test_folders_and_patterns_are_the_recordings_in_them(tmp_path: Path) -> None:
    for name in ("b.csv", "a.parquet", "note.txt"):
        (tmp_path / name).touch()
    assert [path.name for path in find_recordings([str(tmp_path)])] == ["a.parquet", "b.csv"]
    assert [path.name for path in find_recordings([str(tmp_path / "*.csv"), str(tmp_path / "b.csv")])] == ["b.csv"]
    with pytest.raises(RecordingError, match=r"holds no recording"):
        find_recordings([str(tmp_path / "*.mcap")])


def test_each_recording_of_a_folder_gets_its_own_report(tmp_path: Path) -> None:
    source, out = tmp_path / "fleet", tmp_path / "out"
    source.mkdir()
    for name in ("one", "two"):
        _save(source, _changed("motor side"), torque_side="motor").rename(source / f"{name}.csv")
    result = CliRunner().invoke(app, ["diagnose", str(source), "--each", "--executor", "serial", "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert all((out / name / "report.html").exists() for name in ("one", "two"))
    assert "2 of 2" in (out / "fleet.html").read_text()


@pytest.mark.slow
def test_a_recording_is_diagnosed_in_plain_words_quietly(tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = _run(str(_save(tmp_path, _columns(10.0))), "--out", str(out))
    assert done.returncode == 0, done.stderr
    record = json.loads((out / "diagnosis.json").read_text())
    assert done.stdout.startswith(record["sentences"][0][:40])
    assert done.stderr == ""
    assert record["recordings"] == ["elbow"]
    assert (out / "friction.json").exists()


@pytest.mark.slow
def test_a_browser_draws_the_report_of_a_real_diagnosis_without_errors_or_a_network(
    tmp_path: Path, open_page: Callable[[Path], Any]
) -> None:
    columns, out = _columns(), tmp_path / "out"
    ripple = columns | {"torque": columns["torque"] + 0.4 * np.sin(30.0 * columns["position"])}
    done = _run(str(_save(tmp_path, ripple)), "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert "Most of the mismatch sits" in done.stdout.replace("\n", " ")
    shown = open_page(out / "report.html")
    assert (shown.complaints, shown.fetched) == ((), ())
    charts = re.findall(r'id="(chart-[a-z0-9-]+)"', (out / "report.html").read_text())
    assert {"chart-over-time-1", "chart-where", "chart-orders", "chart-rivals"} <= set(charts)
    for name in charts:
        drawn = shown.dom[shown.dom.index(f'id="{name}"') :][:200_000]
        assert 'class="subplot xy"' in drawn, name
    assert ">cogging</text>" in shown.dom
