"""The list of packages is complete, and the core stays light."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
HEAVY = ("torch", "mujoco", "onnxruntime", "onnx", "can", "canopen", "serial", "matplotlib", "plotly", "scipy", "numba")


def packages_on_disk() -> set[str]:
    found = set()
    for top in ("fricomp", "adapters", "calibration", "sim_bench"):
        for init in (ROOT / top).rglob("__init__.py"):
            parts = init.parent.relative_to(ROOT).parts
            if not any(ROOT.joinpath(*parts[: i + 1]).is_symlink() for i in range(len(parts))):
                found.add(".".join(parts if top == "fricomp" else ("fricomp", *parts)))
    return found


def test_every_package_on_disk_is_in_the_wheel() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    assert set(settings["packages"]) == packages_on_disk()


def test_the_fixed_folders_are_linked_into_the_package() -> None:
    for folder in ("adapters", "calibration", "sim_bench"):
        link = ROOT / "fricomp" / folder
        assert link.is_symlink()
        assert link.resolve() == ROOT / folder


def test_importing_fricomp_pulls_in_no_extra() -> None:
    code = f"import sys, fricomp; print(sorted(set({HEAVY!r}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
