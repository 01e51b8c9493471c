from pathlib import Path

import pytest
from typer.testing import CliRunner

from fricomp.cli.bench.paper import app


@pytest.mark.slow
def test_a_page_is_written_from_what_there_is(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    call = ["--out", str(tmp_path / "run"), "--docs", str(tmp_path / "docs" / "page.md"), "--page-only"]
    (tmp_path / "docs").mkdir()
    done = CliRunner().invoke(app, call)
    assert done.exit_code == 0, done.output
    for page in (tmp_path / "run" / "identification.md", tmp_path / "docs" / "page.md"):
        assert "PSO (paper)" in page.read_text(encoding="utf-8")
        assert (page.with_suffix("") / "data.png").exists()
        assert (page.with_suffix("") / "figures.json").exists()
