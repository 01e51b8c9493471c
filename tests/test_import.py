"""`import fricomp` is light: a robot that only runs the compensator installs and waits for little."""

from __future__ import annotations

import subprocess
import sys

import fricomp

EXTRAS = (
    "torch",
    "mujoco",
    "onnxruntime",
    "onnx",
    "can",
    "canopen",
    "serial",
    "matplotlib",
    "plotly",
    "scipy",
    "typer",
)


def run(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.strip()


def test_compensator_needs_no_extra() -> None:
    loaded = run("import sys; from fricomp import Compensator, ControlLoop; print(' '.join(sys.modules))").split()
    assert not set(EXTRAS) & set(loaded)


def test_adapters_and_recordings_need_no_extra() -> None:
    """What `pip install` of the package alone brings."""
    loaded = run("import sys, fricomp.adapters, fricomp.recording; print(' '.join(sys.modules))").split()
    assert not set(EXTRAS) & set(loaded)


def test_the_command_line_begins_before_anything_large_is_imported() -> None:
    """Ctrl-C is one sentence from then on."""
    loaded = run("import sys; from fricomp.__main__ import run; print(' '.join(sys.modules))").split()
    assert not {"numpy", "msgspec", "typer"} & set(loaded)


def test_public_names_are_sorted_and_exist() -> None:
    assert list(fricomp.__all__) == sorted(fricomp.__all__)
    assert all(getattr(fricomp, name) is not None for name in fricomp.__all__)


def test_unknown_name_is_an_attribute_error() -> None:
    assert not hasattr(fricomp, "no_such_thing")
