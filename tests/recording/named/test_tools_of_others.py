"""Logs as the tools of drives, middleware and spreadsheets write them: read by themselves, units and all."""

from __future__ import annotations

import json
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.api.identify import IdentifySettings, identify_source
from fricomp.cli.main import app
from fricomp.errors import RecordingError
from fricomp.recording import Recording, convert, load_mapping, read_recording, write_recording
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.inspection.mapping_text import render_mapping
from fricomp.recording.named.column import read_column_name
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(12.0, 125.0, 41)
TIME, POSITION, TORQUE = (np.asarray(one) for one in (LOG.time, LOG.position, LOG.torque))
assert LOG.velocity is not None
VELOCITY = np.asarray(LOG.velocity)
BEGIN = datetime(2024, 1, 13, 11, 59, 55)
Write = Callable[[Path], Path]


def write(path: Path, head: str, rows: list[str]) -> Path:
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path


def rows_of(*columns: np.ndarray, mark: str = ",") -> list[str]:
    return [mark.join(f"{cell:.9g}" for cell in row) for row in np.stack(columns, axis=1)]


def write_labview(folder: Path) -> Path:
    head = (
        "LabVIEW Measurement\t\nSeparator\tTab\nTime_Pref\tRelative\n***End_of_Header***\t\n\nChannels\t2\t\t\n"
        f"Samples\t{TIME.size}\t{TIME.size}\t\nDate\t2024/03/05\t2024/03/05\t\nX0\t0.0\t0.0\t\nDelta_X\t0.008\t0.008\t\n"
        "***End_of_Header***\t\t\t\nX_Value\tPosition [rad]\tTorque [N.m]\tComment"
    )
    return write(folder / "run.lvm", head, rows_of(TIME, POSITION, TORQUE, mark="\t"))


def write_month_first(folder: Path) -> Path:
    stamps = [f"{BEGIN + timedelta(seconds=float(t)):%m/%d/%Y %I:%M:%S.%f %p}" for t in TIME]
    rows = rows_of(np.rad2deg(POSITION), TORQUE / 0.1129848290276167)
    return write(
        folder / "log.csv",
        "Date/Time,Pos (deg),Torque (in-lb)",
        [f"{a},{b}" for a, b in zip(stamps, rows, strict=True)],
    )


def write_german_words(folder: Path) -> Path:
    head = "Prüfstand;Achse 3\nZeit in s;Gelenkwinkel [°];Istdrehzahl [U/min];Motormoment in Ncm"
    rows = rows_of(TIME, np.rad2deg(POSITION), VELOCITY * 30 / np.pi, 100 * TORQUE, mark=";")
    return write(folder / "log.asc", head, [row.replace(".", ",") for row in rows])


def write_moteus(folder: Path) -> Path:
    head = "timestamp,servo_stats.position,servo_stats.velocity,servo_stats.torque_Nm,servo_stats.q_A"
    turns = 2 * np.pi
    return write(folder / "m.csv", head, rows_of(TIME, POSITION / turns, VELOCITY / turns, TORQUE, 3 * TORQUE))


def write_moteus_registers(folder: Path) -> Path:
    zeros, turns = np.zeros_like(TIME), 2 * np.pi
    head = "time,id,MODE,POSITION,VELOCITY,TORQUE,VOLTAGE,FAULT"
    columns = [TIME, zeros, zeros + 10, POSITION / turns, VELOCITY / turns, TORQUE, zeros + 24, zeros]
    return write(folder / "m.csv", head, rows_of(*columns))


def write_json_with_facts(folder: Path) -> Path:
    rows = [
        {"time": t, "state": {"position": q}, "torque": tau, "torque_enable": True}
        for t, q, tau in np.stack([TIME, POSITION, TORQUE], axis=1).tolist()
    ]
    (folder / "log.json").write_text(json.dumps({"kp": 3, "gains": [1.0, 2.0], "robot": "arm", "entries": rows}))
    return folder / "log.json"


