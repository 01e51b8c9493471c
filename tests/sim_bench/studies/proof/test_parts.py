"""What the page shows by core, motion, noise, strength and effect."""

import math
from pathlib import Path

from fricomp.sim_bench.cases import CHOICES
from fricomp.sim_bench.studies.kit.interval import KnownInterval
from fricomp.sim_bench.studies.proof import Score, compute_figures, write_page
from fricomp.sim_bench.studies.proof.judging import find_first_answer
from fricomp.sim_bench.studies.proof.parts import (
    list_coverage,
    list_misses,
    list_nothing,
    list_places,
    list_single,
)
from tests.sim_bench.studies.proof.scoring import score_of

_EVERYWHERE = "the same, median on every motion and with every friction core"


def _nulls(**ratios: float) -> list[Score]:
    """Every core on every motion, at 1 but where another ratio is given for one of them."""
    return [
        score_of("null", core=core, excitation=motion, noise_ratio=ratios.get(core, ratios.get(motion, 1.0)))
        for core in CHOICES["core"]
        for motion in CHOICES["excitation"]
    ]


def test_the_residual_must_stand_at_the_noise_on_every_motion_and_with_every_core() -> None:
    def figure(scores: list[Score]) -> tuple[bool | None, str]:
        return next((f.reached, f.value) for f in compute_figures(scores) if f.name == _EVERYWHERE)

    assert figure(_nulls())[0] is True
    assert figure(_nulls(gms=1.2)) == (False, "1 (sweep) to 1.2 (gms); 4 cases or more for each")
    partly = figure([s for s in _nulls() if s.excitation != "chirp"])
    assert partly[0] is False
    assert partly[1].endswith("none with chirp")


def test_the_split_tells_which_core_fails() -> None:
    singles = [score_of(enr=0.6, truth="cogging", top_right=core != "gms", core=core) for core in ("gms", "dahl")]
    nothing, single = list_nothing(_nulls(dahl=1.1)), list_single([*singles, score_of(enr=0.2, truth="cogging")])
    assert ["friction core", "dahl", "6", "1.100", "1.10 to 1.10", "0"] in nothing
    rights = {tuple(row[:2]): row[2] for row in single}
    assert rights["friction core", "gms"].startswith("0.0% (0 of 1;")
    assert rights["friction core", "dahl"].startswith("100.0% (1 of 1;")
    assert ("friction core", "lugre") not in rights  # the weak one stays out
    assert rights["strength", "ENR 0.5 to 1"].startswith("50.0% (1 of 2;")
    assert list_nothing([score_of("fault")]) == list_single([score_of("fault")]) == []


def test_coverage_and_place_are_told_by_effect() -> None:
    held, missed = (KnownInterval("drive_lag", "time_constant", truth, 1.0, 0.9, 1.1) for truth in (1.05, 2.0))
    covered = [score_of(intervals=(missed,)), score_of(intervals=(held,)), score_of()]
    first, last = list_coverage([*covered, score_of(truth="end_stop", named="end_stop")])
    assert first[:3] == ["drive_lag", "2", "50% (1 of 2)"]
    assert last[:3] == ["end_stop", "0", "none"]
    assert list_coverage([score_of()]) == []
    placed = [score_of(truth="end_stop", enr=enr, overlap=overlap) for enr, overlap in ((0.1, 0.0), (2.0, 0.8))]
    assert list_places(placed) == [["end_stop", "2", "0.40 (0.00 to 0.80)", "1", "0.80 (0.80 to 0.80)"]]
    assert list_places([score_of(overlap=math.nan)]) == []


def test_weak_misses_that_count_in_a_figure_are_listed_apart_from_wrong_answers(tmp_path: Path) -> None:
    weak = score_of(enr=0.3, weakest_enr=0.3, truth="cogging", expected="missing_physics", command="make weak")
    weaker = score_of(enr=0.1, weakest_enr=0.1, truth="cogging", expected="missing_physics", command="make weaker")
    assert [row[-1] for row in list_misses([weak, weaker])] == ["`make weak`"]
    many = [score_of("null", false_names=1, named="cogging", command=f"make {n}.") for n in range(80)]
    write_page([*many, weak], tmp_path / "proof.md", title="A test.", reproduce="fricomp bench mismatch")
    text = (tmp_path / "proof" / "details.md").read_text()
    assert "80 of 81 answers" in text
    assert all(f"make {n}." in text for n in range(80))
    assert text.index("make weak") > text.index("## Other misses that count")


def test_the_answer_of_a_case_is_the_right_name_where_the_load_is_off_as_well() -> None:
    assert find_first_answer(score_of(truth="cogging", named="payload_error+cogging", top_right=True)) == "cogging"
    assert find_first_answer(score_of(truth="cogging", named="spring_torque+cogging")) == "spring_torque"
    assert find_first_answer(score_of(verdict="unknown_physics")) == "(unknown_physics)"
