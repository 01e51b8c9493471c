"""Every writer of the product writes whole files, or has its reason; the benchmarks keep the one rule of results."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.cli.main import app
from fricomp.errors import OutputError
from fricomp.folder_lock import LOCK_FILE
from fricomp.laws import FrictionLaw, Stribeck, StribeckCurve
from fricomp.model import FrictionModel, Provenance, Validity, save_model
from fricomp.sim_bench.cases import CaseSpec, derive_case_id
from fricomp.sim_bench.cases.arm import arm_id, draw_spec
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
    "fricomp/recording/sources/own_process.py": "a stream to the process that asked",
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


FIGURE_FOLDERS = ["tracking", "latency", "adapters", "speed", "stand-in", "logs", "fleet", "calibrate", "motion"]


@pytest.mark.parametrize("name", FIGURE_FOLDERS)
def test_a_benchmark_that_another_process_writes_is_left_to_it(name: str, tmp_path: Path) -> None:
    with held_by_another(tmp_path) as pid:
        result = CliRunner().invoke(app, ["bench", name, "--quick", "--overwrite", "--out", str(tmp_path)])
        assert isinstance(result.exception, OutputError), result.output
        assert f"is being written by process {pid}" in str(result.exception)
    assert [path.name for path in tmp_path.iterdir()] in ([], [LOCK_FILE])


MODEL, LOG = "friction.json", "log.csv"
SINGLE_FILES = {
    "out.h": ["export", MODEL, "--to", "c", "--out", "out.h"],
    "out.onnx": ["export", MODEL, "--to", "onnx", "--out", "out.onnx"],
    "out.csv": ["convert", LOG, "--out", "out.csv"],
    "out.toml": ["convert", LOG, "--inspect", "--out", "out.toml"],
    "out.html": ["watch", ".", "--out", "out.html"],
    "gain-scan.png": ["check-loop", MODEL, "--inertia", "0.1", "--bandwidth", "5", "--out", "."],
    "settings.toml": ["calibrate", "--backend", "sim", "--write-settings", "settings.toml"],
    "drive.toml": ["twin", "mit", "--write-config", "drive.toml"],
    "drive.endpoints.json": ["twin", "odrive", "--write-config", "drive.toml"],
    "out.mcap": ["calibrate", "--backend", "sim", "--out", "run", "--log", "out.mcap"],
    "run.mcap": ["run", MODEL, "--backend", "sim", "--inertia", "0.1", "--out", "run", "--log", "run.mcap"],
}
"""Commands that write one file, by its name; they run in a folder with a model and a log."""


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    law = FrictionLaw((Stribeck(StribeckCurve(0.2, 0.5, 0.05, 0.1)),))
    provenance = Provenance(created="2026-01-01T00:00:00+00:00")
    save_model(FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0)), provenance=provenance), tmp_path / MODEL)
    time = np.arange(0.0, 4.0, 0.01)
    table = np.column_stack([time, np.sin(time), 0.3 * np.cos(time)])
    np.savetxt(tmp_path / LOG, table, delimiter=",", header="time,position,torque", comments="")
    return tmp_path


@pytest.mark.parametrize("name", SINGLE_FILES)
def test_a_file_that_another_process_writes_is_left_to_it(name: str, place: Path) -> None:
    with held_by_another(place / name, "take_file") as pid:
        result = CliRunner().invoke(app, [*SINGLE_FILES[name], "--overwrite"])
        assert isinstance(result.exception, OutputError), result.output
        assert f"{name} is being written by process {pid} since" in str(result.exception)
        assert not (place / name).exists()
    assert {path.name for path in place.iterdir()} == {MODEL, LOG}


@pytest.mark.parametrize("name", ["out.h", "out.csv", "settings.toml"])
def test_other_files_of_its_folder_are_free_until_the_folder_is_held(name: str, place: Path) -> None:
    with held_by_another(place / "other.txt", "take_file"):
        result = CliRunner().invoke(app, SINGLE_FILES[name])
        assert result.exit_code == 0, result.output
        assert (place / name).exists()
    with held_by_another(place) as pid:
        result = CliRunner().invoke(app, [*SINGLE_FILES[name], "--overwrite"])
        assert f"is being written by process {pid} since" in str(result.exception)


@pytest.mark.parametrize("arm", [False, True])
def test_a_case_that_another_process_makes_is_left_to_it(arm: bool, tmp_path: Path) -> None:
    asked = ["cases", "make", "--seed", "3", "--duration", "20", "--out", str(tmp_path / "cases")]
    asked += ["--arm"] if arm else ["--effect", "cogging"]
    name = arm_id(draw_spec(3, 20.0)) if arm else derive_case_id(CaseSpec(3, ("cogging",), duration=20.0))
    case, answer = tmp_path / "cases" / name, tmp_path / "cases.answers" / f"{name}.json"
    for held, way in ((case, "take"), (answer, "take_file")):
        held.parent.mkdir(exist_ok=True)
        case.mkdir(exist_ok=True)
        with held_by_another(held, way) as pid:
            result = CliRunner().invoke(app, [*asked, "--overwrite"])
            assert isinstance(result.exception, OutputError), result.output
            assert f"is being written by process {pid} since" in str(result.exception)


@contextmanager
def held_by_another(place: Path, way: str = "take") -> Iterator[int]:
    """A process that holds the lock on a folder, or (`take_file`) on a file; its number."""
    code = "import sys; from pathlib import Path; from fricomp.folder_lock import FolderLock\n"
    code += f"lock = FolderLock.{way}(Path(sys.argv[1])); print('holds', flush=True); sys.stdin.readline()"
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(place)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "holds\n"
    try:
        yield process.pid
    finally:
        process.communicate("\n")


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
