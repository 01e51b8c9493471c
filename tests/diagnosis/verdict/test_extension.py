"""The exported extended model holds a term of each named effect, and gives the torque that was fitted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.control import Compensator
from fricomp.diagnosis.effects import EFFECTS, Context
from fricomp.diagnosis.effects.structure import Candidate, Structure
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.base import pack
from fricomp.diagnosis.joint.kernel import observe
from fricomp.diagnosis.joint.observer import Plant
from fricomp.diagnosis.joint.solver import Fit
from fricomp.diagnosis.search.explanation import Explanation
from fricomp.diagnosis.verdict.extension import write_extended_model
from fricomp.laws import (
    BidirectionalStribeck,
    DwellStiction,
    KinematicError,
    LaggedLuGre,
    LaggedStribeck,
    OperatingPoint,
    ThermalFriction,
)
from fricomp.model import FrictionModel, decode_model, encode_model
from fricomp.recording import Recording

DT, N = 1e-3, 8000
PLANT = Plant(0.3, (1.0, 5.0), 0.0, (2.0, 3.0, 0.05, 1.0), (2.2, 3.1, 0.06, 0.05), 4e4)
LAG = {"lag": 8e-3}
SOFT = {"breakaway_distance": float(np.log(2e-3)), "damping_time": 1e-3}
DWELL = {"rise": 0.8, "time_constant": float(np.log(0.5)), "travel": float(np.log(5e-3))}
THERMAL = {"viscous_slope": 0.02, "coulomb_slope": 0.01}
UNEVEN = {"sine": 2e-4, "cosine": -1e-4, "order": 30.0, "load_share": 0.7}


def draw_motion() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, velocity and acceleration of a random motion with rests."""
    rng, time = np.random.default_rng(4), DT * np.arange(N)
    waves = rng.uniform(0.1, 1.5, 5), rng.uniform(0.0, 2.0 * np.pi, 5), rng.uniform(0.1, 0.4, 5)
    velocity = sum(size * np.sin(2.0 * np.pi * f * time + phase) for f, phase, size in zip(*waves, strict=True))
    velocity = np.where((time % 2.0 < 0.6) | (np.abs(velocity) < 5e-3), 0.0, velocity)
    return np.cumsum(velocity) * DT, velocity, np.gradient(velocity, DT)


@pytest.fixture(scope="module")
def context() -> Context:
    position, velocity, acceleration = draw_motion()
    gravity = PLANT.compute_gravity_torque(position, True)
    warm = 30.0 + 10.0 * np.sin(np.arange(N) * DT)
    return Context(
        dt=DT,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        torque=gravity,
        recorded=gravity,
        gravity=gravity,
        load_torque=gravity,
        friction=2.0 * np.sign(velocity) + velocity,
        plant=PLANT,
        rotary=True,
        scale=2.0,
        usual_temperature=float(np.mean(warm)),
        channels={"temperature": warm},
    )


def extend(context: Context, **effects: dict[str, float]) -> FrictionModel | None:
    """The extended model of an explanation whose fit ended at these values."""
    candidates = tuple(Candidate(name, tuple(values.items())) for name, values in effects.items())
    structure = Structure((context,), candidates)
    theta = np.concatenate([pack(PLANT), structure.build_start()])
    fit = Fit(theta, np.zeros(1), np.zeros((1, theta.size)), 0.0)
    explanation = Explanation(structure, fit, structure.build_box(), 1.0, 1.0, 1.0)
    columns = {"time": context.time, "position": context.position, "torque": context.torque}
    return write_extended_model([Recording.from_channels(columns)], explanation)


def extended(context: Context, **effects: dict[str, float]) -> FrictionModel:
    """The same as it is read from its file."""
    model = extend(context, **effects)
    assert model is not None
    return decode_model(encode_model(model))


def follow(model: FrictionModel, context: Context, velocity: FloatArray | None = None) -> FloatArray:
    """Torque of the model's law along the motion, step by step. Shape (n,)."""
    state, found = model.law.rest_state(), []
    for k, v in enumerate(context.velocity if velocity is None else velocity):
        point = OperatingPoint(
            float(v),
            position=float(context.position[k]),
            acceleration=float(context.acceleration[k]),
            temperature=float(context.channels["temperature"][k]),
        )
        torque, state = model.law.advance(state, point, context.dt)
        found.append(float(torque))
    return np.array(found)


