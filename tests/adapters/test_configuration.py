"""The configuration file is checked before a bus is opened, and says what is wrong with it by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fricomp.adapters import open_adapter
from fricomp.adapters.bus_budget import BusBudget, can_frame_bits
from fricomp.adapters.configuration import (
    AdapterConfiguration,
    choose_adapter,
    convert,
    read_configuration,
    read_table,
)
from fricomp.errors import AdapterConfigurationError

TEXT = """
backend = "mit"
watchdog = 0.05

[bus]
interface = "virtual"
channel = "test"

[[joints]]
name = "elbow"
id = 1
model = "damiao/DM4310"
limits = { torque = 4.0, torque_rate = 200.0, velocity = 8.0, position = [-2.0, 2.0] }
transmission = { gear_ratio = 6.0, sign = -1, zero = 0.1 }
"""


def table(**joint: Any) -> dict[str, Any]:
    limits = {"torque": 4.0, "torque_rate": 200.0, "velocity": 8.0}
    first = {"name": "elbow", "id": 1, "model": "damiao/DM4310", "limits": limits} | joint
    return {"bus": {"interface": "virtual"}, "joints": [first]}


def test_a_file_becomes_an_adapter_with_its_limits_and_transmissions(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(TEXT)
    adapter = open_adapter("mit", read_configuration(path))
    assert adapter.options.limits[0].position == (-2.0, 2.0)
    assert adapter.options.transmissions is not None
    assert adapter.options.transmissions[0].gear_ratio == 6.0
    assert adapter.options.transmissions[0].sign == -1


def test_paths_in_a_file_count_from_its_own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cfg").mkdir()
    file = tmp_path / "cfg" / "arm.toml"
    file.write_text(
        'endpoints = "flat.json"\nmodel = "arm.xml"\n'
        '[[joints]]\nfriction = "friction.json"\nmodel = "damiao/DM4310"\n'
        '[[joints]]\nfriction = "/models/friction.json"\n'
        '[sim]\nmodel = "two_link_arm"\njoints = [{ friction = "../friction.json" }]\n'
    )
    monkeypatch.chdir(tmp_path)
    found = read_table("cfg/arm.toml")
    assert found["endpoints"] == str(tmp_path / "cfg" / "flat.json")
    assert found["model"] == str(tmp_path / "cfg" / "arm.xml")
    assert [joint["friction"] for joint in found["joints"]] == [
        str(tmp_path / "cfg" / "friction.json"),
        "/models/friction.json",
    ]
    assert found["joints"][0]["model"] == "damiao/DM4310"
    assert found["sim"] == {"model": "two_link_arm", "joints": [{"friction": str(tmp_path / "cfg/../friction.json")}]}


@pytest.mark.parametrize(
    ("text", "complaint"),
    [(None, "cannot read"), ("backend = ", "cannot read"), ("watchdog = 1.0", "names no backend")],
)
def test_a_file_that_is_none_says_so(tmp_path: Path, text: str | None, complaint: str) -> None:
    path = tmp_path / "arm.toml"
    if text is not None:
        path.write_text(text)
    with pytest.raises(AdapterConfigurationError, match=complaint):
        read_configuration(path)


@pytest.mark.parametrize(
    ("named", "asked", "chosen"),
    [
        ("canopen", None, "canopen"),
        ("canopen", "canopen", "canopen"),
        ("sim", None, "sim"),
        (None, "twin-mit", "twin-mit"),
        (None, "sim", "sim"),
        (None, None, "sim"),
    ],
)
def test_the_file_names_the_adapter_where_the_command_line_does_not(
    tmp_path: Path, named: str | None, asked: str | None, chosen: str
) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(("" if named is None else f'backend = "{named}"\n') + "seed = 3\n")
    assert choose_adapter(asked, path) == (chosen, {"seed": 3})


def test_without_a_file_the_joint_is_simulated() -> None:
    assert choose_adapter(None, None) == ("sim", {})


@pytest.mark.parametrize(
    ("text", "asked", "complaint"),
    [
        (TEXT, "canopen", "'mit', but 'canopen'"),
        (TEXT, "sim", "'mit', but 'sim'"),
        (TEXT.replace('backend = "mit"', ""), None, "names no backend.*--backend"),
        ("backend = 3", "sim", "in quotes"),
    ],
)
def test_a_file_and_a_command_line_that_differ_are_refused(
    tmp_path: Path, text: str, asked: str | None, complaint: str
) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(text)
    with pytest.raises(AdapterConfigurationError, match=complaint):
        choose_adapter(asked, path)


@pytest.mark.parametrize("name", ["sim", "twin-mit", "mit"])
def test_every_adapter_takes_its_own_name_in_the_configuration_and_no_other(name: str) -> None:
    configuration = table() if name == "mit" else {}
    assert open_adapter(name, configuration | {"backend": name}) is not None
    with pytest.raises(AdapterConfigurationError, match=f"'odrive', but '{name}'"):
        open_adapter(name, configuration | {"backend": "odrive"})


@pytest.mark.parametrize(
    ("joint", "complaint"),
    [
        ({"limits": {"torque": -1.0, "torque_rate": 1.0, "velocity": 1.0}}, r"'elbow'.*torque"),
        ({"limits": {"torque": 1.0, "velocity": 1.0}}, "torque_rate"),
        ({"transmission": {"sign": 2}}, r"'elbow'.*sign"),
        ({"transmission": {"gear_ratio": 0.0}}, r"'elbow'.*gear_ratio"),
        ({"gear": 6.0}, "gear"),
        ({"id": "one"}, "id"),
        ({"id": 0x800}, "0x800|2048"),
    ],
)
def test_a_wrong_value_is_named(joint: dict[str, Any], complaint: str) -> None:
    with pytest.raises(AdapterConfigurationError, match=complaint):
        open_adapter("mit", table(**joint))


@pytest.mark.parametrize("wrong", [{"stale_after": 0.0}, {"ramp_time": -0.1}, {"watchdog": 0.0}])
def test_a_wrong_time_is_named(wrong: dict[str, float]) -> None:
    with pytest.raises(AdapterConfigurationError, match=next(iter(wrong))):
        open_adapter("mit", table() | wrong)


@pytest.mark.parametrize("what", ["name", "id"])
def test_two_joints_of_one_name_or_address_are_refused(what: str) -> None:
    double = table()
    double["joints"].append(double["joints"][0] | {"name": "wrist", "id": 2} | {what: double["joints"][0][what]})
    with pytest.raises(AdapterConfigurationError, match=f"same {what}"):
        open_adapter("mit", double)


def test_a_rate_which_nothing_reads_is_refused_by_name() -> None:
    with pytest.raises(AdapterConfigurationError, match="unknown field rate"):
        open_adapter("mit", table() | {"rate": 500.0})


def test_no_joint_is_refused() -> None:
    with pytest.raises(AdapterConfigurationError, match=r"\[\[joints\]\]"):
        open_adapter("mit", {"bus": {"interface": "virtual"}, "joints": []})


@pytest.mark.parametrize(
    ("n_bytes", "extended", "bits"), [(8, False, 135), (0, False, 55), (8, True, 160), (4, False, 95)]
)
def test_the_longest_frames_are_those_of_the_literature(n_bytes: int, extended: bool, bits: int) -> None:
    assert can_frame_bits(n_bytes, extended) == bits


def test_other_traffic_takes_its_share_of_the_budget() -> None:
    assert BusBudget([1e-3, 1e-3]).highest_rate == pytest.approx(500.0)
    assert BusBudget([1e-3, 1e-3], background_load=0.25).highest_rate == pytest.approx(375.0)


def test_a_file_that_is_not_there_is_told_of_in_words(tmp_path: Path) -> None:
    with pytest.raises(AdapterConfigurationError, match=r"missing\.toml: No such file or directory$"):
        read_table(tmp_path / "missing.toml")


def test_what_is_wrong_in_a_file_is_told_with_its_name(tmp_path: Path) -> None:
    path = tmp_path / "drive.toml"
    path.write_text("nonsense = 3\n", encoding="utf-8")
    with pytest.raises(AdapterConfigurationError, match=r"drive\.toml: Object contains unknown field nonsense"):
        convert(read_table(path), AdapterConfiguration)
