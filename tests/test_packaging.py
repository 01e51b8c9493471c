"""The folders are one package, and the core stays light."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

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
