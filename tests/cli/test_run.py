"""`fricomp run` with options that would divide by zero or move nothing."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from fricomp.cli.main import app
from fricomp.errors import ParameterError


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--rate", "0", "above 0"),
        ("--frequency", "0", "above 0"),
        ("--frequency", "nan", "above 0"),
        ("--cycles", "-1", "above 0"),
        ("--amplitude", "0", "above 0"),
        ("--inertia", "0", "above 0"),
        ("--bandwidth", "inf", "finite"),
        ("--delay", "-0.001", "at least 0"),
        ("--velocity-filter", "nan", "at least 0"),
    ],
)
def test_an_option_outside_its_range_is_refused_with_its_name(
    tmp_path: Path, option: str, value: str, words: str
) -> None:
    out = tmp_path / "run"
    result = CliRunner().invoke(app, ["run", str(tmp_path / "friction.json"), option, value, "--out", str(out)])
    assert isinstance(result.exception, ParameterError), result.output
    assert str(result.exception).startswith(option)
    assert words in str(result.exception)
    assert not out.exists()
