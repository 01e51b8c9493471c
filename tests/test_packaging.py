"""The folders are one package, and the core stays light."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
import yaml
from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).parents[1]
HEAVY = ("torch", "mujoco", "onnxruntime", "onnx", "can", "canopen", "serial", "matplotlib", "plotly", "scipy", "numba")


def test_the_fixed_folders_are_linked_into_the_package() -> None:
    for folder in ("adapters", "calibration", "sim_bench"):
        link = ROOT / "fricomp" / folder
        assert link.is_symlink()
        assert link.resolve() == ROOT / folder


def test_importing_fricomp_pulls_in_no_extra() -> None:
    code = f"import sys, fricomp; print(sorted(set({HEAVY!r}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("folder", ["adapters", "calibration", "sim_bench"])
def test_a_linked_folder_is_imported_as_a_part_of_fricomp_only(folder: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", f"import {folder}"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith(f"ImportError: {folder} is a part of fricomp")
    assert done.stderr.splitlines()[-1].endswith(f"import fricomp.{folder}")
    subprocess.run([sys.executable, "-c", f"import fricomp.{folder}"], cwd=ROOT, check=True)


def test_the_lock_pins_every_direct_dependency() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    wanted = [
        *project["dependencies"],
        *(line for extra in project["optional-dependencies"].values() for line in extra),
    ]
    names = {re.split(r"[\[<>=!~ ]", line)[0].lower() for line in wanted} - {"fricomp"}
    pinned = {line.split("==")[0].lower() for line in (ROOT / "requirements.lock").read_text("utf-8").split()}
    assert names <= pinned, names - pinned
    assert all("==" in line for line in (ROOT / "requirements.lock").read_text("utf-8").split())


@pytest.mark.parametrize("python", ["3.11.0", "3.12.0", "3.13.0"])
def test_what_the_lock_pins_installs_on_every_python_that_the_readme_names(python: str) -> None:
    for line in (ROOT / "requirements.lock").read_text("utf-8").split():
        name, pinned = line.split("==")
        wanted = ",".join(metadata.metadata(name).get_all("Requires-Python") or ())
        installed = metadata.version(name) == pinned  # another version here says nothing of the one that is pinned
        assert not installed or SpecifierSet(wanted).contains(python), f"{line} asks for Python {wanted}"


def test_hosted_ci_does_what_ci_does_here() -> None:
    steps = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text("utf-8"))["jobs"]["all"]["steps"]
    assert [step["run"] for step in steps if "run" in step] == [".ci/run"]


def test_pre_commit_hooks_run_tools_of_the_projects_own_environment() -> None:
    repos = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text("utf-8"))["repos"]
    assert [repo["repo"] for repo in repos] == ["local"]
    assert all(hook["entry"].startswith(".venv/bin/") for hook in repos[0]["hooks"])
