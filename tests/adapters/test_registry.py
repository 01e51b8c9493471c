"""Adapters by name: built-ins win, a broken plug-in warns, what is refused says why."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fricomp.adapters import JointAdapter, adapter_class, adapter_names, open_adapter, registry
from fricomp.cli.main import app
from fricomp.errors import AdapterConfigurationError

BUILT_IN = ["canopen", "dynamixel", "mit", "moteus", "odrive"]


def plugin(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    points = {name: EntryPoint(name, value, registry.ENTRY_POINT_GROUP)}
    monkeypatch.setattr(registry, "_plugins", lambda: points)


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_built_in_is_an_adapter(name: str) -> None:
    assert name in adapter_names()
    assert issubclass(adapter_class(name), JointAdapter)


def test_a_built_in_wins_over_a_plug_in_of_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    plugin(monkeypatch, "mit", "no.such.module:Nothing")
    assert adapter_class("mit").__name__ == "MitAdapter"


def test_a_broken_plug_in_warns_and_is_an_error_of_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    plugin(monkeypatch, "mine", "no.such.module:Nothing")
    with pytest.warns(UserWarning, match="mine"), pytest.raises(AdapterConfigurationError, match="does not load"):
        adapter_class("mine")


def test_a_plug_in_that_is_no_adapter_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    plugin(monkeypatch, "mine", "collections:OrderedDict")
    with pytest.raises(AdapterConfigurationError, match="not a JointAdapter"):
        adapter_class("mine")


def test_feetech_is_refused_with_the_reason() -> None:
    with pytest.raises(AdapterConfigurationError, match="no torque or current"):
        open_adapter("feetech", {})


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(AdapterConfigurationError, match=r"canopen.*dynamixel.*mit"):
        open_adapter("canopne", {})


def test_no_bus_library_is_imported_before_an_adapter_is_asked_for() -> None:
    code = "import sys, fricomp.adapters; print(sorted({'can', 'canopen', 'serial'} & set(sys.modules)))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_the_command_line_lists_them_all() -> None:
    result = CliRunner().invoke(app, ["adapters"])
    assert result.exit_code == 0
    for name in [*BUILT_IN, "feetech"]:
        assert name in result.stdout


def test_faults_are_cleared_from_the_command_line_and_nothing_is_energised(tmp_path: Path) -> None:
    path = tmp_path / "drive.toml"
    path.write_text('backend = "twin-canopen"\n')
    result = CliRunner().invoke(app, ["adapter", "clear", str(path)])
    assert result.exit_code == 0, result.output
    assert "No fault is left on joint; nothing is energised." in result.output
