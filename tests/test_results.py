"""The rule of every writer: what is there is replaced by --overwrite alone, and what is somebody else's by nothing."""

from pathlib import Path

import pytest

from fricomp.errors import OutputError, ParameterError
from fricomp.folder_lock import LOCK_FILE
from fricomp.result_kinds import CALIBRATION, DIAGNOSIS, FIGURES, IDENTIFICATION, RUN, Results
from fricomp.results import claim_folder, plain_name, require_free, require_free_file

RECORDS = {
    CALIBRATION: ("run.json", '{"schema": "fricomp.run/1"}'),
    DIAGNOSIS: ("diagnosis.json", '{"schema": "fricomp.diagnosis/1"}'),
}


def _put(folder: Path, results: Results, *names: str) -> None:
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).write_text("old")
    if results in RECORDS:
        name, content = RECORDS[results]
        (folder / name).write_text(content)


@pytest.mark.parametrize("results", [CALIBRATION, DIAGNOSIS, IDENTIFICATION, RUN])
def test_results_of_the_kind_are_replaced_by_the_option_alone(results: Results, tmp_path: Path) -> None:
    name = results.files[-1].replace("*", "1")
    _put(tmp_path, results, name)
    with pytest.raises(OutputError, match=rf"holds .*{name}.* already: replace .* \(--overwrite\), or choose another"):
        require_free(tmp_path, results)
    require_free(tmp_path, results, overwrite=True)


@pytest.mark.parametrize("overwrite", [False, True])
@pytest.mark.parametrize(
    ("there", "wanted"),
    [(CALIBRATION, IDENTIFICATION), (DIAGNOSIS, IDENTIFICATION), (CALIBRATION, DIAGNOSIS), (DIAGNOSIS, CALIBRATION)],
)
def test_results_of_another_kind_are_never_replaced(
    there: Results, wanted: Results, overwrite: bool, tmp_path: Path
) -> None:
    _put(tmp_path, there, "friction.json")
    with pytest.raises(OutputError, match=rf"holds {there.kind} .*would replace files of it: choose another --out"):
        require_free(tmp_path, wanted, overwrite=overwrite)


def test_a_run_replaces_no_figures_that_are_not_of_a_run(tmp_path: Path) -> None:
    _put(tmp_path, FIGURES, "figures.json", "timing.png")
    with pytest.raises(OutputError, match="comes from something else: choose another --out"):
        require_free(tmp_path, RUN, overwrite=True)


def test_a_calibration_that_has_no_model_yet_keeps_its_folder_too(tmp_path: Path) -> None:
    _put(tmp_path, CALIBRATION, "recording.csv")
    with pytest.raises(OutputError, match="holds a calibration"):
        require_free(tmp_path, IDENTIFICATION)


def test_a_recorded_motion_and_results_with_other_names_share_a_folder(tmp_path: Path) -> None:
    _put(tmp_path, CALIBRATION, "recording.csv", "motion-alone.csv")
    require_free(tmp_path, RUN)
    (tmp_path / "run.json").write_text('{"schema": "fricomp.run/1", "request": {"motion": "wanted.csv"}}')
    require_free(tmp_path, DIAGNOSIS, inputs=[tmp_path / "motion-alone.csv"])
    _put(tmp_path, DIAGNOSIS)
    require_free(tmp_path, DIAGNOSIS, overwrite=True)


@pytest.mark.parametrize("overwrite", [False, True])
def test_links_are_not_followed(overwrite: bool, tmp_path: Path) -> None:
    (tmp_path / "friction.json").symlink_to(tmp_path / "nowhere")
    with pytest.raises(OutputError, match=r"holds the link friction.json, which is not followed: remove it"):
        require_free(tmp_path, IDENTIFICATION, overwrite=overwrite)
    with pytest.raises(OutputError, match="is a link"):
        require_free_file(tmp_path / "friction.json", overwrite=overwrite)


def test_an_input_is_never_written_over(tmp_path: Path) -> None:
    model = tmp_path / "friction.json"
    _put(tmp_path, IDENTIFICATION, model.name)
    with pytest.raises(OutputError, match="would write over its input"):
        require_free(tmp_path, IDENTIFICATION, overwrite=True, inputs=[tmp_path / "." / model.name])
    with pytest.raises(OutputError, match="was read, and would be written over"):
        require_free_file(model, overwrite=True, inputs=[tmp_path / "." / model.name])


def test_one_file_is_replaced_by_the_option_alone(tmp_path: Path) -> None:
    path = tmp_path / "friction.h"
    require_free_file(path)
    path.write_text("old")
    with pytest.raises(OutputError, match=r"is there already: replace it \(--overwrite\)"):
        require_free_file(path)
    require_free_file(path, overwrite=True)
    with pytest.raises(OutputError, match="is a folder"):
        require_free_file(tmp_path, overwrite=True)


def test_a_claim_that_fails_before_it_writes_leaves_no_folder(tmp_path: Path) -> None:
    with pytest.raises(ParameterError), claim_folder(tmp_path / "a" / "b", IDENTIFICATION):
        raise ParameterError("the data are bad")
    assert list(tmp_path.iterdir()) == []


def test_a_claim_removes_the_old_results_when_told_and_nothing_else(tmp_path: Path) -> None:
    _put(tmp_path, IDENTIFICATION, "friction.json", "training.png", "points.csv")
    with claim_folder(tmp_path, IDENTIFICATION, overwrite=True) as claim:
        assert (tmp_path / "friction.json").exists()
        claim.clear()
        assert {path.name for path in tmp_path.iterdir()} == {"points.csv", LOCK_FILE}
    assert {path.name for path in tmp_path.iterdir()} == {"points.csv"}


def test_unfinished_results_are_made_again_without_the_option(tmp_path: Path) -> None:
    def begin() -> None:
        (tmp_path / "report.html").write_text("half of the results")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), claim_folder(tmp_path, IDENTIFICATION):
        begin()
    with pytest.raises(OutputError, match=r"report.html already"):
        require_free(tmp_path, IDENTIFICATION)
    with claim_folder(tmp_path, IDENTIFICATION) as claim:
        claim.clear()
    assert list(tmp_path.iterdir()) == []


def test_finished_results_are_not_unfinished_by_a_later_failure(tmp_path: Path) -> None:
    _put(tmp_path, IDENTIFICATION, "friction.json")
    with pytest.raises(ParameterError), claim_folder(tmp_path, IDENTIFICATION, overwrite=True):
        raise ParameterError("the data are bad")
    with pytest.raises(OutputError, match="--overwrite"), claim_folder(tmp_path, IDENTIFICATION):
        pass
    assert (tmp_path / "friction.json").read_text() == "old"


@pytest.mark.parametrize(
    ("name", "plain"),
    [("left elbow", "left elbow"), ("../../etc/x", "_.._etc_x"), ("a\x1b]0;b\x07", "a__0_b_"), ("..", "joint")],
)
def test_a_joint_leads_into_no_other_folder(name: str, plain: str) -> None:
    assert plain_name(name) == plain
