"""Adapters by name: built-ins win, a broken plug-in warns, what is refused says why."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import can.interfaces
import pytest
from typer.testing import CliRunner

from fricomp import adapters, extras
from fricomp.adapters import JointAdapter, adapter_class, adapter_names, open_adapter, registry
from fricomp.adapters.can_bus import open_can_link
from fricomp.adapters.configuration import CanBusConfiguration
from fricomp.cli.adapters import EXTRAS
from fricomp.cli.main import app
from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.sim_bench.twins.backend import TwinCanOpenAdapter
from fricomp.sim_bench.twins.canopen.cia402 import Cia402Drive
from fricomp.sim_bench.twins.canopen.cia402_state import DriveState

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


def _row(name: str) -> list[str]:
    """The cells of a row of `fricomp adapters`."""
    printed = CliRunner().invoke(app, ["adapters"], env={"COLUMNS": "400"}).stdout
    (row,) = (line for line in printed.splitlines() if line.split("│")[1:2] and line.split("│")[1].strip() == name)
    return [cell.strip() for cell in row.strip("│ ").split("│")]


def test_the_list_knows_every_adapter_of_this_package() -> None:
    points = entry_points(group=registry.ENTRY_POINT_GROUP)
    own = {point.name for point in points if point.value.startswith("fricomp.")}
    assert own | set(BUILT_IN) == set(EXTRAS)


def test_the_list_says_what_each_needs_and_whether_it_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _row("sim") == ["sim", "A simulated joint; no hardware", "fricomp", "sim", "yes"]
    assert _row("twin-mit")[2:] == ["fricomp", "can, sim", "yes"]
    monkeypatch.setattr(extras, "find_spec", lambda name: None if name == "serial" else find_spec(name))
    assert _row("moteus")[2:] == ["fricomp", "serial", "no: pip install '.[serial]'"]
    assert _row("mit")[-1] == "yes"


def test_the_list_says_why_a_plug_in_does_not_load(monkeypatch: pytest.MonkeyPatch) -> None:
    plugin(monkeypatch, "mine", "no.such.module:Nothing")
    with pytest.warns(UserWarning, match="mine"):
        row = _row("mine")
    assert row[2] == "plug-in"
    assert row[-1].startswith("no: backend 'mine' does not load")


def test_faults_are_cleared_from_the_command_line_and_nothing_is_energised(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drives: list[Cia402Drive] = []

    def with_a_latched_fault(configuration: Mapping[str, Any]) -> TwinCanOpenAdapter:
        adapter = TwinCanOpenAdapter.from_configuration(configuration)
        drives.extend(adapter.twin.drives)
        drives[0].fail(0x7500)
        return adapter

    monkeypatch.setattr("fricomp.adapters.open_adapter", lambda _, configuration: with_a_latched_fault(configuration))
    path = tmp_path / "drive.toml"
    path.write_text('backend = "twin-canopen"\n')
    result = CliRunner().invoke(app, ["adapter", "clear", str(path)])
    assert result.exit_code == 0, result.output
    assert "No fault is left on joint; the drives say that nothing is energised." in result.output
    assert drives[0].state is DriveState.SWITCH_ON_DISABLED
    assert drives[0].error_code == 0
    assert not drives[0].axis.energised


@pytest.mark.parametrize("name", ["CanAdapter", "Driver", "JointAdapter", "SerialAdapter"])
def test_what_an_adapter_is_written_from_is_exported(name: str) -> None:
    assert name in adapters.__all__
    assert isinstance(getattr(adapters, name), type)


def test_an_interface_that_another_package_has_taken_over_is_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(can.interfaces.BACKENDS, "virtual", ("another_package.bus", "Bus"))
    with pytest.warns(RuntimeWarning, match="'virtual' is that of another_package"), pytest.raises(AdapterError):
        open_can_link(CanBusConfiguration(interface="virtual", channel="channel"))
