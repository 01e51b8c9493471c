"""The loop that moved a joint is read or estimated, and the joint moves in MuJoCo as it moved."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace as with_fields

from fricomp.diagnosis import Forward, estimate_controller, read_controller
from fricomp.diagnosis.effects.forward_part import ForwardPart
from fricomp.diagnosis.forward.forward_joint import Run, simulate_forward
from fricomp.diagnosis.inputs.controller import Controller
from fricomp.diagnosis.inputs.track import Track
from fricomp.diagnosis.joint.observer import Contribution, Plant
from fricomp.diagnosis.record.sentence import describe_forward
from fricomp.errors import DiagnosisError
from fricomp.recording import Recording

_DT = 1e-3
_PLANT = Plant(0.3, (4.0, 0.0), 0.1, (1.5, 1.5, 0.1, 0.8), (1.8, 1.8, 0.1, 0.8), 1e5)


def _moved(integral: float = 0.0, seconds: float = 6.0) -> Recording:
    """A joint under P 80, D 6 that slides with Coulomb friction."""
    t = np.arange(int(seconds / _DT), dtype=np.float64) * np.float64(_DT)
    reference, speed = 0.8 * np.sin(1.7 * t), 1.36 * np.cos(1.7 * t)
    q, w, total, seen, torque, path = 0.0, 1.36, 0.0, 1.36, np.empty(t.size), np.empty(t.size)
    before = -1.36 * _DT
    for k in range(t.size):
        path[k] = q
        seen, before = seen + 0.3 * ((q - before) / _DT - seen), q
        total += (reference[k] - q) * _DT
        torque[k] = 80.0 * (reference[k] - q) + 6.0 * (speed[k] - seen) + integral * total
        for _ in range(10):
            f, r = _PLANT.forward, _PLANT.reverse
            friction = (f[0] if w > 0 else r[0]) * np.tanh(w / 1e-3) + 0.8 * w
            w += 1e-4 * (torque[k] - 4.0 * np.cos(q) - 0.1 - friction) / 0.3
            q += 1e-4 * w
    noisy = torque + 0.02 * np.random.default_rng(0).standard_normal(t.size)
    return Recording(t, path, noisy, position_reference=reference, velocity_reference=speed)


@pytest.mark.parametrize(("integral", "kind"), [(0.0, "PD"), (60.0, "PID")])
def test_the_gains_of_a_loop_are_estimated(integral: float, kind: str) -> None:
    found = estimate_controller(_moved(integral))
    assert found is not None
    assert found.kind == kind
    assert found.proportional_gain == pytest.approx(80.0, rel=0.03)
    assert found.derivative_gain == pytest.approx(6.0, rel=0.05)
    assert found.integral_gain == pytest.approx(integral, abs=2.0)
    assert found.reference_share == pytest.approx(1.0, abs=0.03)
    assert "estimated" in found.describe("N·m", "rad")


def test_a_torque_that_obeys_no_loop_has_no_controller() -> None:
    moved = _moved()
    assert estimate_controller(replace(moved, torque=np.random.default_rng(1).standard_normal(len(moved)))) is None
    assert estimate_controller(replace(moved, position_reference=None)) is None


def _run(recording: Recording, plant: Plant, added: Contribution) -> np.ndarray:
    controller = estimate_controller(recording)
    assert controller is not None
    track = Track.build(_DT, np.asarray(recording.position), np.asarray(recording.torque))
    told = np.stack([np.asarray(recording.position_reference), np.asarray(recording.velocity_reference)])
    loop = replace(controller, frequency=1.0 / _DT)
    return simulate_forward(Run(plant, track, told, loop, 2000, track.size, ForwardPart(added)))


def test_mujoco_moves_as_the_joint_did_and_not_where_friction_is_missing() -> None:
    recording = _moved()
    truth = np.asarray(recording.position)[2000:]
    right = np.std(_run(recording, _PLANT, Contribution()) - truth)
    weak = replace(_PLANT, forward=(1.0, 1.0, 0.1, 0.8), reverse=(1.3, 1.3, 0.1, 0.8))
    wrong = np.std(_run(recording, weak, Contribution()) - truth)
    mended = np.std(_run(recording, weak, Contribution(level=0.5)) - truth)
    assert right < 1e-3
    assert wrong > 4.0 * right
    assert mended == pytest.approx(right, rel=0.05)


def test_a_controller_is_read_from_its_table(tmp_path: Path) -> None:
    path = tmp_path / "loop.toml"
    path.write_text('[controller]\nkind = "pid"\nproportional_gain = 80.0\nintegral_gain = 3\nfrequency = 4e3\n')
    assert read_controller(path) == Controller(80.0, integral_gain=3.0, frequency=4000.0)


@pytest.mark.parametrize(
    "text",
    ["proportional = 3.0", "proportional_gain = 'high'", "[controller", "proportional_gain = 3.0\nfrequency = 0.0", ""],
)
def test_a_file_that_is_no_loop_says_which_keys_one_has(text: str, tmp_path: Path) -> None:
    path = tmp_path / "loop.toml"
    path.write_text(text)
    with pytest.raises(DiagnosisError, match=r"loop\.toml"):
        read_controller(path)


def test_the_answer_says_how_the_forward_error_falls() -> None:
    forward = Forward(
        rmse_before=2e-3, rmse_after=5e-4, unit="rad", controller="PD controller (given)", interval=(4, 6)
    )
    assert "falls from 0.002 to 0.0005 rad; PD controller (given)" in describe_forward(forward)
    assert "rises from 0.002 to 0.005 rad" in describe_forward(with_fields(forward, rmse_after=5e-3))
    assert "is 0.002 rad" in describe_forward(with_fields(forward, rmse_after=2.0001e-3))
