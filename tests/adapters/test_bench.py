"""The measurements of the adapters hold their promises at a small size."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fricomp.cli.main import app
from fricomp.sim_bench.studies.adapters.bench import PROTOCOLS
from fricomp.sim_bench.studies.adapters.calibration import compare_all
from fricomp.sim_bench.studies.adapters.fuzz import fuzz_adapter
from fricomp.sim_bench.studies.adapters.peers import PEERS, compare_with_peer
from fricomp.sim_bench.studies.adapters.serial_can import compare_slcan
from fricomp.sim_bench.studies.adapters.soak import soak_adapter


@pytest.mark.parametrize("protocol", sorted(PEERS))
def test_every_difference_to_an_independent_encoder_has_its_reason(protocol: str) -> None:
    compared = compare_with_peer(protocol, 400)
    assert compared.unexplained == ()
    assert compared.n_identical + sum(compared.differences.values()) == 400


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_garbage_brings_nothing_foreign_and_no_torque_beyond_the_limit(protocol: str) -> None:
    result = fuzz_adapter(protocol, 4000)
    assert result.foreign == {}
    assert 0.0 < result.largest_torque <= result.torque_limit
    assert result.n_frames >= 4000


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_a_joint_in_its_loop_is_stopped_by_faults_and_lies_alone(protocol: str) -> None:
    result = soak_adapter(protocol, 8_000, seed=3)
    assert result.passed, result
    assert result.largest_torque > 0.0
    assert sum(result.n_stops.values()) > 0


def test_frames_come_back_over_both_slcan_buses() -> None:
    trip = compare_slcan(3, "same thread", 3)
    assert trip.chunked > 0.0
    assert trip.bytewise > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
@pytest.mark.parametrize("noise", [False, True])
def test_calibrating_through_adapter_and_twin_gives_what_the_joint_alone_gives(protocol: str, noise: bool) -> None:
    (compared,) = compare_all(noise, [protocol], quick=True)
    assert compared.passed, compared
    assert compared.n_used >= 10


@pytest.mark.slow
def test_the_bench_command_writes_its_figures(tmp_path: Path) -> None:
    arguments = ["bench", "adapters", "--quick", "--frames", "1000", "--commands", "60", "--only", "mit"]
    result = CliRunner().invoke(app, [*arguments, "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert {entry["protocol"] for entry in figures["peers"]} == set(PEERS)
    assert (tmp_path / "report.html").stat().st_size > 1000
