"""What the page shows by core, motion, noise, strength and effect."""

import math
from pathlib import Path

from fricomp.sim_bench.cases import CHOICES
from fricomp.sim_bench.studies.proof import Score, compute_figures, write_page
from fricomp.sim_bench.studies.proof.by_effect import format_coverage, format_places
from fricomp.sim_bench.studies.proof.intervals import KnownInterval
from fricomp.sim_bench.studies.proof.judging import answer_of
from fricomp.sim_bench.studies.proof.splits import format_splits
from fricomp.sim_bench.studies.proof.wrong import format_misses
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
    text = format_splits([*_nulls(dahl=1.1), *singles, score_of(enr=0.2, truth="cogging", core="dahl")])
    assert "| friction core | dahl | 6 | 1.100 | 1.10 to 1.10 | 0 |" in text
    assert "| friction core | gms | 0.0% (0 of 1;" in text
    assert "| friction core | dahl | 100.0% (1 of 1;" in text  # the weak one stays out
    assert "| strength | ENR 0.5 to 1 | 50.0% (1 of 2;" in text
    assert format_splits([score_of("fault")]) == ""


def test_coverage_and_place_are_told_by_effect() -> None:
    held, missed = (KnownInterval("drive_lag", "time_constant", truth, 1.0, 0.9, 1.1) for truth in (1.05, 2.0))
    covered = [score_of(intervals=(missed,)), score_of(intervals=(held,)), score_of()]
    bare = score_of(truth="end_stop", named="end_stop")
    text = format_coverage([*covered, bare])
    assert "| drive_lag | 2 | 50% (1 of 2) |" in text
    assert "| end_stop | 0 | none |" in text
    assert format_coverage([score_of()]) == ""
    placed = [score_of(truth="end_stop", enr=enr, overlap=overlap) for enr, overlap in ((0.1, 0.0), (2.0, 0.8))]
    assert "| end_stop | 2 | 0.40 (0.00 to 0.80) | 1 | 0.80 (0.80 to 0.80) |" in format_places(placed)
    assert format_places([score_of(overlap=math.nan)]) == ""


def test_weak_misses_that_count_in_a_figure_are_listed_apart_from_wrong_answers(tmp_path: Path) -> None:
    weak = score_of(enr=0.3, weakest_enr=0.3, truth="cogging", expected="missing_physics", command="make weak")
    weaker = score_of(enr=0.1, weakest_enr=0.1, truth="cogging", expected="missing_physics", command="make weaker")
    assert "make weak`" in format_misses([weak, weaker])
    assert "make weaker" not in format_misses([weak, weaker])
    many = [score_of("null", false_names=1, named="cogging", command=f"make {n}.") for n in range(80)]
    write_page([*many, weak], tmp_path / "proof.md", title="A test.", reproduce="fricomp bench mismatch")
    text = (tmp_path / "proof" / "details.md").read_text()
    assert "80 of 81 answers" in text
    assert all(f"make {n}." in text for n in range(80))
    assert text.index("make weak") > text.index("## Other misses that count")


def test_the_answer_of_a_case_is_the_right_name_where_the_load_is_off_as_well() -> None:
    assert answer_of(score_of(truth="cogging", named="payload_error+cogging", top_right=True)) == "cogging"
    assert answer_of(score_of(truth="cogging", named="spring_torque+cogging")) == "spring_torque"
    assert answer_of(score_of(verdict="unknown_physics")) == "(unknown_physics)"
