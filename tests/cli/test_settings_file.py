"""`--settings`: a file takes the place of defaults, the command line wins, and nothing in it is ignored."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from fricomp.calibration.sweep import CalibrationRequest
from fricomp.cli.main import app
from fricomp.errors import FricompError, OutputError


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[CalibrationRequest]:
    """What a calibration was asked to be; nothing moves."""
    requests: list[CalibrationRequest] = []

    def noted(request: CalibrationRequest, *_: Any, **__: Any) -> None:
        requests.append(request)

    monkeypatch.setattr("fricomp.cli.calibration.start.start_run", noted)
    return requests


def _calibrate(*arguments: object) -> Any:
    return CliRunner().invoke(app, ["calibrate", *map(str, arguments)])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "sweep.toml"


def test_a_file_takes_the_place_of_defaults_and_the_command_line_wins(
    file: Path, asked: list[CalibrationRequest]
) -> None:
    file.write_text(
        "repeats = 5\ndwell = 2\nspeeds = [0.1, 0.5, 1.5]\nnormal_load = 3\nwarm-up = 1.5\nadaptive = true\n"
    )
    assert _calibrate("--settings", file, "--repeats", "3").exit_code == 0
    (request,) = asked
    assert (request.settings.repeats, request.settings.dwell, request.settings.warm_up) == (3, 2.0, 1.5)
    assert request.settings.speeds == "0.1,0.5,1.5"
    assert (request.options.normal_load, request.options.adaptive) == ("3", True)


def test_paths_count_from_the_folder_of_the_file(
    file: Path, asked: list[CalibrationRequest], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    (tmp_path / "joint.toml").write_text('backend = "sim"\nseed = 4\n')
    file.write_text('config = "joint.toml"\nmodel = "arm.xml"\n')
    assert _calibrate("--settings", file).exit_code == 0
    assert asked[0].configuration["seed"] == 4
    assert asked[0].model == str(tmp_path / "arm.xml")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("dwel = 2", "no option 'dwel'; did you mean dwell?"),
        ("xyzzy = 2", "no option 'xyzzy'; known are backend, config"),
        ('dwell = "x"', "dwell = 'x' does not fit: Expected float, got str"),
        ("dwell = true", "Expected float, got bool"),
        ("repeats = 2.5", "Expected int, got float"),
        ('loop = "both"', "loop = 'both' does not fit"),
        ("adaptive = 1", "Expected bool, got int"),
        ('speeds = ["a"]', "does not fit"),
        ('out = "runs/a"', "give it on the command line"),
        ("dwell = ", "cannot read the settings"),
        ("weight = 0.5", "--weight belongs to --torque-constant"),
    ],
)
def test_what_does_not_fit_is_refused_with_what_to_do(
    file: Path, asked: list[CalibrationRequest], line: str, words: str
) -> None:
    file.write_text(line)
    result = _calibrate("--settings", file)
    assert isinstance(result.exception, FricompError), result.output
    assert words in str(result.exception)
    assert not asked


def test_a_written_file_says_what_was_given_and_is_read_again(
    file: Path, asked: list[CalibrationRequest], tmp_path: Path
) -> None:
    result = _calibrate("--dwell", "2.5", "--loop", "host", "--adaptive", "--write-settings", file)
    assert result.exit_code == 0, result.output
    assert not asked
    text = file.read_text("utf-8")
    assert tomllib.loads(text) == {"dwell": 2.5, "loop": "host", "adaptive": True}
    assert "# repeats = 2" in text
    assert "# Time on a settled plateau [s]." in text
    assert "## Sweep" in text
    assert _calibrate("--settings", file).exit_code == 0
    assert (asked[0].settings.dwell, asked[0].settings.loop, asked[0].options.adaptive) == (2.5, "host", True)


def test_every_option_of_a_written_file_can_be_switched_on(
    file: Path, asked: list[CalibrationRequest], monkeypatch: pytest.MonkeyPatch
) -> None:
    _calibrate("--write-settings", file)
    lines = [line.removeprefix("# ") for line in file.read_text("utf-8").splitlines()]
    settings = [line for line in lines if " = " in line and not line.endswith('""')]
    file.write_text("\n".join(settings))
    assert len(settings) >= 15
    assert _calibrate("--settings", file).exit_code == 0
    assert asked[0].settings.dwell == 1.0


def test_a_file_is_not_written_over_unless_told(file: Path) -> None:
    file.write_text("dwell = 3\n")
    assert isinstance(_calibrate("--write-settings", file).exception, OutputError)
    assert file.read_text() == "dwell = 3\n"
    assert _calibrate("--write-settings", file, "--overwrite").exit_code == 0


@pytest.mark.parametrize(
    ("command", "headings"),
    [
        ("calibrate", ("Joint", "Sweep", "Identification", "Instead of a sweep", "Run")),
        ("identify", ("Friction", "Of a table", "Of a recording", "Of a fleet", "Output")),
        ("diagnose", ("Simulation", "Diagnosis", "Of a fleet", "Output")),
        ("run", ("Drive", "Loop", "Motion", "Output")),
    ],
)
def test_options_stand_under_headings(command: str, headings: tuple[str, ...]) -> None:
    shown = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "100"}).output
    places = [shown.index(f" {heading} ─") for heading in headings]
    assert places == sorted(places) or command != "calibrate"
    options = shown[shown.index(" Options ─") : shown.index("╰", shown.index(" Options ─"))]
    assert [word for word in options.split() if word.startswith("--")] == ["--help"]
