"""Known effects in real recordings: what is added, how strong it is, and how the answers are scored."""

import json
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.fleet import SerialExecutor
from fricomp.recording import find_public_data, read_public
from fricomp.sim_bench.studies.kit.blind import BlindAnswer
from fricomp.sim_bench.studies.proof import (
    compute_figures,
    is_wrong,
    list_development_seeds,
    plan_bare,
    plan_injected,
    run_proof,
    write_page,
)
from fricomp.sim_bench.studies.real import INJECTABLE, REAL_CASES, InjectedSpec, inject
from fricomp.sim_bench.studies.real.injected_effect import INJECTED, measure_motion
from tests.sim_bench.studies.proof.answering import always_cogging, answer

_EMPS = pytest.mark.skipif(find_public_data("emps") is None, reason="the public data are not here")


def _motion() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    t = np.arange(20_000) * 1e-3
    q, v, a = np.sin(1.3 * t), 1.3 * np.cos(1.3 * t), -1.69 * np.sin(1.3 * t)
    return t, q, 0.5 * a + 2.0 * np.cos(q) + np.sign(v) + 0.3 * v + 0.05 * np.random.default_rng(0).normal(size=t.size)


@pytest.mark.parametrize("name", sorted(set(INJECTED) - {"torque_delay"}))
def test_an_effect_grows_with_its_amplitude_and_survives_the_refit(name: str) -> None:
    t, q, tau = _motion()
    motion = measure_motion(t, q, tau, float(np.ptp(q)))
    one, three = (INJECTED[name].build(motion, a, np.random.default_rng(1)).torque for a in (1.0, 3.0))
    np.testing.assert_allclose(three, 3.0 * one, atol=1e-12)
    assert np.std(motion.left_of(one)) > 0.0


def test_the_base_explains_a_rigid_joint_to_its_noise() -> None:
    t, q, tau = _motion()
    motion = measure_motion(t, q, tau, 2.0)
    assert np.std(motion.left) < 3.0 * 0.05 / np.sqrt(42.0)
    assert np.max(np.abs(motion.left_of(0.7 * motion.acceleration + 0.2))) < 1e-6


@_EMPS
def test_only_the_torque_is_changed_and_by_the_wanted_strength() -> None:
    from pyarrow import parquet

    made = inject(InjectedSpec("emps", "cogging", "2", 3), "salt")
    truth = json.loads(made.answer)
    assert truth["enr"] == pytest.approx(2.0, rel=0.03)
    first = parquet.read_table(BytesIO(made.files["recording.parquet"]))
    bare = parquet.read_table(BytesIO(inject(InjectedSpec("emps"), "salt").files["recording.parquet"]))
    np.testing.assert_array_equal(first.column("position"), bare.column("position"))
    added = first.column("torque").to_numpy() - bare.column("torque").to_numpy()
    p = {name: each["value"] for name, each in truth["effects"][0]["parameters"].items()}
    angle = p["order"] * first.column("position").to_numpy()
    np.testing.assert_allclose(added, p["sine"] * np.sin(angle) + p["cosine"] * np.cos(angle), atol=1e-9)
    assert "current" not in first.column_names  # the effect would not show in it
    np.testing.assert_array_equal(bare.column("torque"), read_public("emps/train")[0].torque)


def test_every_source_is_a_real_case_and_every_effect_can_be_injected() -> None:
    assert set(INJECTABLE) <= {case.name for case in REAL_CASES}
    assert {effect for effects in INJECTABLE.values() for effect in effects} == set(INJECTED)


def test_unknown_names_are_refused_with_the_valid_ones() -> None:
    with pytest.raises(RecordingError, match="valid are emps"):
        InjectedSpec("moon")
    with pytest.raises(RecordingError, match="valid are cogging"):
        InjectedSpec("emps", "gremlins")


@pytest.mark.slow
@_EMPS
def test_what_is_known_of_a_recording_is_neither_injected_nor_a_false_name(tmp_path: Path) -> None:
    pool = (SerialExecutor(), 1)
    bare = [each for each in plan_bare() if each.spec.source == "emps"]  # type: ignore[union-attr]

    def says_drag(files: dict[str, bytes]) -> BlindAnswer:
        return answer("missing_physics", ["quadratic_drag"])

    scores = run_proof(bare, tmp_path, pool, salt="s", diagnose=says_drag)
    planned = plan_injected(scores, list_development_seeds(0))
    effects = [each.spec.effect for each in planned]  # type: ignore[union-attr]
    assert "quadratic_drag" not in effects
    assert [each.spec.strength for each in planned][:3] == ["5", "5", "5"]

    def says_both(files: dict[str, bytes]) -> BlindAnswer:
        return answer("missing_physics", ["quadratic_drag", "cogging"])

    cogging = planned[effects.index("cogging")]
    (score,) = run_proof([cogging], tmp_path, pool, salt="s", diagnose=says_both)
    assert score.top_right
    assert score.exact
    assert score.false_names == 0
    assert score.noise == "recorded, missing_physics"
    assert not is_wrong(score)
    assert "fricomp cases inject emps --effect cogging --strength 5" in score.command
    wave = planned[effects.index("position_coulomb")]
    (missed,) = run_proof([wave], tmp_path, pool, salt="s", diagnose=always_cogging)
    assert missed.false_names == 1
    figures = compute_figures([*scores, score, missed])
    assert any("right name, recording with more missing already" in f.name and "1 of 2" in f.value for f in figures)
    page = tmp_path / "injected.md"
    write_page([*scores, score, missed], page, title="A test.", reproduce="fricomp bench mismatch --injected")
    assert "# Effects injected into real recordings" in page.read_text()
    assert "| emps | missing_physics | quadratic_drag |" in page.read_text()
