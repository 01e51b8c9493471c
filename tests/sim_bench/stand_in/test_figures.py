"""The figures that `fricomp bench stand-in` prints, all but the speed, which depends on the machine."""

from __future__ import annotations

import json
from pathlib import Path

from typer.testing import CliRunner

from fricomp.cli.bench.stand_in import app
from fricomp.sim_bench.stand_in import default_joint
from fricomp.sim_bench.stand_in.figures import measure


def test_the_default_joint_is_within_its_figures() -> None:
    figures = measure(default_joint(), seconds=2.0)
    assert figures.creep < 1e-4
    assert figures.largest_power < 1e-5
    assert figures.largest_work <= 0.0
    assert figures.curve_error < 5e-3
    assert figures.real_time_factor > 0.0


def test_the_benchmark_writes_what_it_measured(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["--quick", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    written = json.loads((tmp_path / "figures.json").read_text())
    assert set(written) == {"creep", "largest_power", "largest_work", "curve_error", "real_time_factor"}
    assert f"{written['creep']:.2g}" in result.output
