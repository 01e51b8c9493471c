"""An arm of the stand-in follows its excitation through the gate, and the recording is one that can be examined."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.arm.log import read_arm_log
from fricomp.cli.main import app

COMMAND = ["calibrate", "--backend", "sim", "--model", "two_link_arm", "--excite", "--duration", "12", "--out"]


@pytest.mark.usefixtures("drawn_charts")
def test_a_dry_run_draws_the_motion_and_moves_nothing(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, [*COMMAND, str(tmp_path / "out"), "--dry-run"])
    assert done.exit_code == 0, done.exception
    assert "Nothing moved" in done.output
    assert (tmp_path / "out" / "excitation.png").stat().st_size > 1000
    assert not (tmp_path / "out" / "recordings").exists()


def test_both_joints_follow_the_motion_and_are_recorded(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, [*COMMAND, str(tmp_path / "out")])
    assert done.exit_code == 0, done.exception
    plan = json.loads((tmp_path / "out" / "excitation.json").read_bytes())
    assert plan["recorded"] is True
    log = read_arm_log([tmp_path / "out" / "recordings"])
    assert log.is_arm
    assert sorted(one.metadata.joint for one in log.recordings) == ["elbow", "shoulder"]
    for one in log.recordings:
        assert one.duration == pytest.approx(12.0, abs=0.05)
        assert one.position_reference is not None
        error = np.asarray(one.position) - np.asarray(one.position_reference)
        assert np.sqrt(np.mean(error**2)) < 0.1 * np.std(one.position)


@pytest.mark.parametrize("more", [["--motion", "m.csv"], ["--joint", "elbow"]])
def test_what_is_of_single_joints_is_refused(tmp_path: Path, more: list[str]) -> None:
    done = CliRunner().invoke(app, [*COMMAND, str(tmp_path / "out"), *more])
    assert "has no use with --excite" in str(done.exception)
