"""Marks between thousands, stamps in two columns and labels of lines, which a first look takes for something else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from fricomp.recording.file import read_content

from .proposed_mapping import convert_by_proposal

N_ROWS, RATE = 1200, 250.0
TIME = 3.0 + np.arange(N_ROWS) / RATE
POSITION = 1.7 * np.sin(1.7 * TIME) + 0.1 * np.sin(5.3 * TIME + 0.4)
TORQUE = 0.25 * np.sign(np.cos(1.7 * TIME)) + 2.0 * np.sin(POSITION)
Write = Callable[[Path], Path]


def write(path: Path, lines: Sequence[str]) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def fill(form: str) -> list[str]:
    rows = zip(TIME, POSITION, TORQUE, strict=True)
    return [
        form.format(us=round(1e6 * t), ms=round(1e3 * t), t=t, mrad=1e3 * q, q=q, mnm=1e3 * u, u=u) for t, q, u in rows
    ]


def write_commas_between_thousands(folder: Path) -> Path:
    """Whole numbers of a column have the comma that others show to stand between thousands."""
    above = ["Time (ms);Angle (mrad);Torque (mN·m)"]
    return write(folder / "log.csv", above + fill("{ms:,};{mrad:,.6f};{mnm:,.6f}"))


def write_points_beside_whole_thousands(folder: Path) -> Path:
    return write(folder / "log.txt", ["t_ms\tq\ttau_mNm", *fill("{ms:,}\t{q:.9f}\t{mnm:.6f}")])


def write_parts(folder: Path, seconds: str, rest: str, one: int) -> Path:
    """A stamp in whole seconds and what is left of it, of which so many are a second."""
    stamps = [1_700_000_000 * one + round(one * (t + 0.75)) for t in TIME]
    rows = [f"{stamp // one},{stamp % one},{row}" for stamp, row in zip(stamps, fill("{q:.9f},{u:.9f}"), strict=True)]
    return write(folder / "log.csv", [f"{seconds},{rest},q,tau", *rows])


def write_nanoseconds(folder: Path) -> Path:
    return write_parts(folder, "stamp_sec", "stamp_nsec", 10**9)


def write_microseconds(folder: Path) -> Path:
    return write_parts(folder, "tv_sec", "tv_usec", 10**6)


def write_capitals(folder: Path) -> Path:
    return write_parts(folder, "Seconds", "NanoSeconds", 10**9)


def write_ticks(folder: Path) -> Path:
    return write(folder / "log.csv", ["tick,q,tau", *fill("{us},{q:.9f},{u:.9f}")])


def write_label_of_units(folder: Path) -> Path:
    above = ["Model,MSO5204", "Sample Interval,4e-3,s", "Vertical Units,rad,mNm", "", "TIME,Position,Torque"]
    return write(folder / "scope.csv", above + fill("{t:.6f},{q:.9f},{mnm:.6f}"))


FORMS: list[Write] = [
    write_commas_between_thousands, write_points_beside_whole_thousands, write_nanoseconds, write_microseconds,
    write_capitals, write_ticks, write_label_of_units,
]  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("proposed", [False, True])
def test_it_is_read_as_it_was_measured(form: Write, proposed: bool, tmp_path: Path) -> None:
    path = form(tmp_path)
    recording = convert_by_proposal(path, tmp_path) if proposed else read_content(path).recording
    assert len(recording) == N_ROWS
    assert recording.time - recording.time[0] == pytest.approx(TIME - TIME[0], abs=2e-6)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


def test_seconds_beside_all_of_the_microseconds_are_two_clocks(tmp_path: Path) -> None:
    rows = fill("{t:.0f},{us},{q:.9f},{u:.9f}")
    recording = read_content(write(tmp_path / "log.csv", ["t_s,t_us,q,tau", *rows])).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME - TIME[0], abs=1e-6)


def test_what_the_velocity_is_the_rate_of_is_the_position(tmp_path: Path) -> None:
    """A state of a data set of learning says nothing of itself; the action beside it is a command."""
    speed = np.gradient(POSITION, TIME)
    rows = [
        f"{t:.6f},{q + 0.02:.9f},{v:.9f},{u:.9f},{q:.9f}"
        for t, q, v, u in zip(TIME, POSITION, speed, TORQUE, strict=True)
    ]
    names = "timestamp,action:1,observation.velocity:1,observation.effort:1,observation.state:1"
    recording = read_content(write(tmp_path / "log.csv", [names, *rows])).recording
    assert recording.position == pytest.approx(POSITION, abs=1e-6)


def test_the_integral_stands_in_where_nothing_moves_at_that_rate(tmp_path: Path) -> None:
    speed = np.gradient(POSITION, TIME)
    rows = [f"{t:.6f},{t**2:.9f},{v:.9f},{u:.9f}" for t, v, u in zip(TIME, speed, TORQUE, strict=True)]
    recording = read_content(write(tmp_path / "log.csv", ["time,x9,velocity,tau", *rows])).recording
    assert recording.position - recording.position[0] == pytest.approx(POSITION - POSITION[0], abs=1e-3)
