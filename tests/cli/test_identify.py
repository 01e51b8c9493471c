import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.api.identification import Identification
from fricomp.api.identify import IdentifySettings, identify_source
from fricomp.calibration.comparison import compare_models
from fricomp.calibration.identification import Status
from fricomp.calibration.table import is_friction_table, read_friction_table
from fricomp.cli.identify import app
from fricomp.errors import IdentificationError, RecordingError
from fricomp.model import load_model
from fricomp.recording import Recording, RecordingMetadata, RecordingWriter, write_recording
from fricomp.sim_bench.studies.paper.problem import PaperProblem


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


def test_parameters_are_told_with_half_of_their_interval_for_each_direction(tmp_path: Path) -> None:
    call = [str(_table(tmp_path / "points.csv")), "--out", str(tmp_path / "out"), "--method", "least_squares"]
    said = CliRunner().invoke(app, call, env={"COLUMNS": "300"}).output
    assert "± 95 %" in said
    assert re.search(r"static torque \[N·m\] +│ +0\.\d+ ± 0\.\d+ +│ +0\.\d+ ± 0\.\d+", said), said


@pytest.mark.parametrize("several", [False, True])
def test_a_file_in_the_place_of_the_folder_is_told_at_once(tmp_path: Path, several: bool) -> None:
    table = str(_table(tmp_path / "points.csv"))
    done = CliRunner().invoke(app, [*[table] * (2 if several else 1), "--out", f"{table}/deeper"])
    assert str(done.exception) == f"cannot make the folder {table}/deeper: {table} is a file; choose another --out"


@pytest.mark.slow
def test_a_model_that_is_not_usable_is_written_and_ends_with_1(tmp_path: Path) -> None:
    v = np.concatenate([np.linspace(0.3, 1.0, 40), -np.linspace(0.3, 1.0, 40)])
    torque = np.sign(v) * 0.2 + 0.05 * v + np.random.default_rng(0).normal(0.0, 0.003, v.size)
    table, out = tmp_path / "fast.csv", tmp_path / "out"
    np.savetxt(table, np.column_stack([v, torque]), delimiter=",", header="velocity,torque", comments="")
    call = [str(table), "--law", "symmetric_stribeck", "--method", "least_squares", "--out", str(out)]
    done = CliRunner().invoke(app, call, env={"COLUMNS": "300"})
    assert done.exit_code == 1, done.output
    assert "NOT USABLE, not_identifiable: " in done.output
    assert {"friction.json", "friction.onnx", "report.html"} <= {path.name for path in out.iterdir()}


