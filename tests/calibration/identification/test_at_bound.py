"""A number that stands at its bound is said to be there, wherever it is shown."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.calibration import identify
from fricomp.cli.main import app
from fricomp.laws import FloatArray
from fricomp.overview import AT_BOUND, format_with_reach

_SPEED = np.geomspace(0.01, 2.0, 25)
VELOCITY = np.concatenate([_SPEED, -_SPEED])
VISCOUS = ("stribeck.forward.viscous_coefficient", "stribeck.reverse.viscous_coefficient")


def _torque(viscous: float) -> FloatArray:
    """A Stribeck curve whose viscous slope may be negative, which no law allows; noise of 0.5 %."""
    bend = 0.3 * np.exp(-((np.abs(VELOCITY) / 0.1) ** 2))
    noise = 1.0 + 0.005 * np.random.default_rng(0).standard_normal(VELOCITY.size)
    return np.asarray(np.sign(VELOCITY) * (0.5 + bend + viscous * np.abs(VELOCITY)) * noise)


@pytest.mark.parametrize(("viscous", "ended"), [(-0.01, VISCOUS), (0.05, ())])
def test_a_slope_that_the_data_want_negative_is_at_its_bound(viscous: float, ended: tuple[str, ...]) -> None:
    result = identify(VELOCITY, _torque(viscous))
    assert result.at_bound == ended
    assert result.summary().count(AT_BOUND) == len(ended)
    for name in ended:
        assert result.parameters[name] < 1e-9


def test_terminal_json_and_report_say_so(tmp_path: Path) -> None:
    table = tmp_path / "points.csv"
    rows = zip(VELOCITY.tolist(), _torque(-0.01).tolist(), strict=True)
    table.write_text("velocity,torque\n" + "".join(f"{v},{tau}\n" for v, tau in rows))
    call = ["identify", str(table), "--method", "least_squares", "--overwrite", "--out", str(tmp_path / "out")]
    said = CliRunner().invoke(app, call, env={"COLUMNS": "120"}).stdout
    assert said.count(AT_BOUND) == 2
    answer = json.loads(CliRunner().invoke(app, [*call, "--json"]).stdout)
    ended = [name for name, found in answer["parameters"].items() if found["at_bound"]]
    assert tuple(ended) == VISCOUS
    assert (tmp_path / "out" / "report.html").read_text().count(AT_BOUND) >= 2


def test_the_interval_stays_beside_it() -> None:
    assert format_with_reach(1e-12, 0.0043, at_bound=True) == "0.0000 ± 0.0043, at the bound"
    assert format_with_reach(1e-12, float("inf"), at_bound=True) == "cannot be determined, at the bound"
