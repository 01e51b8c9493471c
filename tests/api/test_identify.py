"""`fricomp.identify`: the same answer from arrays, a table, a frame, a file and a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import fricomp
from fricomp.api.identification import Identification
from fricomp.calibration import IdentificationOptions
from fricomp.errors import FricompError, IdentificationError, OutputError
from fricomp.laws import FloatArray

SPEED = np.concatenate([-np.geomspace(0.01, 1.0, 30), np.geomspace(0.01, 1.0, 30)])
QUICK: dict[str, Any] = {"method": "least_squares", "noise": "absolute"}


@pytest.fixture(scope="module")
def torque() -> FloatArray:
    clean = np.sign(SPEED) * (0.15 + 0.45 * np.exp(-((SPEED / 0.05) ** 2))) + 0.02 * SPEED
    return np.asarray(clean + np.random.default_rng(0).normal(0.0, 0.002, SPEED.size))


@pytest.fixture(scope="module")
def found(torque: FloatArray) -> Identification:
    return fricomp.identify(SPEED, torque, options=IdentificationOptions(joint="elbow"), **QUICK)


def test_velocities_and_torques_give_the_friction(found: Identification) -> None:
    assert found.model.forward.coulomb_torque == pytest.approx(0.15, rel=0.02)
    assert found.motion is None
    assert found.is_usable
    assert repr(found) == "<Identification of joint elbow: stribeck, converged, 60 points>"
    assert "A constant torque offset in the table" in found.summary()


def test_a_mapping_a_frame_and_a_file_give_the_same(tmp_path: Path, torque: FloatArray, found: Identification) -> None:
    frame = pd.DataFrame({"velocity": SPEED, "torque": torque})
    frame.to_csv(tmp_path / "points.csv", index=False)
    for source in (dict(frame), frame, tmp_path / "points.csv", str(tmp_path / "points.csv")):
        again = fricomp.identify(source, **QUICK)
        assert again.parameters == pytest.approx(found.parameters, rel=1e-9)


def test_it_is_written_as_the_command_writes_it(tmp_path: Path, found: Identification) -> None:
    written = found.save(tmp_path / "out")
    assert {path.name for path in written} == {"friction.json", "friction.onnx", "report.html"}
    assert fricomp.load_model(tmp_path / "out" / "friction.json").joint == "elbow"
    with pytest.raises(OutputError, match="overwrite"):
        found.save(tmp_path / "out")
    found.save(tmp_path / "out", overwrite=True)


def _motion() -> fricomp.Recording:
    """A joint with inertia 0.1, Coulomb torque 0.2 and viscous coefficient 0.05, moved by two sines."""
    time = np.arange(0.0, 20.0, 1e-3)
    pulses = 2.0 * np.pi * np.array([0.25, 0.7])
    sizes, phases = np.array([0.8, 0.25]), np.outer(time, pulses)
    position, velocity = np.sin(phases) @ sizes, np.cos(phases) @ (sizes * pulses)
    acceleration = -np.sin(phases) @ (sizes * pulses**2)
    load = 0.1 * acceleration + 0.2 * np.sign(velocity) + 0.05 * velocity
    noisy = load + np.random.default_rng(1).normal(0.0, 0.01, time.size)
    channels = {"time": time, "position": position, "torque": noisy}
    return fricomp.Recording.from_channels(channels).with_metadata(joint="elbow")


def test_a_recording_gives_the_rigid_body_too_and_its_file_the_same(tmp_path: Path) -> None:
    recording = _motion()
    found = fricomp.identify(recording, law="coulomb_viscous")
    assert found.motion is not None
    assert found.motion.rigid_body.inertia == pytest.approx(0.1, rel=0.03)
    assert found.model.joint == "elbow"
    assert "gravity not fitted (gravity)" in found.notes[0]
    fricomp.write_recording(recording, tmp_path / "motion.csv")
    again = fricomp.identify(tmp_path / "motion.csv", law="coulomb_viscous")
    assert again.parameters == pytest.approx(found.parameters, rel=1e-6)


def test_arguments_that_do_not_apply_are_refused_by_their_names(tmp_path: Path, torque: FloatArray) -> None:
    with pytest.raises(IdentificationError, match=r"^gravity is for recordings; the table is a table"):
        fricomp.identify(SPEED, torque, gravity=True)
    with pytest.raises(IdentificationError, match=r"^loss, depart is for tables"):
        fricomp.identify(_motion(), loss="robust", depart=True)
    with pytest.raises(IdentificationError, match="torque belongs to velocities"):
        fricomp.identify(tmp_path / "points.csv", torque)
    with pytest.raises(IdentificationError, match="velocity is missing: give velocities and torques"):
        fricomp.identify([0.1, 0.2])
    with pytest.raises(IdentificationError, match="identify_dynamic"):
        fricomp.identify(SPEED, torque, law="lugre")
    with pytest.raises(IdentificationError, match="unknown law 'magic'"):
        fricomp.identify(SPEED, torque, law="magic")


def test_a_recording_gives_a_model_that_can_be_evaluated_by_itself(tmp_path: Path) -> None:
    log = _motion()
    fricomp.identify(log).save(tmp_path / "out")
    dynamics = fricomp.load_model(tmp_path / "out" / "friction.json").dynamics
    assert dynamics is not None
    assert dynamics.inertia == pytest.approx(0.1, rel=0.05)


def test_a_frame_of_a_motion_is_a_recording_and_several_are_refused() -> None:
    time = np.arange(0.0, 20.0, 0.005)
    position = 0.5 * np.sin(1.3 * time) + 0.3 * np.sin(0.4 * time)
    velocity = 0.65 * np.cos(1.3 * time) + 0.12 * np.cos(0.4 * time)
    acceleration = -0.845 * np.sin(1.3 * time) - 0.048 * np.sin(0.4 * time)
    torque = 0.1 * acceleration + 0.4 * np.sign(velocity) + 0.2 * velocity
    torque += np.random.default_rng(0).normal(0.0, 0.005, time.size)
    frame = pd.DataFrame({"time": time, "position": position, "velocity": velocity, "torque": torque})
    found = fricomp.identify(frame, law="coulomb_viscous")
    assert found.motion is not None
    assert float(found.model.torque(0.5)) == pytest.approx(0.5, rel=0.03)
    recording = fricomp.Recording.from_pandas(frame)
    with pytest.raises(IdentificationError, match="identify takes one"):
        fricomp.identify([recording, recording])


def test_what_is_no_path_no_recording_and_no_model_is_refused_by_its_type() -> None:
    calls: list[tuple[Any, Any]] = [(fricomp.read_recording, 3), (fricomp.load_model, None), (fricomp.Compensator, 1.0)]
    for call, given in calls:
        with pytest.raises(FricompError, match="is no "):
            call(given)