def test_a_second_basin_nearly_as_likely_is_a_warning(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = identify_source

    def doubtful(file: Path, settings: IdentifySettings, *, flag: str) -> Identification:
        found = plain(file, settings, flag=flag)
        doubt = replace(found.result, status=Status.WRONG_BASIN_SUSPECTED, message="a second basin is near")
        return replace(found, result=doubt)

    monkeypatch.setattr("fricomp.api.identify.identify_source", doubtful)
    call = [str(_table(tmp_path / "points.csv")), "--out", str(tmp_path / "out"), "--method", "least_squares"]
    done = CliRunner().invoke(app, [*call, "--noise", "absolute"], env={"COLUMNS": "300"})
    assert done.exit_code == 0, done.output
    assert "Careful, wrong_basin_suspected: a second basin is near" in done.output


def test_points_that_depart_from_the_law_are_a_warning_and_an_offset_a_note(tmp_path: Path) -> None:
    v = np.concatenate([-np.geomspace(0.01, 1.0, 40), np.geomspace(0.01, 1.0, 40)])
    hump = 0.15 * np.exp(-(((np.abs(v) - 0.45) / 0.12) ** 2))
    torque = np.sign(v) * (0.2 + 0.5 * np.exp(-((v / 0.05) ** 2)) + hump) + 0.02 * v + 0.03
    table, out = tmp_path / "points.csv", tmp_path / "out"
    torque = torque + np.random.default_rng(0).normal(0.0, 0.01, v.size)
    np.savetxt(table, np.column_stack([v, torque]), delimiter=",", header="velocity,torque", comments="")
    call = [str(table), "--method", "least_squares", "--out", str(out)]
    done = CliRunner().invoke(app, call, env={"COLUMNS": "300"})
    assert done.exit_code == 0, done.output
    assert "Careful, lack_of_fit: the points depart from the law" in done.output
    assert "with the same friction in both it would be 0.03" in done.output
    assert "95 % interval, if the law held" in (out / "report.html").read_text()


@pytest.mark.slow
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
        ("velocity,torque\n", "has a header and no rows"),
        ("velocity,load\n1,2\n", "it has velocity, load"),
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
    assert load_model(out / "left" / "friction.json").joint == "left"
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


def test_a_table_that_cannot_be_read_stops_no_other_of_a_batch(tmp_path: Path) -> None:
    source, out = _fleet(tmp_path / "fleet"), tmp_path / "out"
    (source / "bad.csv").write_text("velocity,torque\nnan,0.3\n")
    (source / "flipped.csv").write_text("velocity,torque\n1,-0.3\n-1,0.3\n")
    done = CliRunner().invoke(app, [str(source), "--batch", "--out", str(out)], env={"COLUMNS": "400"})
    assert done.exit_code == 0, done.output
    assert "column velocity is 'nan'" in done.output
    assert (out / "right" / "friction.json").exists()
    assert {path.stem for path in (out / "rows").iterdir()} == {"bad", "flipped", "left", "right"}
    before = (out / "left" / "friction.json").stat().st_mtime_ns
    _table(source / "bad.csv")
    again = CliRunner().invoke(app, [str(source), "--batch", "--out", str(out)])
    assert "give --resume" in str(again.exception)
    resumed = CliRunner().invoke(app, [str(source), "--batch", "--resume", "--out", str(out)])
    assert resumed.exit_code == 0, resumed.output
    assert (out / "bad" / "friction.json").exists()
    assert (out / "left" / "friction.json").stat().st_mtime_ns == before


def _loaded(path: Path, load: float | None) -> Path:
    """The paper's joint at one normal load, which leaves the torque as it is."""
    draw = PaperProblem().draw("absolute", 0)
    columns = [draw.velocity, draw.torque] + ([] if load is None else [np.full(len(draw.velocity), load)])
    header = "velocity,torque" + ("" if load is None else ",normal_load")
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="")
    return path


@pytest.mark.slow
@pytest.mark.parametrize("options", [["--method", "least_squares"], ["--batch"]])
def test_a_constant_normal_load_leaves_the_model_as_it_is(tmp_path: Path, options: list[str]) -> None:
    models = []
    for name, load in (("plain", None), ("loaded", 3.0)):
        out, place = tmp_path / name, tmp_path / name / ("points" if "--batch" in options else "")
        out.mkdir()
        done = CliRunner().invoke(app, [str(_loaded(out / "points.csv", load)), *options, "--out", str(out)])
        assert done.exit_code == 0, done.output
        models.append(load_model(place / "friction.json"))
    plain, loaded = models
    assert loaded.torque(0.2) == pytest.approx(plain.torque(0.2), rel=1e-6)
    assert loaded.torque(0.2, normal_load=3.0) == pytest.approx(loaded.torque(0.2), rel=1e-12)
    assert loaded.law.parameters()["stribeck.load.reference_load"] == pytest.approx(3.0)
    assert loaded.units()["stribeck.load.reference_load"] == "as normal_load"
    assert loaded.validity.normal_load == pytest.approx((3.0, 3.0))
    result = compare_models(plain, loaded)
    assert not result.changed
    assert result.normal_load == pytest.approx(3.0)
    assert result.load_known == (False, True)


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("velocity", "a table of friction points has velocity,torque"),
        ("Velocity,Torque", "write the names in lower case"),
        ("velocity;torque", "separate the columns of the rows by the same mark"),
        ("a,b,c", "fricomp convert SOURCE --mapping FILE"),
    ],
)
def test_a_file_of_neither_kind_is_not_called_a_recording(tmp_path: Path, header: str, words: str) -> None:
    path = tmp_path / "points.csv"
    path.write_text(f"{header}\n0.1,0.2,0.3\n")
    done = CliRunner().invoke(app, [str(path), "--method", "least_squares", "--out", str(tmp_path / "out")])
    assert isinstance(done.exception, RecordingError)
    assert words in str(done.exception)
    assert "is a recording" not in str(done.exception)


