"""A joint that remembers, or carries a load behind a spring or a gap, moves in MuJoCo as an integration of its own."""

from __future__ import annotations

from dataclasses import replace
from math import copysign, exp, log, pi

import numpy as np
import pytest

from fricomp.diagnosis.effects import EFFECTS, Context
from fricomp.diagnosis.effects.forward_part import ForwardPart
from fricomp.diagnosis.effects.two_masses import Coupling
from fricomp.diagnosis.forward.forward_joint import Run, simulate_forward
from fricomp.diagnosis.inputs.controller import Controller
from fricomp.diagnosis.inputs.track import FloatArray, Track
from fricomp.diagnosis.joint.observer import Plant

from ..friction_loss import FrictionLoss, recording, reference_of
from ..held_loop import Derivative, State, gravity_of, moved, run_of

_CURVE = (1.5, 2.2, 0.05, 0.8)
_PLANT = Plant(0.3, (0.0, 3.0), 0.1, _CURVE, _CURVE, 1.5 / 3e-5)
_STIFF = 1.5 / 1e-8  # [N·m/rad], which only MuJoCo's friction loss can hold
_SPRING = Coupling(0.18, 2500.0, 1.5)
_RIGHT = 1e-5  # [rad], where the motion goes over half a radian
_GAP = Coupling(0.18, 2e4, 25.0, half_gap=2e-3)


def _friction(plant: Plant, felt: float, w: float, z: float) -> tuple[float, float]:
    """Torque [N·m] and rate of the bristle [rad/s] by [canudas1995lugre], with a level that follows `felt`."""
    coulomb, static, speed, viscous = plant.forward if w >= 0.0 else plant.reverse
    level = coulomb + (static - coulomb) * exp(-((felt / speed) ** 2))
    rate = w - plant.sigma_0 * abs(w) * z / level
    return plant.sigma_0 * z + plant.sigma_1 * rate + viscous * felt, rate


def _rigid(plant: Plant) -> Derivative:
    """State: position, velocity, bristle, and the velocity that friction feels."""

    def rates(x: State, torque: float) -> State:
        q, w, z, felt = x
        friction, rate = _friction(plant, felt if plant.lag > 0.0 else w, w, z)
        pushed = torque - gravity_of(plant, q) - plant.offset - friction
        return w, pushed / plant.inertia, rate, (w - felt) / plant.lag if plant.lag > 0.0 else 0.0

    return rates


def _with_load(plant: Plant, c: Coupling) -> Derivative:
    """State: position, velocity, bristle, position and velocity of the load."""

    def rates(x: State, torque: float) -> State:
        q, w, z, theta, speed = x
        friction, rate = _friction(plant, w, w, z)
        twist = q - theta
        beyond = max(abs(twist) - c.half_gap, 0.0)
        elastic = copysign(c.stiffness * beyond, twist)
        spring = elastic * (1.0 + c.hardening * elastic**2) + c.damping * (w - speed)
        if beyond == 0.0 or (c.half_gap > 0.0 and spring * twist < 0.0):
            spring = 0.0
        motor = (torque - plant.offset - friction - spring) / (plant.inertia - c.inertia)
        return w, motor, rate, speed, (spring - gravity_of(plant, theta)) / c.inertia

    return rates


def _error(truth: tuple[Track, FloatArray], plant: Plant, effects: ForwardPart | None = None) -> float:
    """RMS error of the simulated position once it has settled [rad]."""
    missed = simulate_forward(run_of(*truth, plant, effects)) - truth[0].position
    return float(np.sqrt(np.mean(missed[1000:] ** 2)))


@pytest.mark.parametrize(
    "plant",
    [
        replace(_PLANT, sigma_0=1.5 / 3e-3, sigma_1=2.0),
        replace(_PLANT, sigma_0=1.5 / 3e-4, forward=(1.8, 2.4, 0.03, 0.6)),
        _PLANT,
    ],
)
def test_presliding_is_in_the_simulated_motion(plant: Plant) -> None:
    truth = moved(_rigid(plant), (0.0, 0.0, 0.0, 0.0))
    right, held = _error(truth, plant), _error(truth, replace(plant, sigma_0=_STIFF, sigma_1=0.0))
    assert right < _RIGHT
    assert held > 10.0 * right


def test_friction_follows_the_simulated_velocity_late() -> None:
    late = replace(_PLANT, lag=0.015)
    truth = moved(_rigid(late), (0.0, 0.0, 0.0, 0.0))
    right, at_once = _error(truth, late), _error(truth, _PLANT)
    assert right < _RIGHT
    assert at_once > 10.0 * right