def write_json_lines(folder: Path) -> Path:
    rows = [
        json.dumps({"t": t, "q": q, "tau": tau}) for t, q, tau in np.stack([TIME, POSITION, TORQUE], axis=1).tolist()
    ]
    return write(folder / "log.jsonl", rows[0], [*rows[1:], '{"t": 99.0, "q"'])


def write_factory_names(folder: Path) -> Path:
    zeros = np.zeros_like(TIME)
    head = "t,torDes,posDes,posAct,torAct,posErr,torEst"
    return write(folder / "log.csv", head, rows_of(TIME, zeros, zeros, POSITION, TORQUE, POSITION, 2 * TORQUE))


def write_minutes(folder: Path) -> Path:
    return write(
        folder / "log", "Time [min],Angle [mrad],Torque [mN·m]", rows_of(TIME / 60, 1e3 * POSITION, 1e3 * TORQUE)
    )


FORMS: list[Write] = [
    write_labview, write_month_first, write_german_words, write_moteus, write_moteus_registers,
    write_json_with_facts, write_json_lines, write_factory_names, write_minutes,
]  # fmt: skip


def require_same(recording: Recording) -> None:
    assert len(recording) == TIME.size
    assert recording.time - recording.time[0] == pytest.approx(TIME - TIME[0], abs=2e-6)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)
    assert recording.metadata.torque_unit == "N·m"


@pytest.mark.parametrize("form", FORMS)
def test_it_is_read_as_it_was_measured(form: Write, tmp_path: Path) -> None:
    require_same(read_content(form(tmp_path)).recording)