def test_a_law_that_the_command_cannot_identify_is_refused_in_its_own_words(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, [str(_table(tmp_path / "points.csv")), "--law", "lugre"])
    assert isinstance(done.exception, IdentificationError)
    assert "--law lugre has a bristle state" in str(done.exception)
    assert "stribeck, symmetric_stribeck" in str(done.exception)


def test_a_negative_seed_is_refused_by_the_option(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, [str(_table(tmp_path / "points.csv")), "--seed", "-1"])
    assert done.exit_code == 2
    assert "--seed" in done.output


def _motion(seconds: float = 20.0) -> Recording:
    """A joint with 0.1 kg·m² and 0.3 N·m of Coulomb friction, noise of 5 mN·m."""
    t = np.arange(0.0, seconds, 2e-3)
    q = 0.8 * np.sin(1.3 * t) + 0.15 * np.sin(5.7 * t + 1.0)
    v = 1.04 * np.cos(1.3 * t) + 0.855 * np.cos(5.7 * t + 1.0)
    a = -1.352 * np.sin(1.3 * t) - 4.8735 * np.sin(5.7 * t + 1.0)
    noise = 0.005 * np.random.default_rng(3).normal(size=len(t))
    return Recording(t, q, 0.1 * a + 0.3 * np.sign(v) + 0.05 * v + noise)


def _identify_motion(recording: Path, *options: str) -> tuple[str, dict[str, float]]:
    out = recording.parent / "out"
    call = [str(recording), "--law", "coulomb_viscous", *options, "--out", str(out)]
    done = CliRunner().invoke(app, call, env={"COLUMNS": "300"})
    assert done.exit_code == 0, (done.output, done.exception)
    inertia = float(done.output.partition("inertia ")[2].partition(" ")[0])
    return done.output, load_model(out / "friction.json").law.parameters() | {"inertia": inertia}


def _expect_motion(found: dict[str, float]) -> None:
    assert found["inertia"] == pytest.approx(0.1, rel=0.02)
    assert found["coulomb.coulomb_torque"] == pytest.approx(0.3, rel=0.02)


def test_torque_of_the_motor_is_brought_to_the_joint(tmp_path: Path) -> None:
    motion = _motion()
    motor = motion.with_channels(torque=motion.torque / 100.0).with_metadata(torque_side="motor", gear_ratio=100.0)
    write_recording(motor, tmp_path / "motor.csv")
    said, found = _identify_motion(tmp_path / "motor.csv")
    _expect_motion(found)
    assert "brought to the joint by the gear ratio 100" in said


def test_the_rigid_body_is_told_with_its_units(tmp_path: Path) -> None:
    write_recording(_motion(), tmp_path / "motion.csv")
    said, _ = _identify_motion(tmp_path / "motion.csv")
    told = r"inertia [\d.]+ ± [\d.e-]+ kg·m², .*gravity not fitted .*viscous [\d.]+ N·m·s/rad"
    assert re.search(told, " ".join(said.split()))


@pytest.mark.slow
def test_a_gap_is_not_bridged(tmp_path: Path) -> None:
    motion = _motion(30.0)
    write_recording(motion.rows((motion.time < 8.0) | (motion.time > 15.3)), tmp_path / "gap.csv")
    said, found = _identify_motion(tmp_path / "gap.csv")
    _expect_motion(found)
    assert "2 parts, 22.69 s in all, were filtered each on its own" in said
    assert "split the recording there" not in said


def test_of_a_recording_with_motion_blocks_those_alone_are_used(tmp_path: Path) -> None:
    motion, path = _motion(), tmp_path / "recording.csv"
    rest = Recording(np.arange(0.0, 5.0, 2e-3), np.full(2500, 0.3), np.full(2500, 0.8))
    with RecordingWriter(path) as writer:
        writer.append(rest, '{"kind":"tare"}')
        writer.append(motion.with_channels(time=motion.time + 10.0), '{"kind":"motion","number":0}')
        writer.append(rest.with_channels(time=rest.time + 40.0), '{"kind":"tare"}')
    said, found = _identify_motion(path)
    _expect_motion(found)
    assert "Blocks: 1 of 3, the motion, 10000 of 15000 samples, were used" in said
    assert "(tare) were left out" in said


