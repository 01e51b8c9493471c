"""Exports of oscilloscopes whose head has the times, matrices that a script sets, and rows that LaTeX sets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration.table import is_friction_table
from fricomp.recording import Recording, convert, load_mapping
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log

from .proposed_mapping import convert_by_proposal
from .test_forms_of_printouts import POSITION, TIME, TORQUE, VELOCITY

STEP = float(TIME[1] - TIME[0])
Form = Callable[[], tuple[str, str]]


def join(columns: Sequence[Sequence[float] | np.ndarray], between: str, end: str = "\n") -> str:
    return "".join(between.join(f"{cell:.9g}" for cell in row) + end for row in zip(*columns, strict=True))


def as_scope_with_counter() -> tuple[str, str]:
    head = f"X,angle(rad),torque(Nm),Start,Increment\nSequence,rad,Nm,-1.5e+00,{STEP:.6e}\n"
    return "scope.csv", head + join([np.arange(TIME.size), POSITION, TORQUE], ",", ",,\n")


def as_scope_with_facts() -> tuple[str, str]:
    return "scope.csv", f"angle(rad),torque(Nm),t0 = -1.5e+00, tInc = {STEP:.6e},\n" + join(
        [POSITION, TORQUE], ",", ",,\n"
    )


def as_scope_with_seconds() -> tuple[str, str]:
    return "scope.csv", "x-axis,1,2\nsecond,rad,Nm\n" + join([TIME - 2.0, POSITION, TORQUE], ",")


def as_matrix() -> tuple[str, str]:
    return "log.m", "% elbow: t q tau\nx = [\n" + join([TIME, POSITION, TORQUE], " ", ";\n") + "];\n"


def as_matrix_below_words() -> tuple[str, str]:
    return "log.m", "names = {'time', 'pos', 'torque'};\nx = [" + join([TIME, POSITION, TORQUE], ", ") + "]\n"


def as_vectors() -> tuple[str, str]:
    lines = [f"{name} = [{'; '.join(map('{:.9g}'.format, x))}];" for name, x in (("t", TIME), ("q", POSITION))]
    return "log.m", "clear all\n" + "\n".join([*lines, f"tau = [ ...\n{join([TORQUE], '', ' ...' + chr(10))}]';\n"])


def as_latex() -> tuple[str, str]:
    head = "\\begin{tabular}{rrr}\n\\hline\n\\textbf{Time [s]} & $q$ [rad] & Torque [Nm] \\\\\n\\hline\n"
    return "log.tex", head + join([TIME, POSITION, TORQUE], " & ", " \\\\\n") + "\\end{tabular}\n"


FORMS: list[Form] = [
    as_scope_with_counter, as_scope_with_facts, as_scope_with_seconds, as_matrix, as_matrix_below_words, as_vectors,
    as_latex,
]  # fmt: skip


def require_same(recording: Recording) -> None:
    assert recording.time - recording.time[0] == pytest.approx(TIME - TIME[0], abs=1e-5)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


@pytest.mark.parametrize("form", FORMS)
def test_it_is_read_as_it_was_measured(form: Form, tmp_path: Path) -> None:
    name, text = form()
    (tmp_path / name).write_text(text)
    require_same(read_content(tmp_path / name).recording)
    require_same(convert_by_proposal(tmp_path / name, tmp_path))


def test_a_scope_that_calls_its_channels_by_numbers_is_proposed_with_its_rate(tmp_path: Path) -> None:
    head = f"X,CH1,CH2,CH3,Start,Increment,\nSequence,Volt,Volt,Volt,-1.5e+01,{STEP:.6e}\n"
    path = tmp_path / "scope.csv"
    path.write_text(head + join([np.arange(TIME.size), POSITION, VELOCITY, TORQUE], ","))
    (tmp_path / "log.toml").write_text(inspect_log(path).guess)
    (found,) = convert(path, load_mapping(tmp_path / "log.toml"))
    require_same(found.recording)


def as_controller_trace() -> tuple[str, str]:
    head = f"Sampling period [ms];{1e3 * STEP:g}\nFPOS(0) [deg];FVEL(0) [deg/s];TORQUE(0) [Nm]\n"
    return "trace.csv", head + join([np.degrees(POSITION), np.degrees(VELOCITY), TORQUE], ";")


def as_sentences() -> tuple[str, str]:
    rows = join([TIME, POSITION, TORQUE], ",").splitlines()
    return "log.txt", "time,pos,torque\n" + "".join(f"$JNT,{row}*5A\n" for row in rows)


def as_names_broken_in_their_quotes() -> tuple[str, str]:
    head = '"Time\n[s]","Joint\nposition\n[deg]","Torque\n[mN.m]"\n'
    return "sheet.csv", head + join([TIME, np.degrees(POSITION), 1e3 * TORQUE], ",")


def as_page_called_a_spreadsheet() -> tuple[str, str]:
    rows = zip(TIME, POSITION, TORQUE, strict=True)
    cells = "".join(f"<tr><td>{t:.9g}</td><td>{q:.9g}</td><td>{tau:.9g}</td></tr>\n" for t, q, tau in rows)
    return "log.xls", f"<html><table><tr><td>time [s]</td><td>q [rad]</td><td>tau [Nm]</td></tr>\n{cells}</table>"


@pytest.mark.parametrize("form", [as_controller_trace, as_names_broken_in_their_quotes, as_page_called_a_spreadsheet])
def test_forms_of_programs_of_drives_and_sheets_are_read(form: Form, tmp_path: Path) -> None:
    name, text = form()
    (tmp_path / name).write_text(text)
    require_same(read_content(tmp_path / name).recording)
    if name.endswith(".csv"):
        assert not is_friction_table(tmp_path / name)


def test_rows_with_sums_at_their_ends_are_proposed(tmp_path: Path) -> None:
    name, text = as_sentences()
    (tmp_path / name).write_text(text.split("\n", 1)[1])
    (tmp_path / "log.toml").write_text(inspect_log(tmp_path / name).guess)
    (found,) = convert(tmp_path / name, load_mapping(tmp_path / "log.toml"))
    require_same(found.recording)