@pytest.mark.parametrize("coupling", [_SPRING, _SPRING._replace(hardening=0.02), _GAP, _SPRING._replace(half_gap=2e-3)])
def test_a_load_moves_on_its_own(coupling: Coupling) -> None:
    truth = moved(_with_load(_PLANT, coupling), (0.0, 0.0, 0.0, coupling.compute_rest(0.0), 0.0))
    right, rigid = _error(truth, _PLANT, ForwardPart(coupling=coupling)), _error(truth, _PLANT)
    assert right < _RIGHT
    assert rigid > 10.0 * right


def test_a_load_on_a_slide_moves_as_one_on_a_hinge() -> None:
    plant = replace(_PLANT, gravity=(0.0, 0.0))
    track, reference = moved(_with_load(plant, _GAP), (0.0, 0.0, 0.0, _GAP.compute_rest(0.0), 0.0), seconds=1.0)
    hinge, slide = (
        simulate_forward(run_of(replace(track, rotary=rotary), reference, plant, ForwardPart(coupling=_GAP)))
        for rotary in (True, False)
    )
    np.testing.assert_allclose(slide, hinge, atol=1e-12)


def test_a_recorded_temperature_stays_that_of_the_recording() -> None:
    warm, values = replace(_context(), channels={"temperature": np.linspace(20.0, 30.0, 4000)}), {"viscous_slope": 0.1}
    part = EFFECTS["thermal_friction"].build_forward_part(warm, values)
    assert part.states == ()
    np.testing.assert_array_equal(
        part.along.additive, EFFECTS["thermal_friction"].compute_contribution(warm, values).additive
    )


def test_friction_that_creeps_does_so_in_the_simulated_motion() -> None:
    truth = FrictionLoss()
    made = recording(truth, "rests", duration=6.0, rate=4000)
    wanted = reference_of("rests", 6.0)
    curve = (truth.level, truth.level, 0.1, 0.6)
    plant = Plant(truth.inertia, (0.0, truth.gravity), 0.0, curve, curve, 1e9, sharpness=1.0)
    creeping = replace(plant, creep_velocity=truth.creep_velocity, creep_lead=1.0 / truth.rate)
    track = Track.build(2.5e-4, np.asarray(made.position), np.asarray(made.torque))
    told = np.stack([wanted, np.gradient(wanted, track.dt)])
    loop = Controller(120.0, 6.0, frequency=4000.0, velocity_filter_frequency=-4000.0 * log(1.0 - 0.12) / (2.0 * pi))
    right, held = (
        float(np.std((simulate_forward(Run(one, track, told, loop, 0, track.size)) - track.position)[4000:]))
        for one in (creeping, plant)
    )
    assert right < _RIGHT
    assert held > 10.0 * right


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        ("dwell_stiction", {"rise": 0.8, "time_constant": log(0.3), "travel": log(0.01)}),
        ("thermal_friction", {"viscous_slope": 0.2, "time_constant": log(2.0)}),
        (
            "thermal_friction",
            {"viscous_slope": 0.2, "coulomb_slope": 0.3, "time_constant": log(2.0), "steady_share": 0.4},
        ),
    ],
)
def test_a_state_along_the_recorded_motion_is_what_the_effect_adds_there(effect: str, values: dict[str, float]) -> None:
    context = _context()
    along, part = (
        EFFECTS[effect].compute_contribution(context, values),
        EFFECTS[effect].build_forward_part(context, values),
    )
    (state,) = part.states
    state.begin(1500, context.dt)
    pairs = zip(context.velocity[1501:], context.friction[1501:], strict=True)
    seen = np.array([state.follow(float(w), float(friction)) for w, friction in pairs])
    for column, known in zip(seen.T, (along.additive, along.level), strict=True):
        np.testing.assert_allclose(column, np.broadcast_to(np.asarray(known), context.velocity.shape)[1501:], atol=1e-9)
    assert np.ptp(seen, axis=0).max() > 0.03


def test_loads_of_two_effects_are_one_behind_the_softer_spring() -> None:
    both = ForwardPart(coupling=_SPRING) + ForwardPart(coupling=_GAP)
    assert both.coupling == _SPRING._replace(half_gap=_GAP.half_gap)
    assert (ForwardPart() + ForwardPart(coupling=_GAP)).coupling == _GAP


def _context() -> Context:
    """A motion with rests."""
    time = np.arange(4000) * 1e-3
    velocity = np.where(np.sin(3.0 * time) > 0.0, 0.4 * np.sin(6.0 * time), 0.0)
    zero = np.zeros_like(time)
    friction = 1.5 * np.sign(velocity) + 0.8 * velocity
    return Context(1e-3, zero, velocity, zero, zero, zero, zero, zero, friction, _PLANT, rotary=True, scale=1.5)
