"""Facts above the rows: a rate is the time of rows without one, others are said where they are asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.named.head_fact import read_head_facts

from .proposed_mapping import convert_by_proposal

N_ROWS, RATE = 1200, 400.0
TIME = np.arange(N_ROWS) / RATE
POSITION = 1.1 * np.sin(2.7 * TIME) + 0.2 * np.sin(7.1 * TIME)
TORQUE = 0.4 * np.sign(np.cos(2.7 * TIME)) + 0.7 * POSITION


def write(folder: Path, above: str, names: str, form: str, rows: range | list[int] = range(N_ROWS)) -> Path:
    lines = [form.format(k=k, q=POSITION[k], u=TORQUE[k]) for k in rows]
    path = folder / "log.csv"
    path.write_text("\n".join([above, names, *lines]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("above", ["# Sample rate: 400 Hz", "Sampling frequency [kHz];0.4", "Sample Interval,2.5,ms"])
@pytest.mark.parametrize("counter", ["sample,", ""])
@pytest.mark.parametrize("proposed", [False, True])
def test_a_rate_above_the_rows_is_their_time(above: str, counter: str, proposed: bool, tmp_path: Path) -> None:
    path = write(tmp_path, above, f"{counter}q,tau", ("{k}," if counter else "") + "{q:.9f},{u:.9f}")
    recording = convert_by_proposal(path, tmp_path) if proposed else read_content(path).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=1e-9)
    assert recording.position == pytest.approx(POSITION, abs=1e-8)


def test_a_counter_shows_the_rows_that_are_missing(tmp_path: Path) -> None:
    rows = [k for k in range(N_ROWS) if k % 97]
    path = write(tmp_path, "# fs = 400 Hz", "n,q,tau", "{k},{q:.9f},{u:.9f}", rows)
    recording = read_content(path).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME[rows] - TIME[rows[0]], abs=1e-9)


def test_a_time_of_the_rows_comes_before_a_rate_above_them(tmp_path: Path) -> None:
    path = write(tmp_path, "# Sample rate: 100 Hz", "t_ms,q,tau", "{k},{q:.9f},{u:.9f}")
    assert read_content(path).recording.sample_period == pytest.approx(1e-3)


@pytest.mark.parametrize(
    ("above", "known"),
    [
        ("# motor: EC45, Kt = 0.089 Nm/A, gear ratio: 30", {"KT": 0.089, "RATIO": 30.0}),
        ("Nennmoment [mNm];2390", {"RATED": 2.39}),
        ("Inkremente/Umdrehung;8192", {"COUNTS_A_TURN": 8192.0}),
        ("Encoder resolution: 4194304 inc/rev", {"COUNTS_A_TURN": 4194304.0}),
        ("Feedback;65536 counts per turn", {"COUNTS_A_TURN": 65536.0}),
        ("gear_ratio: 1:50", {"RATIO": 50.0}),
        ("cpr: 4096\n# cpr: 8192", {}),
        ("Rated torque: 3 parsec", {}),
    ],
)
def test_what_stands_above_is_read_in_si(above: str, known: dict[str, float], tmp_path: Path) -> None:
    path = write(tmp_path, above, "t,q,tau", "{k},{q:.9f},{u:.9f}")
    assert {name: one.value for name, one in read_head_facts(path).items()} == pytest.approx(known)


@pytest.mark.parametrize(
    ("above", "names", "said", "line"),
    [
        (
            "Rated torque: 2.39 Nm",
            "t,q_rad,Torque (% rated)",
            "RATED is 2.39 by 'Rated torque: 2.39 Nm'",
            "scale = 0.0239",
        ),
        ("# cpr: 16384", "t,position_counts,tau_Nm", "COUNTS_A_TURN is 16384", "scale = 0.000383495197"),
        ("", "t,encoder (4096 cpr),tau_Nm", "COUNTS_A_TURN is 4096", "scale = 0.00153398079"),
        ("# gear ratio: 50", "t,motor_position_rad,motor_torque_Nm", "RATIO is 50 by 'gear ratio: 50'", "position"),
    ],
)
def test_what_is_asked_for_and_stands_above_is_said(
    above: str, names: str, said: str, line: str, tmp_path: Path
) -> None:
    path = write(tmp_path, above, names, "{k},{q:.9f},{u:.9f}")
    with pytest.raises(RecordingError) as refused:
        read_content(path)
    assert said in str(refused.value)
    assert line in inspect_log(path).guess


def test_a_duty_is_no_torque(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="'duty_pct' is a part of the supply, and no torque"):
        read_content(write(tmp_path, "", "t,q_rad,duty_pct", "{k},{q:.9f},{u:.9f}"))
