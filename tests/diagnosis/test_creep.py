"""Friction that creeps: its velocity is found where a simulator made it, and a joint that sticks has none."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp import diagnose
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


def _creeping(sharpness: float, creep_velocity: float = CREEP, creep_lead: float = 0.0) -> Plant:
    curve = (LEVEL, LEVEL, 0.1, 0.0)
    return Plant(
        0.5, (0.0, 0.0), 0.0, curve, curve, 1e4,
        sharpness=sharpness, creep_velocity=creep_velocity, creep_lead=creep_lead,
    )  # fmt: skip


@pytest.mark.parametrize("substeps", [8, 40])
@pytest.mark.parametrize("lead", [0.0, 0.01])
@pytest.mark.parametrize("speed", [-0.05, -0.01, 0.002, 0.01, 0.04])
def test_friction_is_viscous_below_the_creep_velocity(speed: float, lead: float, substeps: int) -> None:
    for sharpness, wanted in ((1.0, np.clip(speed / CREEP, -1.0, 1.0)), (0.0, speed / (abs(speed) + CREEP))):
        plant = _creeping(sharpness=sharpness, creep_lead=lead)
        assert _held(plant, speed, substeps)[-2] == pytest.approx(LEVEL * wanted, rel=0.01)


@pytest.mark.parametrize("speed", [-0.2, -0.05, -0.01, 0.002, 0.02, 0.03, 0.1])
def test_friction_turns_over_as_smooth_curves_of_simulators_do(speed: float) -> None:
    """A hyperbolic tangent and an arc tangent over 1 and 0.7 times the creep velocity."""
    tangent, arc = np.tanh(speed / CREEP), 2.0 / np.pi * np.arctan(speed / (0.7 * CREEP))
    for sharpness, width, wanted in ((0.776, 1.1, tangent), (0.35, 0.98, arc)):
        plant = _creeping(sharpness=sharpness, creep_velocity=width * CREEP)
        assert _held(plant, speed, 8)[-2] == pytest.approx(LEVEL * wanted, abs=0.03 * LEVEL)


def test_creep_is_found_where_weights_of_a_bristle_hide_it() -> None:
    """These hardly count rows about rest, in which a coarse encoder's steps are loud and creep differs most."""
    truth = FrictionLoss()
    tracks = build_tracks([recording(truth, "rests", duration=24.0, rate=200, bits=15)], [None])
    plant = unpack(prepare(tracks, observer=Observer(), nulls=8, seed=0).fit.theta)
    assert plant.creep_velocity == pytest.approx(truth.creep_velocity, rel=0.5)
    assert [plant.forward[0], plant.reverse[0]] == pytest.approx([truth.level] * 2, rel=0.1)


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
@pytest.mark.parametrize(("width", "seed"), [(0.03, 2), (0.03, 7), (0.012, 3)])
def test_a_friction_that_is_a_hyperbolic_tangent_lacks_nothing(width: float, seed: int) -> None:
    """With a noise of 0.4 % of it, in which a line that is cut off leaves 6 to 30 times as much."""
    rng, time = np.random.default_rng(seed), np.arange(0.0, 30.0, 4e-3)
    position = 0.8 * np.sin(2.0 * rng.uniform(0.8, 2.0) * time) + 0.25 * np.sin(rng.uniform(3.0, 6.0) * time + 1.0)
    velocity = np.gradient(position, time)
    dry = np.tanh(velocity / width) * (1.0 + rng.uniform(0.0, 0.4) * np.exp(-((velocity / 0.06) ** 2)))
    torque = 0.15 * np.gradient(velocity, time) + 0.2 * velocity + np.sin(position) + dry
    noisy = torque + 0.004 * rng.standard_normal(time.size)
    found = diagnose(Recording(time, 2.4e-5 * np.round(position / 2.4e-5), noisy))
    assert (found.verdict, found.effects) == ("consistent", ())


@pytest.mark.slow
def test_a_joint_that_sticks_keeps_its_bristle() -> None:
    baseline = _prepared(FrictionLoss(time=0.002, impedance=STICKING), "rests", 1000)
    assert unpack(baseline.fit.theta).creep_velocity == 0.0
    assert baseline.box.upper[-2] == 0.0
    assert not baseline.fit.jacobian[:, -2:].any()
    assert baseline.noise_ratio < 1.1
