"""A simulation known by its own recording, free of noise, and what is told where the commands were others."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fricomp.diagnosis import RigidJoint, diagnose_against
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.simulated import compare_motions
from fricomp.diagnosis.simulated_joint import SimulatedJoint, read_simulated
from fricomp.errors import DiagnosisError
from fricomp.recording import Recording

from .friction_loss import STICKING, FrictionLoss, recording, simulated

_TIME = np.arange(20_000, dtype=np.float64) * np.float64(1e-3)


def _moved(position: FloatArray, duration: float = 20.0) -> Recording:
    kept = duration > _TIME
    return Recording(_TIME[kept], position[kept], np.zeros(int(kept.sum())))


_WAVE = np.sin(3.0 * _TIME)


@pytest.mark.parametrize("tracking", [0.0, 0.05])
def test_the_same_motion_is_not_remarked(tracking: float) -> None:
    assert compare_motions([_moved(_WAVE)], _moved(np.sin(3.0 * _TIME - tracking))) == ()


def test_a_shorter_one_and_another_motion_are_told() -> None:
    (shorter,) = compare_motions([_moved(_WAVE)], _moved(_WAVE, 9.0))
    assert "lasts 9 s and the recording 20 s" in shorter
    (other,) = compare_motions([_moved(_WAVE)], _moved(np.sin(2.0 * _TIME + 1.0)))
    assert "another motion" in other
    assert compare_motions([_moved(np.cos(2.0 * _TIME)), _moved(_WAVE)], _moved(_WAVE)) == ()


# The real joint sticks, and the simulator's creeps as by default: neither its form of friction nor the lack of noise in
# its recording is a mismatch.
_SIMULATED, _REAL = FrictionLoss(), FrictionLoss(time=0.002, impedance=STICKING)
_SECONDS = 10.0


def _real(**changes: Any) -> Recording:
    return recording(replace(_REAL, **changes), "rests", duration=_SECONDS)


def _simulated(**changes: Any) -> Recording:
    return simulated(replace(_SIMULATED, **changes), "rests", duration=_SECONDS)


@pytest.fixture(scope="module")
def known() -> SimulatedJoint:
    """What is read off the recording of the simulation, once."""
    return read_simulated(_simulated(), [_real()])


@pytest.fixture
def is_known(known: SimulatedJoint, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fricomp.diagnosis.simulated.read_simulated", lambda *_, **__: known)


@pytest.mark.slow
def test_a_simulation_is_read_from_a_recording_without_noise(known: SimulatedJoint) -> None:
    assert known.effects == ()
    assert known.noise_ratio is None
    assert known.remarks == ()
    assert known.rigid is not None
    assert known.rigid.inertia == pytest.approx(_SIMULATED.inertia, rel=0.01)
    assert known.rigid.gravity == pytest.approx((0.0, _SIMULATED.mass * 9.81 * 0.2), abs=0.05)
    assert known.rigid.friction_loss == pytest.approx(_SIMULATED.level, rel=0.02)
    assert known.rigid.damping == pytest.approx(0.6, rel=0.05)


@pytest.mark.slow
@pytest.mark.usefixtures("is_known")
def test_a_joint_like_its_simulation_agrees_with_it_and_other_friction_is_listed() -> None:
    found = diagnose_against(_real(level=2.2), _simulated())
    assert found.verdict == "consistent", found.sentences
    (change,) = found.record.changes
    assert change.name == "frictionloss"
    assert change.given == pytest.approx(1.5, rel=0.02)
    assert change.refitted.value == pytest.approx(2.2, rel=0.02)


@pytest.mark.slow
@pytest.mark.usefixtures("is_known")
def test_another_load_is_a_parameter() -> None:
    found = diagnose_against(_real(mass=2.4), _simulated())
    assert found.verdict == "parameters", found.sentences
    assert [effect.name for effect in found.effects] == ["payload_error"]
    change = found.effects[0].parameters["gravity_sin_change"]
    assert change.ci95[0] < 0.4 * 9.81 * 0.2 < change.ci95[1]


@pytest.mark.slow
@pytest.mark.usefixtures("is_known")
def test_what_the_simulation_lacks_is_named() -> None:
    missing = diagnose_against(_real(cogging=0.6), _simulated())
    assert missing.verdict == "missing_physics", missing.sentences
    assert [effect.name for effect in missing.effects] == ["cogging"]


@pytest.mark.slow
def test_what_the_simulation_has_as_well_is_not_missing() -> None:
    with_cogging = simulated(replace(_REAL, cogging=0.6), "rests", duration=_SECONDS)
    both = diagnose_against(_real(cogging=0.6), with_cogging)
    assert both.verdict == "consistent", both.sentences
    assert "The simulation shows cogging as well" in both.sentences[-1]


def test_what_stays_unexplained_in_a_simulation_is_a_remark() -> None:
    rigid = RigidJoint(0.16, (0.0, 3.9), 0.0, 0.0, 0.0, True)
    assert SimulatedJoint(rigid, None).remarks == ()
    (remark,) = SimulatedJoint(None, None, noise_ratio=3.1).remarks
    assert "something that no effect explains (3.1 times" in remark


def test_a_simulated_current_cannot_be_compared() -> None:
    real = Recording(_TIME, _WAVE, np.sign(np.cos(3.0 * _TIME)) - 2.0 * _WAVE)
    with pytest.raises(DiagnosisError, match="let the simulator record N·m"):
        diagnose_against(real, real.with_metadata(torque_unit="A"))


def test_a_bad_recording_is_told_before_the_simulation_is_read() -> None:
    still = Recording(_TIME, np.zeros(_TIME.size), np.sin(_TIME))
    assert diagnose_against(still, still).verdict == "bad_data"
    with pytest.raises(DiagnosisError, match="the simulated recording cannot be used"):
        read_simulated(still)
