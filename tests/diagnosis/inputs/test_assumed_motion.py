"""A log whose names state no unit slides where the simulation's joint does; one that states some does not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.diagnosis.inputs.given import Given, read_given
from fricomp.recording import RecordingWarning, read_recording

_SLIDE = """<mujoco><worldbody><body><joint name="axis" type="slide" axis="1 0 0"/>
<inertial pos="0 0 0" mass="20" diaginertia="0.3 0.3 0.3"/></body></worldbody></mujoco>"""
_HINGE = _SLIDE.replace('type="slide"', 'type="hinge"')


def _read(folder: Path, names: str, simulation: str, size: float = 0.2) -> Given:
    time = np.arange(0.0, 15.0, 0.002)
    position = size * np.sin(1.3 * time) + 0.3 * size * np.sin(3.1 * time + 0.4)
    velocity = np.gradient(position, time)
    noise = np.random.default_rng(1).normal(0.0, 0.3, time.size)
    force = 20.0 * np.gradient(velocity, time) + 30.0 * np.sign(velocity) + 40.0 * velocity + noise
    table = np.stack([time, position, force], axis=1)
    np.savetxt(folder / "log.csv", table, fmt="%.8f", delimiter=",", header=names, comments="")
    (folder / "axis.xml").write_text(simulation)
    with pytest.warns(RecordingWarning):
        recording = read_recording(folder / "log.csv")
    return read_given([recording], folder / "axis.xml")


@pytest.mark.parametrize("names", ["t,q,tau", "time,axis/position,axis/effort", "time_s,pos,actual_torque"])
def test_a_log_without_units_takes_the_motion_of_the_simulation(names: str, tmp_path: Path) -> None:
    given = _read(tmp_path, names, _SLIDE)
    assert given.reasons == ()
    assert given.recordings[0].metadata.motion == "linear"
    assert given.recordings[0].metadata.torque_unit == "N"
    assert any("in m and N" in remark for remark in given.remarks)


@pytest.mark.parametrize("names", ["t,q_rad,tau", "t,q_deg,tau", "t,q,tau_Nm"])
def test_a_log_that_states_a_unit_is_refused_beside_another_joint(names: str, tmp_path: Path) -> None:
    (reason,) = _read(tmp_path, names, _SLIDE).reasons
    assert "the simulation's joint slides" in reason


def test_a_log_without_units_turns_where_the_simulation_does(tmp_path: Path) -> None:
    given = _read(tmp_path, "t,q,tau", _HINGE)
    assert given.reasons == ()
    assert given.recordings[0].metadata.motion == "rotary"
    assert not any("in m and N" in remark for remark in given.remarks)