@pytest.mark.slow
def test_blocks_of_other_kinds_are_all_used_and_named(tmp_path: Path) -> None:
    motion, path = _motion(), tmp_path / "recording.csv"
    with RecordingWriter(path) as writer:
        writer.append(motion, "first")
        writer.append(motion.with_channels(time=motion.time + 30.0), "second")
    said, found = _identify_motion(path)
    _expect_motion(found)
    assert "Blocks: all 2 of the recording were used; none of them is a motion" in said


def test_a_law_is_not_chosen_for_a_recording_in_silence(tmp_path: Path) -> None:
    write_recording(_motion(), tmp_path / "motion.csv")
    done = CliRunner().invoke(app, [str(tmp_path / "motion.csv"), "--law", "auto", "--out", str(tmp_path / "out")])
    assert isinstance(done.exception, IdentificationError)
    assert "--law auto is for tables" in str(done.exception)


def test_a_column_that_is_there_twice_is_refused(tmp_path: Path) -> None:
    table = tmp_path / "points.csv"
    table.write_text("velocity,torque,torque\n1,2,3\n")
    with pytest.raises(RecordingError, match="column torque twice"):
        read_friction_table(table)


def test_a_departed_network_of_an_earlier_model_does_not_stay_beside_a_new_one(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "friction_departed.onnx").write_bytes(b"of another model")
    call = [str(_table(tmp_path / "points.csv")), "--out", str(out), "--method", "least_squares", "--overwrite"]
    assert CliRunner().invoke(app, call).exit_code == 0
    assert not (out / "friction_departed.onnx").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--gravity"], "--gravity is for recordings"),
        (["--resume"], "--resume is of fleets"),
        (["--workers", "2"], "--workers is of fleets"),
        (["--device", "cuda"], "--device is for --batch"),
        (["--batch", "--gravity"], "--gravity has no use with --batch"),
        (["--batch", "--seed", "3"], "--seed has no use with --batch"),
        (["--batch", "--executor", "serial"], "--executor has no use with --batch"),
    ],
)
def test_an_option_that_would_be_ignored_is_refused(tmp_path: Path, options: list[str], words: str) -> None:
    done = CliRunner().invoke(app, [str(_table(tmp_path / "points.csv")), "--out", str(tmp_path / "out"), *options])
    assert isinstance(done.exception, IdentificationError), done.output
    assert words in str(done.exception)
    assert not (tmp_path / "out").exists()


def test_a_mapping_reads_a_log_without_names(tmp_path: Path) -> None:
    """Numbers alone are no table of friction to be asked about, once a mapping says what they are."""
    time = np.arange(0.0, 12.0, 0.01)
    velocity = 0.6 * np.cos(0.9 * time) + 0.4 * np.cos(2.3 * time)
    position = 0.6 / 0.9 * np.sin(0.9 * time) + 0.4 / 2.3 * np.sin(2.3 * time)
    noise = 0.01 * np.random.default_rng(0).standard_normal(time.size)
    np.savetxt(
        tmp_path / "log.csv", np.column_stack([time, position, 0.5 * np.sign(velocity) + 0.2 * velocity + noise])
    )
    (tmp_path / "robot.toml").write_text(
        '[source]\ndelimiter = ""\n[channels]\ntime = { column = 1 }\nposition = { column = 2 }\n'
        "torque = { column = 3 }\n"
    )
    options = ["--mapping", str(tmp_path / "robot.toml"), "--law", "coulomb_viscous", "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(app, [str(tmp_path / "log.csv"), *options])
    assert result.exit_code == 0, (result.output, result.exception)
    found = load_model(tmp_path / "out" / "friction.json").law.parameters()
    assert found["coulomb.coulomb_torque"] == pytest.approx(0.5, rel=0.02)
