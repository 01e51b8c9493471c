"""The held-out gap that is closed, counted from a floor that no answer can move."""

import io
import math
from itertools import count
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from pyarrow import parquet
from typer.testing import CliRunner

from fricomp.cli.bench.mismatch import gap
from fricomp.diagnosis import HeldOut
from fricomp.fleet import SerialExecutor
from fricomp.sim_bench.cases import CATALOGUE, CaseSpec, generate
from fricomp.sim_bench.studies.kit.blind import BlindAnswer
from fricomp.sim_bench.studies.proof import GAP, GapScore, PlannedCase, format_gaps, measure_gaps, plan_gaps
from tests.sim_bench.studies.proof.answering import answer

_SPEC = CaseSpec(1, ("cogging",), "clear", "rich", 8.0, "white", "dahl", "harmonic")


def _errors(before: float, after: float, floor: float, *, given: bool = False) -> dict[str, Any]:
    held = HeldOut(
        rmse_before=before,
        rmse_after=after,
        noise_floor=floor,
        unit="N·m",
        ci95_reduction=(0.0, 1.0),
        explained=0.9,
        before="given" if given else "refitted",
    )
    errors: dict[str, Any] = msgspec.to_builtins(held)
    return errors


class _Answers:
    """A diagnosis that first leaves half of an error and calls it noise; without the effect less is left."""

    def __init__(self) -> None:
        self.seen: list[dict[str, bytes]] = []

    def __call__(self, files: dict[str, bytes]) -> BlindAnswer:
        self.seen.append(files)
        if len(self.seen) == 1:
            return answer("missing_physics", ["cogging"], heldout=_errors(0.4, 0.2, 0.2))
        return answer("consistent", heldout=_errors(0.1, 0.1, 0.1))


def _column(files: dict[str, bytes], name: str) -> np.ndarray:
    table = parquet.read_table(io.BytesIO(files["recording.parquet"]))
    return np.asarray(table.column(name).to_numpy())


def _gap(before: float | None, after: float | None, reachable: float | None, right: bool = True) -> GapScore:
    return GapScore("case-1", "cogging", "cogging", right, before, after, reachable, after)


def test_the_floor_is_that_of_the_recording_without_the_concealed_torque(tmp_path: Path) -> None:
    answers = _Answers()
    (score,) = measure_gaps([PlannedCase("single", _SPEC)], tmp_path, (SerialExecutor(), 1), diagnose=answers)
    assert score.top_right
    assert score.floor == score.after  # by which all would be closed
    assert score.closed == pytest.approx((0.4**2 - 0.2**2) / (0.4**2 - 0.1**2))
    case = generate(_SPEC)
    for name, scale in (("torque", 1.0), ("torque_command", 1.0), ("current", 0.1 * case.scene.joint.gear_ratio)):
        taken = _column(answers.seen[0], name) - _column(answers.seen[1], name)
        np.testing.assert_allclose(taken * scale, case.outcome.torque, atol=1e-9)
    metadata = [parquet.read_schema(io.BytesIO(files["recording.parquet"])).metadata for files in answers.seen]
    assert metadata[0] == metadata[1]
    np.testing.assert_array_equal(_column(answers.seen[0], "position"), _column(answers.seen[1], "position"))


def test_reachable_is_the_error_of_the_refitted_joint_where_parameters_were_off(tmp_path: Path) -> None:
    def diagnose(files: dict[str, bytes]) -> BlindAnswer:
        return answer("parameters", ["payload_error"], heldout=_errors(0.3, 0.1, 0.1, given=True))

    (score,) = measure_gaps([PlannedCase("single", _SPEC)], tmp_path, (SerialExecutor(), 1), diagnose=diagnose)
    assert (score.before, score.after, score.reachable) == (0.1, 0.1, 0.1)


def test_what_is_measured_is_not_measured_again(tmp_path: Path) -> None:
    planned, pool, answers = [PlannedCase("single", _SPEC)], (SerialExecutor(), 1), _Answers()
    first = measure_gaps(planned, tmp_path, pool, diagnose=answers)
    assert measure_gaps(planned, tmp_path, pool, diagnose=answers) == first
    assert len(answers.seen) == 2


def test_there_is_no_share_where_there_is_no_gap_or_no_error() -> None:
    assert math.isnan(_gap(0.105, 0.1, 0.1).closed)
    assert math.isnan(_gap(0.4, 0.2, None).closed)
    assert math.isnan(_gap(None, None, 0.1).closed)


def test_cases_are_single_torques_on_the_joint_that_can_be_seen() -> None:
    planned = plan_gaps(70, count(), 8.0)
    assert len(planned) == 70
    for each in planned:
        assert isinstance(each.spec, CaseSpec)
        (name,) = each.spec.effects
        assert CATALOGUE[name].kind == "physics"
        assert each.spec.strength not in ("0.1", "0.2")
    assert plan_gaps(5, count(), 8.0) == planned[:5]  # a longer measurement begins with a shorter one


def test_the_table_tells_right_names_from_all() -> None:
    scores = [_gap(0.4, 0.2, 0.1), _gap(0.4, 0.4, 0.1, right=False), _gap(0.1, 0.1, 0.1)]
    text = format_gaps(scores, "fricomp bench", "Measured on a day.")
    assert "Measured on a day. Each case is diagnosed twice" in text
    assert (
        "| right name first | ≥ 0.95 | median 0.8 (0.8 to 0.8, all; 1 cases) | median 1 (1 to 1, all; 1 cases) |"
        in text
    )
    assert "| all | – | median 0.4 (0 to 0.8, all; 2 cases) |" in text
    assert "3 cases; 1 of them have no gap" in text
    assert "right name first | ≥ 0.95 | – (no case) |" in format_gaps([], "fricomp bench", "Never.")


def test_the_command_writes_the_table_beside_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from fricomp.sim_bench.studies import proof

    monkeypatch.setattr(proof, "measure_gaps", lambda planned, *_, **__: [_gap(0.4, 0.2, 0.1)] * len(planned))
    options = ["--cases", "3", "--quick", "--executor", "serial", "--out", str(tmp_path / "run")]
    told = CliRunner().invoke(gap.app, [*options, "--page", str(tmp_path / "proof.md")], catch_exceptions=False)
    assert "fricomp bench mismatch gap --cases 3 --quick --first-seed 0 --out runs/run" in told.stdout
    assert "3 cases" in (tmp_path / "proof" / GAP).read_text()
