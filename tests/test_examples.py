"""The examples run as they stand."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from fricomp.laws import BidirectionalStribeck, Cogging, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel, load_model, save_model

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.fixture
def model(tmp_path: Path) -> Path:
    curves = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03)
    save_model(FrictionModel(FrictionLaw((BidirectionalStribeck(*curves),))), tmp_path / "friction.json")
    return tmp_path / "friction.json"


@pytest.mark.parametrize("with_file", [False, True])
def test_embedding_takes_a_model_or_a_file(model: Path, with_file: bool) -> None:
    command = [sys.executable, "embed.py", *([str(model)] if with_file else [])]
    done = subprocess.run(command, cwd=EXAMPLES, capture_output=True, text=True, check=True)
    assert "measured +0.200 rad/s: +0.1463 N·m" in done.stdout


@pytest.mark.parametrize("with_file", [False, True])
def test_a_loop_of_ones_own_follows_better_with_compensation(model: Path, with_file: bool) -> None:
    command = [sys.executable, "loop.py", *([str(model)] if with_file else [])]
    done = subprocess.run(command, cwd=EXAMPLES, capture_output=True, text=True, check=True)
    without, compensated = (float(line.split()[-3]) for line in done.stdout.splitlines())
    assert compensated < 0.5 * without


def test_an_arm_resists_more_where_it_carries_more() -> None:
    done = subprocess.run([sys.executable, "arm.py"], cwd=EXAMPLES, capture_output=True, text=True, check=True)
    numbers = [re.findall(r"[-+]\d+\.\d+", line) for line in done.stdout.splitlines()]
    load, friction, sent = (float(text) for text in numbers[2][1:])
    assert friction > 1.3 + 0.1 * abs(load) - 0.2
    assert sent == pytest.approx(load + friction, abs=0.02)


@pytest.mark.skipif(shutil.which("gcc") is None or shutil.which("make") is None, reason="gcc or make is not installed")
@pytest.mark.parametrize("extended", [False, True])
def test_c_example_builds_and_runs(model: Path, tmp_path: Path, extended: bool) -> None:
    if extended:
        law = load_model(model).law
        save_model(FrictionModel(FrictionLaw((*law.terms, Cogging(0.02, 0.01, 7.0)))), model)
    folder = tmp_path / "c"
    shutil.copytree(EXAMPLES / "c", folder)
    arguments = [f"MODEL={model}", f"FRICOMP={sys.executable} -m fricomp.cli.main", "CC=gcc"]
    done = subprocess.run(["make", "-s", *arguments], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("N*m") == 20
