"""What will be needed is asked for before anything moves, is measured, or is thrown away."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fricomp import extras
from fricomp.calibration.sweep.motion.motion import MotionRunner
from fricomp.cli.main import app
from fricomp.control import ControlLoop
from fricomp.errors import MissingExtraError
from fricomp.laws import FrictionLaw, Viscous
from fricomp.model import FrictionModel, save_model


@pytest.fixture
def model(tmp_path: Path) -> Path:
    file = tmp_path / "friction.json"
    save_model(FrictionModel(FrictionLaw((Viscous(0.02),)), joint="joint"), file)
    return file


@pytest.mark.parametrize(
    ("command", "package", "extra"),
    [
        ("calibrate --out OUT", "plotly", "report"),
        ("calibrate --out OUT", "onnx", "calibrate"),
        ("calibrate --resume --out OUT", "jinja2", "report"),
        ("run MODEL --out OUT", "matplotlib", "report"),
        ("identify FILE --out OUT", "jinja2", "report"),
        ("identify FILE FILE --out OUT", "pyarrow", "parquet"),
        ("identify FILE --batch --out OUT", "pyarrow", "parquet"),
        ("diagnose FILE --out OUT", "matplotlib", "report"),
        ("diagnose FILE --out OUT", "ruptures", "diagnose"),
        ("diagnose FILE --each --out OUT", "pyarrow", "parquet"),
        ("bench adapters --out OUT", "damiao_motor", "dev"),
        ("bench adapters --out OUT", "robstride", "dev"),
    ],
)
def test_a_package_that_is_not_there_is_missed_before_anything_happens(
    tmp_path: Path, model: Path, monkeypatch: pytest.MonkeyPatch, command: str, package: str, extra: str
) -> None:
    def moved(*_: object, **__: object) -> None:
        pytest.fail("the joint moves")

    monkeypatch.setattr(MotionRunner, "start", moved)
    monkeypatch.setattr(ControlLoop, "run", moved)
    monkeypatch.setattr(extras, "find_spec", lambda name: None if name == package else find_spec(name))
    file = tmp_path / "recording.csv"
    file.write_text("time,position,torque\n0,0,0\n")
    words = {"OUT": str(tmp_path / "out"), "MODEL": str(model), "FILE": str(file)}
    result = CliRunner().invoke(app, [words.get(word, word) for word in command.split()])
    assert isinstance(result.exception, MissingExtraError), result.output
    assert str(result.exception).startswith(f"{package} is needed")
    assert f"[{extra}]" in str(result.exception)
    assert not (tmp_path / "out").exists()
