"""Units that a way and its rate tell of each other, curves with their own times, and rows as data bases dump them."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping
from fricomp.recording.file import read_content

from .proposed_mapping import convert_by_proposal
from .test_forms_of_printouts import POSITION, ROWS, TIME, TORQUE, VELOCITY
from .test_unstated import write

DEGREES = 180.0 / np.pi
TURN = 2.0 * np.pi
Columns = list[np.ndarray[tuple[int], np.dtype[np.float64]]]


def require_as_measured(path: Path, folder: Path) -> None:
    for recording in (read_content(path).recording, convert_by_proposal(path, folder)):
        assert recording.time - recording.time[0] == pytest.approx(TIME - TIME[0], abs=1e-4)
        assert recording.position == pytest.approx(POSITION, abs=2e-6)
        assert recording.torque == pytest.approx(TORQUE, abs=1e-5)
        if recording.velocity is not None:
            assert recording.velocity == pytest.approx(VELOCITY, abs=1e-4)


@pytest.mark.parametrize(
    ("names", "columns"),
    [
        ("time,angle,rate [deg/s],torque", [TIME, DEGREES * POSITION, DEGREES * VELOCITY, TORQUE]),
        ("t,theta,omega_dps,tau", [TIME, DEGREES * POSITION, DEGREES * VELOCITY, TORQUE]),
        ("t,q,speed [rpm],tau", [TIME, DEGREES * POSITION, VELOCITY * 60.0 / TURN, TORQUE]),
        ("t,q,speed [rpm],tau", [TIME, POSITION / TURN, VELOCITY * 60.0 / TURN, TORQUE]),
        ("t,angle,rate (rev/s),torque", [TIME, POSITION / TURN, VELOCITY / TURN, TORQUE]),
        ("t,q [deg],vel,tau", [TIME, DEGREES * POSITION, DEGREES * VELOCITY, TORQUE]),
        ("t,q [rad],vel,tau", [TIME, POSITION, VELOCITY * 60.0 / TURN, TORQUE]),
    ],
)
def test_a_way_and_its_rate_tell_each_others_units(names: str, columns: Columns, tmp_path: Path) -> None:
    require_as_measured(write(tmp_path, names, columns), tmp_path)


@pytest.mark.parametrize(
    ("names", "counts", "scale"),
    [
        ("time,pos [deg],vel [deg/s],trq", 1e4, DEGREES),
        ("time,pos,vel,trq", 1e4, 1.0),
        ("stamp,pos_rad,vel_rad_s,trq", 1e5, 1.0),
    ],
)
def test_a_clock_that_may_count_other_parts_or_stand_beside_a_gear_is_asked_about(
    names: str, counts: float, scale: float, tmp_path: Path
) -> None:
    path = write(tmp_path, names, [np.round(counts * TIME), scale * POSITION, scale * VELOCITY, TORQUE])
    with pytest.raises(RecordingError, match=r"states no unit, and beside it in [mu]s .* side of a gear") as refused:
        read_content(path)
    (rule,) = re.findall(r"time = (\{[^}]*\})", str(refused.value))
    columns = names.split(",")
    rules = [f"time = {rule}", f'position = {{ column = "{columns[1]}", scale = {1.0 / scale!r} }}']
    lines = ["[source]", "header = true", "[channels]", *rules, f'torque = {{ column = "{columns[3]}" }}']
    (found,) = convert(path, load_mapping(write_text(tmp_path, "log.toml", "\n".join(lines))))
    assert found.recording.time == pytest.approx(TIME - TIME[0], abs=1.0 / counts)
    assert found.recording.position == pytest.approx(POSITION, abs=2e-6)


@pytest.mark.parametrize("ratio", [1.0 / 4.0, 6.0, 50.0])
def test_a_gear_between_the_columns_is_no_unit_of_the_position(ratio: float, tmp_path: Path) -> None:
    path = write(tmp_path, "t,q,speed [rad/s],tau", [TIME, POSITION, ratio * VELOCITY, TORQUE])
    assert read_content(path).recording.position == pytest.approx(POSITION, abs=2e-6)


@pytest.mark.parametrize(
    "names", ["t,q,dq,tau", "time,pos,vel,torque", "Time,Position,Velocity,Torque", "time,theta,omega,tau"]
)
def test_a_motor_that_turns_and_turns_is_taken_in_rad_and_that_is_said(names: str, tmp_path: Path) -> None:
    path = write(tmp_path, names, [TIME, 20.0 * POSITION, 20.0 * VELOCITY, TORQUE])
    content = read_content(path)
    assert content.recording.position == pytest.approx(20.0 * POSITION, abs=2e-6)
    assert any("nothing tells the unit of" in one.message for one in content.findings)


def test_an_angle_of_many_turns_in_no_unit_is_asked_about(tmp_path: Path) -> None:
    path = write(tmp_path, "t,angle,torque", [TIME, DEGREES * POSITION, TORQUE])
    with pytest.raises(RecordingError, match=r"nothing tells the unit of 'angle'.*--channel position=angle"):
        read_content(path)
    assert read_content(path, channels={"position": "angle"}).recording.position == pytest.approx(DEGREES * POSITION)


def write_text(folder: Path, name: str, text: str) -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def format_rows(mark: str, start: str = "", end: str = "\n") -> str:
    return "".join(f"{start}{mark.join(f'{one:.7f}' for one in row)}{end}" for row in ROWS)


def write_points(folder: Path) -> Path:
    names = ",".join(f"/js/{one}[0].{axis}" for one in ("position", "velocity", "effort") for axis in "xy")
    return write_text(folder, "plot.csv", f"{names}\n" + "".join(f"{t},{q},{t},{v},{t},{u}\n" for t, q, v, u in ROWS))


def write_curves_of_other_lengths(folder: Path) -> Path:
    rows = [f"{t:.7f},{q:.7f},{t:.7f},{u:.7f}\n" for t, q, _, u in ROWS]
    return write_text(folder, "plot.csv", "pos_x,pos_y,tau_x,tau_y\n" + "".join(rows))


def write_insertions(folder: Path) -> Path:
    head = "-- dump\nCREATE TABLE `log` (\n  `t` double,\n  `pos` decimal(9,7),\n  PRIMARY KEY (`t`)\n);\n"
    return write_text(
        folder, "a.sql", head + format_rows(", ", "INSERT INTO `log` (`t`,`pos`,`vel`,`trq`) VALUES (", ");\n")
    )


def write_insertions_in_one_line(folder: Path) -> Path:
    head = "BEGIN;\nCREATE TABLE log(t REAL, q REAL CHECK (q < 9), qd REAL, tau REAL);\nINSERT INTO log VALUES "
    return write_text(folder, "b.sql", head + format_rows(",", "(", "),").rstrip(",") + ";\nCOMMIT;\n")


def write_copy(folder: Path) -> Path:
    head = "-- PostgreSQL\nSET x = 0;\n\nCOPY public.log (stamp_s, pos, vel, trq) FROM stdin;\n"
    return write_text(folder, "c.sql", head + format_rows("\t") + "\\.\n")


def write_page(folder: Path) -> Path:
    head = "<!DOCTYPE html>\n<html><style>td {width: 9px}</style><table><tr><th>t<th>&theta; [rad]<th>qd<th>tau</tr>"
    return write_text(folder, "d.html", head + format_rows("</td><td>", "<tr><td>", "</td></tr>\n") + "</table></html>")


def write_page_in_lines(folder: Path) -> Path:
    head = "".join(f"<th>{one}</th>\n" for one in ("", "time", "q", "qd", "tau"))
    rows = (f"<tr>\n<th>{k}</th>\n<td>" + "</td>\n<td>".join(map(repr, row)) + "</td>\n</tr>\n" for k, row in
            enumerate(ROWS.tolist()))  # fmt: skip
    return write_text(folder, "e.htm", f"<table>\n<thead><tr>\n{head}</tr></thead>\n{''.join(rows)}</table>\n")


def write_labels_of_a_scope(folder: Path) -> Path:
    head = "Model,MSO\n\nProbe Attenuation,1,1,1\nVertical Units,rad,rad/s,Nm\nLabel,angle,speed,torque\n"
    head += "TIME,CH1,CH2,CH3\n"
    return write_text(folder, "f.csv", head + format_rows(","))


def write_month_by_name(folder: Path) -> Path:
    rows = (f"14-Mar-2026 09:30:{t:07.4f},{q:.7f},{u:.7f}\n" for t, q, _, u in ROWS)
    return write_text(folder, "g.csv", "Timestamp,q_rad,tau_Nm\n" + "".join(rows))


def write_units_behind_labels(folder: Path) -> Path:
    head = "time,q,time,tau\nInterp: zoh,Unit: deg,Interp: zoh,Unit: N*m\n"
    return write_text(folder, "h.csv", head + "".join(f"{t},{DEGREES * q},{t},{u}\n" for t, q, _, u in ROWS))


FORMS: list[Callable[[Path], Path]] = [
    *(write_points, write_curves_of_other_lengths, write_insertions, write_insertions_in_one_line, write_copy),
    *(write_page, write_page_in_lines, write_labels_of_a_scope, write_month_by_name, write_units_behind_labels),
]


@pytest.mark.parametrize("form", FORMS)
def test_it_is_read_as_it_was_measured(form: Callable[[Path], Path], tmp_path: Path) -> None:
    recording = read_content(form(tmp_path)).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME - TIME[0], abs=1e-4)
    assert recording.position == pytest.approx(POSITION, abs=2e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=2e-6)


@pytest.mark.parametrize("form", [write_points, write_insertions, write_copy, write_page, write_labels_of_a_scope])
def test_the_mapping_that_is_proposed_for_it_reads_the_same(form: Callable[[Path], Path], tmp_path: Path) -> None:
    assert convert_by_proposal(form(tmp_path), tmp_path).torque == pytest.approx(TORQUE, abs=2e-6)


def test_a_folder_with_a_table_for_each_quantity_is_one_log(tmp_path: Path) -> None:
    for name, values in (("position", POSITION), ("torque", TORQUE)):
        write(tmp_path, "time,value", [TIME, values]).rename(tmp_path / f"{name}.csv")
    assert read_content(tmp_path).recording.torque == pytest.approx(TORQUE, abs=1e-6)


def test_stamps_out_of_order_are_no_counter_that_is_full(tmp_path: Path) -> None:
    stamps = TIME + np.random.default_rng(3).normal(0.0, 8e-3, TIME.size)
    path = write(tmp_path, "host_time,board_us,q_rad,tau", [stamps, np.round(1e6 * TIME), POSITION, TORQUE])
    content = read_content(path)
    assert content.recording.time == pytest.approx(TIME - TIME[0], abs=1e-4)
    alone = read_content(write(tmp_path, "host_time,q_rad,tau", [stamps, POSITION, TORQUE]))
    assert not any("as a counter that is full" in one.message for one in alone.findings)
    assert alone.recording.position == pytest.approx(POSITION, abs=1e-6)
    assert np.std(np.asarray(alone.recording.time) - TIME) < 8e-3


def write_spreadsheet_as_xml(folder: Path) -> Path:
    cells = "</Data></Cell><Cell><Data>"
    rows = "".join(f"<Row><Cell><Data>{cells.join(map(repr, row))}</Data></Cell></Row>\n" for row in ROWS.tolist())
    head = f"<Row><Cell><Data>{cells.join(('time', 'pos', 'vel', 'torque'))}</Data></Cell></Row>\n"
    return write_text(folder, "i.xml", f"<?xml version='1.0'?>\n<Workbook><Table>\n{head}{rows}</Table></Workbook>\n")


def write_open_document(folder: Path) -> Path:
    cells = "</text:p></table:table-cell><table:table-cell><text:p>"
    each = "<table:table-row><table:table-cell><text:p>{}</text:p></table:table-cell></table:table-row>"
    rows = [each.format(cells.join(map(str, row))) for row in (("t", "q", "qd", "tau"), *ROWS.tolist())]
    body = f"<office:body><table:table>{''.join(rows)}</table:table></office:body>"
    return write_text(folder, "j.fods", f"<?xml version='1.0'?>\n<office:document>{body}</office:document>\n")


def write_labels_with_dates(folder: Path) -> Path:
    rows = (f'time="2026-03-14T09:30:{t:09.6f}Z" level=info q_rad={q:.7f} tau_nm={u:.7f}\n' for t, q, _, u in ROWS)
    return write_text(folder, "k.log", "".join(rows))


@pytest.mark.parametrize("form", [write_spreadsheet_as_xml, write_open_document, write_labels_with_dates])
def test_rows_of_xml_and_labels_with_dates_are_read(form: Callable[[Path], Path], tmp_path: Path) -> None:
    recording = read_content(form(tmp_path)).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME - TIME[0], abs=1e-4)
    assert recording.position == pytest.approx(POSITION, abs=2e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=2e-6)


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("ROWS_A_SECOND", "write what ROWS_A_SECOND stands for"),
        ("WHICH", "write what WHICH stands for"),
        ("1/TICKS_A_SECOND", "write what 1/TICKS_A_SECOND stands for"),
        ("6.2832/16384", "write the number that 6.2832/16384 is"),
    ],
)
def test_a_mapping_with_something_left_to_say_is_told_so(value: str, said: str, tmp_path: Path) -> None:
    text = f'[channels]\ntime = {{ column = "t" }}  # ABOVE\nposition = {{ column = "Q", scale = {value} }}\n'
    with pytest.raises(RecordingError, match=f"line 3: .*{said}"):
        load_mapping(write_text(tmp_path, "log.toml", text))