@pytest.mark.parametrize("form", [one for one in FORMS if one not in (write_json_with_facts, write_minutes)])
def test_its_mapping_reads_the_same(form: Write, tmp_path: Path) -> None:
    path, mapping = form(tmp_path), tmp_path / "log.toml"
    seen = inspect_log(path)
    assert seen.log is not None
    mapping.write_text(render_mapping(path, seen.log), encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    require_same(found.recording)


@pytest.mark.parametrize("kind", ["timestamp", "named", "duration"])
def test_an_index_of_dates_is_the_time(kind: str, tmp_path: Path) -> None:
    frames = pytest.importorskip("pandas")
    stamps = np.round(1e9 * TIME).astype("int64")
    index = frames.to_timedelta(stamps) if kind == "duration" else frames.to_datetime(1_700_000_000 * 10**9 + stamps)
    frame = frames.DataFrame({"joint_pos": POSITION, "joint_torque": TORQUE}, index=index)
    frame.index.name = "stamp" if kind == "named" else None
    frame.to_parquet(tmp_path / "log.parquet")
    require_same(read_content(tmp_path / "log.parquet").recording)
    frame.to_csv(tmp_path / "log.csv")
    require_same(read_content(tmp_path / "log.csv").recording)


def test_signals_of_simulink_have_their_labels(tmp_path: Path) -> None:
    from scipy.io import savemat

    signals = np.empty(2, dtype=[("values", "O"), ("dimensions", "O"), ("label", "O")])
    for k, (label, values) in enumerate((("position", POSITION), ("torque", TORQUE))):
        signals[k] = (values[:, None], 1.0, label)
    savemat(tmp_path / "log.mat", {"Scope": {"time": TIME[:, None], "signals": signals, "blockName": "model/Scope"}})
    require_same(read_content(tmp_path / "log.mat").recording)


@pytest.mark.parametrize(
    ("name", "channel", "unit"),
    [
        ("a1 q-axis [A]", "current", ""),
        ("Torque (mN·m)", "torque", "mNm"),
        ("Torque [kgf.cm]", "torque", "kgf·cm"),
        ("torque_ozin", "torque", "oz·in"),
        ("velocity_rad_s", "velocity", ""),
        ("c1 vel [Hz]", "velocity", "turns/s"),
        ("theta_dot", "velocity", ""),
        ("Sollwinkel [deg]", "position_reference", "deg"),
        ("Istmoment [Nm]", "torque", ""),
        ("present_position", "position", ""),
        ("MAIN.fActVelo", "velocity", ""),
        ("Torque (joint 3)", "torque", ""),
        ("mA", "current", "mA"),
        ("deg", "position", "deg"),
    ],
)
def test_word_and_unit_agree_on_what_it_is(name: str, channel: str, unit: str) -> None:
    meaning = read_column_name(name)
    assert meaning is not None
    assert (meaning.channel, meaning.unit) == (channel, unit)


@pytest.mark.parametrize(
    "name",
    [
        "posErr", "torque_enable", "observed torque constant [Nm/A]", "torque [rad]", "logs.dq.Time", "velocity_stamp",
        "torque.time [s]", "position.signals.dimensions",
    ],
)  # fmt: skip
def test_what_is_no_channel_is_taken_for_none(name: str) -> None:
    assert read_column_name(name) is None


@pytest.mark.parametrize("unit", ["Nm/A", "N/mm", "pu"])
def test_a_unit_that_is_not_known_is_never_taken_as_that_of_si(unit: str, tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", f"t,q,torque [{unit}]", rows_of(TIME, POSITION, TORQUE))
    with pytest.raises(RecordingError, match=r"is not known: .* scale = VALUE_OF_ONE"):
        read_recording(path)


def test_the_only_joint_that_moves_is_taken(tmp_path: Path) -> None:
    still = np.full_like(TIME, 0.3)
    columns = rows_of(TIME, still, POSITION, still, TORQUE, 0.1 * TORQUE, still)
    path = write(tmp_path / "log.csv", "t,q_1,q_2,q_3,tau_2,tau_1,tau_3", columns)
    content = read_content(path)
    assert content.recording.metadata.joint == "joint_2"
    assert any("joint_2 alone moves" in finding.message for finding in content.findings)


def test_a_reference_that_never_changes_is_left_out(tmp_path: Path) -> None:
    zeros = np.zeros_like(TIME)
    path = write(tmp_path / "log.csv", "t,q,tau,q_ref,dq_ref", rows_of(TIME, POSITION, TORQUE, zeros, VELOCITY))
    log = read_named_log(path)
    assert "position_reference" not in log.recordings[0].channels
    assert "velocity_reference" in log.recordings[0].channels
    assert "position_reference" not in render_mapping(path, log)


def test_a_sheet_is_asked_for_as_csv(tmp_path: Path) -> None:
    (tmp_path / "log.xlsx").write_bytes(b"PK\x03\x04")
    with pytest.raises(RecordingError, match="a spreadsheet, which is not read here: save it as CSV"):
        read_recording(tmp_path / "log.xlsx")


@pytest.mark.parametrize("order", [("t", "q", "dq", "tau"), ("tau", "dq", "t", "q")])
def test_columns_without_names_are_guessed_by_what_they_do(order: tuple[str, ...], tmp_path: Path) -> None:
    columns = {"t": 1e3 * TIME, "q": POSITION, "dq": VELOCITY, "tau": TORQUE}
    path, mapping, out = tmp_path / "log.txt", tmp_path / "log.toml", tmp_path / "joint.csv"
    path.write_text("\n".join(rows_of(*(columns[one] for one in order), mark="\t")) + "\n")
    with pytest.raises(RecordingError, match="--inspect' shows them by their numbers"):
        read_named_log(path)
    runner = CliRunner()
    looked = runner.invoke(app, ["convert", str(path), "--inspect", "--out", str(mapping)])
    assert looked.exit_code == 0, looked.output
    done = runner.invoke(app, ["convert", str(path), "--mapping", str(mapping), "--out", str(out)])
    assert done.exit_code == 0, done.output
    recording = read_recording(out)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)
    assert recording.time == pytest.approx(TIME - TIME[0], abs=1e-6)


def test_arrays_without_words_are_guessed_as_well(tmp_path: Path) -> None:
    np.savez(tmp_path / "log.npz", qm=POSITION, vir=TORQUE, clk=TIME)
    seen = inspect_log(tmp_path / "log.npz")
    assert seen.log is None
    assert 'time = { column = "clk", unit = "s", from_zero = true }' in seen.guess
    assert 'position = { column = "qm" }' in seen.guess
    assert 'torque = { column = "vir" }' in seen.guess


def test_a_motors_torque_before_a_gear_is_asked_about(tmp_path: Path) -> None:
    path = write(
        tmp_path / "log.csv", "t,motor_pos,joint_pos,motor_torque", rows_of(TIME, -30 * POSITION, POSITION, TORQUE / 30)
    )
    told = " ".join(finding.message for finding in read_content(path).findings)
    assert 'torque_side = "motor" and gear_ratio = -30' in told
    direct = write(tmp_path / "b.csv", "t,motor_pos,joint_pos,motor_torque", rows_of(TIME, POSITION, POSITION, TORQUE))
    assert "torque_side" not in " ".join(finding.message for finding in read_content(direct).findings)


def test_the_mapping_of_a_recording_has_what_stands_above_its_rows(tmp_path: Path) -> None:
    facts = {"joint": "elbow", "torque_kind": "commanded", "encoder_resolution": 2.4e-5}
    write_recording(LOG.with_metadata(**facts), tmp_path / "log.csv")
    seen = inspect_log(tmp_path / "log.csv")
    assert seen.log is not None
    text = render_mapping(tmp_path / "log.csv", seen.log)
    for line in ('joint = "elbow"', 'torque_kind = "commanded"', "encoder_resolution = 2.4e-05"):
        assert line in text


def test_a_table_without_names_is_refused_with_the_command_that_shows_its_columns(tmp_path: Path) -> None:
    path = tmp_path / "log.txt"
    path.write_text("\n".join(rows_of(TIME, POSITION, TORQUE, mark=" ")) + "\n")
    with pytest.raises(RecordingError, match="--inspect' shows them by their numbers"):
        identify_source(path, IdentifySettings())


@pytest.mark.parametrize(
    ("names", "asked"),
    [
        ("time,position,velocity,torque,mode,q_current", "moteus"),
        ("time,pos_estimate,vel_estimate,torque,mode,x", "ODrive"),
        ("time,position,velocity,torque,mode,fault", ""),
        ("time,position [rad],velocity,torque,mode,q_current", ""),
    ],
)
def test_columns_that_are_called_as_those_of_a_drive_in_turns_are_asked_about(
    names: str, asked: str, tmp_path: Path
) -> None:
    rows = [f"{t:.6f},{q:.9f},{3 * q:.9f},{u:.9f},10,1" for t, q, u in zip(TIME, POSITION, TORQUE, strict=True)]
    path = write(tmp_path / "log.csv", names, rows)
    if not asked:
        assert read_named_log(path).recordings[0].metadata.position_unit == "rad"
        return
    with pytest.raises(RecordingError, match=f"those of {asked}, which writes turns"):
        read_named_log(path)
    column = names.split(",")[1]
    assert len(read_named_log(path, {"position": column}).recordings) == 1


@pytest.mark.parametrize(
    ("names", "told"),
    [("t,q,tau", True), ("t,q_rad,tau", False), ("t,position,effort", False), ("t,angle_deg,torque", False)],
)
def test_what_was_taken_for_a_unit_that_nothing_tells_is_said(names: str, told: bool, tmp_path: Path) -> None:
    rows = [f"{t:.6f},{0.77 * q:.9f},{u:.9f}" for t, q, u in zip(TIME, POSITION, TORQUE, strict=True)]
    notes = read_named_log(write(tmp_path / "log.csv", names, rows)).notes
    assert any("nothing tells the unit of" in note and "6.28" in note for note in notes) == told
