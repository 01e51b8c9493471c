"""Figures that are not reached carry their cause."""

from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError
from fricomp.sim_bench.studies.proof import compute_figures, write_page
from fricomp.sim_bench.studies.proof.causes import explain_misses, read_causes
from tests.sim_bench.studies.proof.scoring import score_of

_NAME = "right name, rich motion, ENR ≥ 0.2"
_SCORES = [score_of(enr=0.3, truth="cogging", core="gms"), score_of(enr=6.0, truth="cogging", top_right=True)]


def test_a_figure_that_is_not_reached_stands_in_the_page_with_its_cause_and_its_parts(tmp_path: Path) -> None:
    (tmp_path / "proof").mkdir()
    (tmp_path / "proof" / "causes.toml").write_text(f'"{_NAME}" = """\nThe bristle\ntakes it."""\n', encoding="utf-8")
    write_page(_SCORES, tmp_path / "proof.md", title="A test.", reproduce="fricomp bench mismatch")
    text = (tmp_path / "proof.md").read_text()
    assert f"**{_NAME}** (≥ 95%; 50.0% (1 of 2; 1.3% to 98.7%)). The bristle takes it." in text
    assert "- by strength: ENR 0.2 to 0.5: 0 of 1; ENR 5 or more: 1 of 1" in text
    assert "- by friction core: gms: 0 of 1; lugre: 1 of 1" in text


def test_a_cause_that_nobody_knows_is_told_as_such_and_a_figure_that_is_reached_has_none() -> None:
    texts = {miss.name: miss.text for miss in explain_misses(compute_figures(_SCORES), {})}
    assert texts[_NAME] == "Not looked into yet."
    assert "no answer at all" not in texts


@pytest.mark.parametrize("content", ["not toml", "[table]\na = 1\n"])
def test_a_file_of_causes_that_holds_anything_else_is_refused(tmp_path: Path, content: str) -> None:
    assert read_causes(tmp_path) == {}
    (tmp_path / "causes.toml").write_text(content)
    with pytest.raises(DiagnosisError, match=r"causes\.toml"):
        read_causes(tmp_path)
