"""Friction that creeps: its velocity is found where a simulator made it, and a joint that sticks has none."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.base import unpack
from fricomp.diagnosis.joint.kernel import LANES, observe
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer, Plant
from fricomp.diagnosis.search.preparation import Baseline, may_creep, prepare
from fricomp.recording import Recording

from .friction_loss import STICKING, FrictionLoss, recording

DT, LEVEL, CREEP = 1e-3, 1.0, 0.02


def _prepared(truth: FrictionLoss, kind: str, rate: int) -> Baseline:
    tracks = build_tracks([recording(truth, kind, duration=16.0, rate=rate)], [None])
    return prepare(tracks, observer=Observer(), nulls=8, seed=0)


def _held(plant: Plant, speed: float, substeps: int) -> FloatArray:
    """Dry friction of a joint held tightly to a constant speed [N·m]. Shape (n,)."""
    time = np.arange(1000) * DT
    settings, steps = np.array([DT, 1e6, 2e3, 1e-3, 200.0]), np.full(time.size, substeps)
    lanes = tuple(range(LANES[1]))
    signals = (speed * time, np.full_like(time, speed), 0 * time, 0 * time)
    rows = np.zeros((4, len(lanes)), dtype=np.int64)
    plants, out = np.tile(plant.to_slots()[:, None], len(lanes)), np.empty((4, len(lanes), time.size))
    observe(tuple(one[None] for one in signals), rows, plants, settings, steps, lanes, out)
    return np.asarray(out[3, 0])


@pytest.mark.parametrize("substeps", [8, 40])
@pytest.mark.parametrize("lead", [0.0, 0.01])
@pytest.mark.parametrize("speed", [-0.05, -0.01, 0.002, 0.01, 0.04])
def test_friction_is_viscous_below_the_creep_velocity(speed: float, lead: float, substeps: int) -> None:
    curve = (LEVEL, LEVEL, 0.1, 0.0)
    for sharpness, wanted in ((1.0, np.clip(speed / CREEP, -1.0, 1.0)), (0.0, speed / (abs(speed) + CREEP))):
        plant = Plant(
            0.5, (0.0, 0.0), 0.0, curve, curve, 1e4, sharpness=sharpness, creep_velocity=CREEP, creep_lead=lead
        )
        assert _held(plant, speed, substeps)[-2] == pytest.approx(LEVEL * wanted, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("time", "kind", "rate"),
    [
        (0.02, "rests", 1000),
        pytest.param(0.02, "multisine", 500, marks=pytest.mark.slow),
        pytest.param(0.01, "sweep", 1000, marks=pytest.mark.slow),
    ],
)
def test_creep_is_found_where_the_simulator_made_it(time: float, kind: str, rate: int) -> None:
    truth = FrictionLoss(time=time)
    baseline = _prepared(truth, kind, rate)
    plant = unpack(baseline.fit.theta)
    assert plant.creep_velocity == pytest.approx(truth.creep_velocity, rel=0.15)
    assert plant.creep_lead == pytest.approx(1.0 / truth.rate, abs=1e-3)
    assert plant.level == pytest.approx(truth.level, rel=0.05)
    assert baseline.noise_ratio < 1.1


@pytest.mark.parametrize(("back", "shown"), [(0.0, False), (0.01, False), (0.1, True), (0.5, True)])
def test_a_motion_in_one_direction_shows_no_creep(back: float, shown: bool) -> None:
    """A motor that turned one way, with cogging, had taken a base that creeps, and a wave of another order."""
    speed = np.where(np.arange(1000) < 1000 * back, -1.0, 1.0)
    position = np.cumsum(speed) * 1e-2
    time = np.arange(1000, dtype=np.float64) * np.float64(1e-2)
    tracks = build_tracks([Recording(time, position, np.sign(speed))], [None])
    assert may_creep(tracks) is shown


@pytest.mark.slow
def test_a_joint_that_sticks_keeps_its_bristle() -> None:
    baseline = _prepared(FrictionLoss(time=0.002, impedance=STICKING), "rests", 1000)
    assert unpack(baseline.fit.theta).creep_velocity == 0.0
    assert baseline.box.upper[-2] == 0.0
    assert not baseline.fit.jacobian[:, -2:].any()
    assert baseline.noise_ratio < 1.1
