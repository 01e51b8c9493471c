"""Timings in units of arithmetic, their growth, the work that is timed, and the page."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration import identify
from fricomp.diagnosis.joint.observer import count_joints
from fricomp.sim_bench.studies.speed.measure import PeerTiming, SpeedFigures
from fricomp.sim_bench.studies.speed.page import list_rows, write_page
from fricomp.sim_bench.studies.speed.timing import Timing, fit_growth, time_call
from fricomp.sim_bench.studies.speed.work import draw_points, draw_recording, list_peers, make_case


def _time(group: str, size: float, units: float) -> Timing:
    return Timing(group, f"{group} {size:g}", size, units / 10.0, units / 20.0, units)


def test_a_call_is_timed_once_in_units_of_arithmetic() -> None:
    called: list[int] = []
    found = time_call("group", "name", 3.0, lambda: called.append(sum(range(200_000))))
    assert len(called) == 1
    assert found.units > 0.0
    assert found.joints == 0


def test_growth_is_the_power_of_the_size() -> None:
    linear = [_time("linear", size, 2.0 * size) for size in (40.0, 10.0, 20.0)]
    square = [_time("square", size, size**2) for size in (1.0, 2.0)]
    found = {one.group: one for one in fit_growth([*linear, *square, _time("single", 1.0, 1.0)])}
    assert set(found) == {"linear", "square"}
    assert found["linear"].exponent == pytest.approx(1.0)
    assert found["square"].exponent == pytest.approx(2.0)
    assert [one.size for one in found["linear"].timings] == [10.0, 20.0, 40.0]


def test_points_have_the_friction_that_they_are_drawn_from() -> None:
    found = identify(*draw_points(2000), method="least_squares")
    for (value, deviation), truth in zip(
        zip(found.parameters.values(), found.standard_deviations.values(), strict=True),
        2 * [0.8, 1.2, 0.05, 0.3],
        strict=True,
    ):
        assert abs(value - truth) < 4.0 * deviation


def test_a_recording_obeys_its_own_equation() -> None:
    recording = draw_recording(20_000)
    velocity = np.gradient(recording.position, recording.time)
    bend = np.gradient(velocity, recording.time)
    sliding = np.abs(velocity) > 0.5
    left = recording.torque - 0.1 * bend - 2.0 * np.cos(recording.position)
    expected = np.sign(velocity) * (0.8 + 0.3 * np.abs(velocity))
    assert np.std((left - expected)[sliding]) < 0.02


@pytest.mark.usefixtures("drawn_charts")
def test_the_page_holds_every_timing_and_a_picture(tmp_path: Path) -> None:
    timings = [_time("diagnosis: duration [s]", size, size) for size in (30.0, 60.0)]
    figures = SpeedFigures(
        unit=0.1,
        timings=tuple(timings),
        growth=tuple(fit_growth(timings)),
        peers=(PeerTiming("another", timings[0].name, 5.0, 0.2),),
        absent=("bam",),
        first=(("checking the data", 0.5, 0.1),),
        slowest="two effects, 60 s",
        profile=(("kernel", 0.6),),
    )
    write_page(figures, tmp_path / "speed.md", "Measured on a day.", "fricomp bench speed")
    text = (tmp_path / "speed.md").read_text(encoding="utf-8")
    for row in list_rows(timings):
        assert row[0] in text
    assert "another" in text
    assert "bam" in text
    assert (tmp_path / "speed" / "growth.png").stat().st_size > 1000


@pytest.mark.slow
def test_a_diagnosis_counts_its_simulated_joints(tmp_path: Path) -> None:
    case = make_case(0, 10.0, tmp_path)
    with count_joints() as counted:
        case.diagnose(2)
    assert 300 < counted.joints < 3000
    names = [peer.name for peer in list_peers(tmp_path, quick=True)]
    assert any("mujoco.sysid" in name for name in names)
