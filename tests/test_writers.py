"""Every writer of the product writes whole files, or has its reason; the benchmarks keep the one rule of results."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fricomp.cli.main import app
from fricomp.errors import OutputError
from fricomp.folder_lock import LOCK_FILE
from fricomp.sim_bench.studies.kit.folder import claim_run
from fricomp.sim_bench.studies.kit.page import replace_page, require_own_page

ROOT = Path(__file__).parents[1]
PARTS = ("fricomp", "adapters", "calibration", "sim_bench")
BARE = re.compile(
    r"\.write_text\(|\.write_bytes\(|open\((?:[^()]*, )?[\"'][wax]b?\+?[\"']|savefig\(|shutil\.copy|np\.savez?\("
)

REASONS = {
    "fricomp/whole_file.py": "the unfinished file itself",
    "fricomp/arm/output/evaluation.py": "a temporary folder",
    "fricomp/evaluation/mjcf_fit.py": "a temporary folder",
    "sim_bench/studies/speed/work.py": "a temporary folder",
    "fricomp/arm/record.py": "the unfinished file of whole_file",
    "fricomp/report/png.py": "the unfinished file of whole_file, or a stream",
    "fricomp/recording/writer.py": "a recording grows by whole blocks, one by one; a half one is known as such",
    "fricomp/recording/sources/mat_file.py": "a stream to the process that asked",
    "fricomp/fleet/run.py": "a folder of its own, moved into place as a whole",
    "sim_bench/studies/kit/store.py": "a ledger grows by whole lines; a half one is left out",
    "sim_bench/studies/proof/seal.py": "seals are only ever added, each on the disk before its case is diagnosed",
    "sim_bench/studies/kit/blind.py": "a temporary folder",
    "sim_bench/studies/kit/blind_diagnosis.py": "a temporary folder",
    "sim_bench/studies/adapters/bench.py": "a temporary folder",
    "sim_bench/studies/latency/loop_timing.py": "a temporary folder",
    "sim_bench/studies/latency/compensator.py": "a temporary folder",
    "sim_bench/twins/backend.py": "a temporary folder",
}
"""Files that write without `whole_file`, each with its reason."""


def bare_writers() -> set[str]:
    found = set()
    for part in PARTS:
        for path in (ROOT / part).rglob("*.py"):
            name = str(path.relative_to(ROOT))
            is_linked = name.startswith(("fricomp/adapters/", "fricomp/calibration/", "fricomp/sim_bench/"))
            if not is_linked and BARE.search(path.read_text("utf-8")):
                found.add(name)
    return found


def test_every_writer_writes_whole_files_or_has_its_reason() -> None:
    assert bare_writers() == set(REASONS)


@pytest.mark.parametrize(
    ("command", "record"),
    [
        (["bench", "real", "--only", "ur10e-joint-2"], "outcomes.jsonl"),
        (["bench", "second-generator", "--only", "backlash"], "scores.jsonl"),
        (["bench", "mismatch", "run", "--quick"], "answers"),
        (["bench", "mismatch", "gap", "--quick", "--cases", "1"], "gap"),
        (["bench", "paper", "--page-only"], "ledger.jsonl"),
        (["bench", "mismatch", "page", "--page", "docs/none.md"], "answers"),
    ],
)
def test_a_benchmark_leaves_a_folder_of_something_else_alone(command: list[str], record: str, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    result = CliRunner().invoke(app, [*command, "--out", str(tmp_path)])
    assert isinstance(result.exception, OutputError), result.output
    assert "comes from something else" in str(result.exception)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["notes.txt"]
    assert record not in str(result.exception)


@pytest.mark.parametrize("name", ["real", "second-generator"])
def test_a_study_that_is_there_is_replaced_by_the_option_alone(name: str, tmp_path: Path) -> None:
    record = {"real": "outcomes.jsonl", "second-generator": "scores.jsonl"}[name]
    (tmp_path / record).write_text("")
    result = CliRunner().invoke(app, ["bench", name, "--only", "none", "--out", str(tmp_path)])
    assert result.exit_code == 1  # no such case: nothing was looked at before
    with (
        pytest.raises(OutputError, match=r"holds .* already: replace it \(--overwrite\)"),
        claim_run(tmp_path, record, go_on=False),
    ):
        pytest.fail("it was let in")
    with claim_run(tmp_path, record):
        assert (tmp_path / LOCK_FILE).exists()
    assert not (tmp_path / LOCK_FILE).exists()


@pytest.mark.parametrize("name", ["tracking", "latency", "adapters"])
def test_the_figures_of_a_benchmark_are_replaced_by_the_option_alone(name: str, tmp_path: Path) -> None:
    (tmp_path / "figures.json").write_text("{}")
    result = CliRunner().invoke(app, ["bench", name, "--quick", "--out", str(tmp_path)])
    assert isinstance(result.exception, OutputError), result.output
    assert "--overwrite" in str(result.exception)
    assert (tmp_path / "figures.json").read_text() == "{}"


def test_a_page_replaces_an_earlier_one_of_its_kind_and_nothing_else(tmp_path: Path) -> None:
    page = tmp_path / "real.md"
    replace_page(page, "# The diagnosis on real recordings\n\nold\n", "real")
    require_own_page(page, "real")
    replace_page(page, "# The diagnosis on real recordings\n\nnew\n", "real")
    assert page.read_text().endswith("new\n")
    with pytest.raises(OutputError, match="choose another --page"):
        require_own_page(page, "second_generator")
    mine = tmp_path / "mine.md"
    mine.write_text("# My notes\n")
    with pytest.raises(OutputError, match="is there already, and is no page of this study"):
        require_own_page(mine, "real")
    with pytest.raises(OutputError, match="is there already, and is no page of this study"):
        replace_page(mine, "# Other\n", "real")
    assert mine.read_text() == "# My notes\n"
    link = tmp_path / "link.md"
    link.symlink_to(page)
    with pytest.raises(OutputError, match="a link, which is not followed"):
        replace_page(link, "# The diagnosis on real recordings\n", "real")


def test_a_benchmark_looks_at_its_page_before_it_works(tmp_path: Path) -> None:
    mine = tmp_path / "mine.md"
    mine.write_text("# My notes\n")
    out = tmp_path / "run"
    for command in (
        ["bench", "real", "--page", str(mine), "--out", str(out)],
        ["bench", "second-generator", "--page", str(mine), "--out", str(out)],
        ["bench", "paper", "--docs", str(mine), "--out", str(out)],
        ["bench", "mismatch", "run", "--quick", "--page", str(mine), "--out", str(out)],
    ):
        result = CliRunner().invoke(app, command)
        assert isinstance(result.exception, OutputError), result.output
        assert "is no page of this study" in str(result.exception)
    assert mine.read_text() == "# My notes\n"
    assert not out.exists()
