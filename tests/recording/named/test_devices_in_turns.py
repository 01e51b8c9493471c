"""Rows of several devices in one table, which a number tells apart."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fricomp.recording.named.log import NamedLog, read_named_log

N_ROWS = 400
TIME = np.arange(N_ROWS) / 200.0
SLOW, FAST = np.sin(TIME), 0.3 * np.cos(2.2 * TIME)
Rows = list[tuple[float, str, float, float]]


def list_rows(first: str, second: str) -> Rows:
    """A row of each device in turn: time, number, position, torque."""
    own = [
        ((t, first, q, np.sign(q)), (t + 1e-3, second, p, 0.4 * np.sign(p)))
        for t, q, p in zip(TIME, SLOW, FAST, strict=True)
    ]
    return [row for pair in own for row in pair]


def write_table(path: Path, head: str, rows: Rows) -> Path:
    path.write_text("\n".join([head, *(f"{t:.4f},{n},{q:.6f},{u:.4f}" for t, n, q, u in rows)]) + "\n")
    return path


def list_joints(log: NamedLog) -> list[tuple[str, int, float]]:
    """Name, rows and travel of each joint."""
    return [(one.metadata.joint, len(one), round(float(np.ptp(one.position)), 2)) for one in log.recordings]


BOTH = [("joint_3", N_ROWS, round(float(np.ptp(SLOW)), 2)), ("joint_12", N_ROWS, round(float(np.ptp(FAST)), 2))]


@pytest.mark.parametrize("head", ["t,motor_id,pos,torque", "t,id,q,tau", "t,node,q,tau", "stamp,CAN ID,angle,effort"])
@pytest.mark.parametrize("write_number", [int, "0x{:02x}".format])
def test_rows_of_devices_are_told_apart(tmp_path: Path, head: str, write_number: Callable[[int], object]) -> None:
    rows = list_rows(str(write_number(3)), str(write_number(12)))
    assert list_joints(read_named_log(write_table(tmp_path / "log.csv", head, rows))) == BOTH


def test_they_are_in_a_line_of_json_each(tmp_path: Path) -> None:
    lines = [json.dumps({"t": t, "id": int(n), "pos": q, "torque": u}) for t, n, q, u in list_rows("3", "12")]
    (tmp_path / "log.jsonl").write_text("\n".join(lines) + "\n")
    assert list_joints(read_named_log(tmp_path / "log.jsonl")) == BOTH


@pytest.mark.parametrize("names", [("3", "12"), ("elbow", "wrist")])
def test_one_joint_after_the_other_is_no_single_one(tmp_path: Path, names: tuple[str, str]) -> None:
    rows = sorted(list_rows(*names), key=lambda row: row[1] != names[0])
    found = list_joints(read_named_log(write_table(tmp_path / "log.csv", "t,joint,pos,torque", rows)))
    assert [one[1:] for one in found] == [one[1:] for one in BOTH]


@pytest.mark.parametrize("head", ["t,id,pos,torque", "t,motor,pos,torque"])
def test_numbers_that_follow_each_other_may_be_those_of_tests_or_states(tmp_path: Path, head: str) -> None:
    rows = [(t, str(int(t > 1.0)), q, np.sign(q)) for t, q in zip(TIME, SLOW, strict=True)]
    assert list_joints(read_named_log(write_table(tmp_path / "log.csv", head, rows))) == [("joint", N_ROWS, BOTH[0][2])]