@pytest.mark.parametrize(
    ("name", "values", "term"),
    [
        ("thermal_friction", THERMAL, ThermalFriction),
        ("dwell_stiction", DWELL, DwellStiction),
        ("kinematic_error", UNEVEN, KinematicError),
    ],
)
def test_the_term_gives_what_the_effect_contributed(
    name: str, values: dict[str, float], term: type, context: Context
) -> None:
    model = extended(context, **{name: values})
    assert isinstance(model.law.term(name), term)
    contribution = EFFECTS[name].compute_contribution(context, values)
    expected = np.broadcast_to(contribution.additive + contribution.level * np.sign(context.velocity), (N,))
    core = np.asarray(BidirectionalStribeck(model.forward, model.reverse).torque(OperatingPoint(context.velocity)))
    added = follow(model, context) - core
    assert np.max(np.abs(expected)) > 0.03
    np.testing.assert_allclose(added, expected, atol=1e-9)


@pytest.mark.parametrize("name", ["thermal_friction", "dwell_stiction", "kinematic_error"])
def test_it_compensates_at_once(name: str, context: Context) -> None:
    model = extended(context, **{name: {"thermal_friction": THERMAL, "dwell_stiction": DWELL}.get(name, UNEVEN)})
    compensator = Compensator(model, period=DT, source="reference", gain=1.0, smoothing=1e-12, authority=99.0)
    columns = context.velocity, context.position, context.channels["temperature"], context.acceleration
    found = [
        compensator.torque(v, position=q, temperature=hot, acceleration=a)
        for v, q, hot, a in zip(*(column.tolist() for column in columns), strict=True)
    ]
    np.testing.assert_allclose(found, follow(model, context), atol=1e-9)


def observed(plant: Plant, context: Context) -> tuple[FloatArray, FloatArray]:
    """Velocity of the diagnosis' own simulated joint, and all of the friction on it in each step. Shapes (n - 1,)."""
    zeros = np.zeros((1, N))
    signals = (context.position[None].copy(), context.velocity[None].copy(), zeros, zeros)
    plants, out = np.repeat(plant.to_slots()[:, None], 8, axis=1), np.empty((4, 8, N))
    steps, settings = np.ones(N, dtype=np.int64), np.array([DT, 3000.0, 100.0, 0.0, 0.0])
    observe(signals, np.zeros((4, 8), dtype=np.int64), plants, settings, steps, (0,) * 8, out)
    u, _, w, _ = out[:, 0]
    return w[:-1], u[:-1] - plant.inertia * np.diff(w) / DT


def test_friction_that_lags_with_a_soft_bristle_is_that_of_the_simulated_joint(context: Context) -> None:
    model = extended(context, frictional_lag=LAG, presliding_hysteresis=SOFT)
    (term,) = model.law.terms
    assert isinstance(term, LaggedLuGre)
    velocity, friction = observed(replace(PLANT, sigma_0=term.sigma_0, sigma_1=term.sigma_1, lag=8e-3), context)
    found = follow(model, context, velocity)
    prompt = np.asarray(model.torque(velocity))
    assert np.max(np.abs(prompt - friction)[velocity > 0.1]) > 0.1
    # The law takes the velocity where a step begins, the simulated joint in its middle.
    np.testing.assert_allclose(found, friction, atol=1.5e-3)


def test_friction_that_lags_is_that_of_the_simulated_joint_where_it_slides(context: Context) -> None:
    model = extended(context, frictional_lag=LAG)
    (term,) = model.law.terms
    assert isinstance(term, LaggedStribeck)
    velocity, friction = observed(replace(PLANT, sigma_0=4e5, lag=8e-3), context)
    prompt = np.asarray(model.torque(velocity))  # the curve itself, in steady sliding
    found = follow(model, context, velocity)
    slides = np.minimum.reduce([np.sign(velocity) * np.roll(velocity, k) for k in range(4)]) > 0.02
    error, without = (np.abs(one - friction)[slides] for one in (found, prompt))
    assert np.mean(slides) > 0.3
    assert np.max(error) < 5e-3
    assert np.max(without) > 0.2


def test_heat_that_was_only_estimated_is_no_term(context: Context) -> None:
    cold = replace(context, channels={})
    assert extend(cold, thermal_friction={"viscous_slope": 0.02, "time_constant": 3.0}) is None


def test_a_linear_joint_has_no_gravity_over_its_position(context: Context) -> None:
    linear = replace(context, rotary=False)
    (term,) = EFFECTS["kinematic_error"].build_terms(UNEVEN, PLANT, [linear])
    expected = EFFECTS["kinematic_error"].compute_contribution(linear, UNEVEN).additive
    point = OperatingPoint(context.velocity, context.position, context.acceleration)
    np.testing.assert_allclose(term.torque(point), expected, atol=1e-12)
