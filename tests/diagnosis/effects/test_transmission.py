"""Torque of a load behind a spring, a gap, or a gear that runs unevenly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fricomp.diagnosis.effects import EFFECTS, Context
from fricomp.diagnosis.effects.settings import EFFECT
from fricomp.diagnosis.effects.structure import Candidate, Structure
from fricomp.diagnosis.effects.two_masses import CarriedLoad, Coupling, Transmission, compute_carried, compute_twist
from fricomp.diagnosis.joint.base import pack
from fricomp.diagnosis.joint.observer import Plant

FREQUENCY = 12.0  # [rad/s] of the motion


@pytest.fixture(scope="module")
def context() -> Context:
    time = np.arange(8000) * 1e-3
    q = 0.4 * np.sin(FREQUENCY * time)
    curve = (2.0, 3.0, 0.05, 1.0)
    plant = Plant(0.5, (0.0, 0.0), 0.0, curve, curve, 4e4)
    zero = np.zeros_like(q)
    velocity, acceleration = 0.4 * FREQUENCY * np.cos(FREQUENCY * time), -(FREQUENCY**2) * q
    return Context(1e-3, q, velocity, acceleration, zero, zero, zero, zero, zero, plant, True, 2.0)


def test_a_stiff_transmission_adds_nothing(context: Context) -> None:
    torque = compute_carried(context, Transmission(0.3, 0.3 * 3000.0**2, 0.3))
    assert np.abs(torque[1000:-100]).max() < 1e-3 * 0.3 * np.abs(context.acceleration).max()


def test_a_spring_amplifies_the_load_as_below_its_resonance(context: Context) -> None:
    inertia, own = 0.3, 60.0
    torque = compute_carried(context, Transmission(inertia, inertia * own**2, 0.05))
    expected = inertia * context.acceleration * FREQUENCY**2 / (own**2 - FREQUENCY**2)
    late = slice(4000, -100)
    gain = float(torque[late] @ expected[late]) / float(expected[late] @ expected[late])
    assert gain == pytest.approx(1.0, abs=0.02)


def test_gravity_turns_with_the_load_and_not_with_the_motor(context: Context) -> None:
    still = replace(
        context, position=np.full_like(context.position, 0.3), plant=replace(context.plant, gravity=(0.0, 5.0))
    )
    stiffness = 400.0
    torque = compute_carried(still, Transmission(0.3, stiffness, 0.7))
    load = 5.0 * np.sin(0.3)
    assert torque[-200] == pytest.approx(-5.0 * np.cos(0.3) * load / stiffness, rel=0.02)


def test_a_spring_is_looked_for_where_rows_can_show_it(context: Context) -> None:
    """A coarse encoder asks for wide rows, and a load that swings faster than these leaves noise alone in them."""
    effect = EFFECTS["joint_elasticity"]
    usual, wide = [context], [replace(context, row_width=3.0 * context.row_width)]
    highest = [effect.list_parameters(one)[0].upper for one in (usual, wide)]
    assert highest[0] - highest[1] == pytest.approx(2.0 * np.log(3.0))
    stiffest = [max(start["stiffness"] for start in effect.scan(one)) for one in (usual, wide)]
    assert stiffest[0] - stiffest[1] == pytest.approx(2.0 * np.log(3.0))


def test_a_gap_changes_no_momentum_over_a_period(context: Context) -> None:
    gap, inertia = 2e-3, 0.3
    torque = compute_carried(context, Transmission(inertia, inertia * 600.0**2, 0.2, gap))
    period = round(2.0 * np.pi / FREQUENCY / 1e-3)
    assert np.abs(torque).max() > 0.2
    assert abs(torque[2000 : 2000 + 10 * period].mean()) < 0.01 * np.abs(torque).max()


@pytest.mark.parametrize(("rate", "damping"), [(300.0, 0.8), (900.0, 0.2)])
def test_a_gap_is_that_of_its_own_contact(rate: float, damping: float, context: Context) -> None:
    """Teeth of other joints are softer or ring: what touches is a part of the gap's law, within the bounds of it."""
    gap, logs = EFFECTS["backlash"], {"gap": 4e-3, "contact_rate": rate, "contact_damping": damping}
    values = {name: float(np.log(one)) for name, one in logs.items()} | {"load_share": 0.6}
    bounds = {one.name: (one.lower, one.upper) for one in gap.list_parameters([context])}
    assert all(bounds[name][0] < value < bounds[name][1] for name, value in values.items())
    inertia = 0.6 * context.plant.inertia
    expected = compute_carried(context, Transmission(inertia, inertia * rate**2, damping, 4e-3))
    np.testing.assert_allclose(gap.compute_contribution(context, values).additive, expected, rtol=1e-9, atol=1e-9)
    assert float(np.std(expected)) > 0.01


def test_uneven_running_is_that_of_a_load_that_leads(context: Context) -> None:
    plant = replace(context.plant, gravity=(1.0, 3.0))
    here = replace(context, plant=plant)
    values = {"sine": 1e-3, "cosine": 0.0, "order": 9.0, "load_share": 0.6}
    torque = np.asarray(EFFECTS["kinematic_error"].compute_contribution(here, values).additive)
    # Lagrange: the motor feels the load's torque times the slope of its position by the motor's.
    q, inertia = context.position, 0.6 * plant.inertia
    slope = 1.0 + 9e-3 * np.cos(9.0 * q)
    load = q + 1e-3 * np.sin(9.0 * q)
    acceleration = slope * context.acceleration - 81e-3 * np.sin(9.0 * q) * context.velocity**2
    felt = slope * (inertia * acceleration + np.cos(load) + 3.0 * np.sin(load))
    rigid = inertia * context.acceleration + np.cos(q) + 3.0 * np.sin(q)
    assert np.abs(torque - (felt - rigid)).max() < 0.02 * np.abs(torque).max()


def test_a_sensor_loop_saturates_at_its_width(context: Context) -> None:
    swinging = replace(context, recorded=3.0 * np.sin(FREQUENCY * context.time))
    values = {"height": 0.1, "width": np.log(0.8), "exponent": np.log(20.0), "initial": 0.0}
    effect = EFFECTS["torque_sensor_hysteresis"]
    loop = np.asarray(effect.compute_contribution(swinging, values).additive)
    assert np.abs(loop).max() == pytest.approx(0.08, rel=1e-2)
    later = loop[round(2.0 * np.pi / FREQUENCY / 1e-3) :]
    assert later.max() == pytest.approx(-later.min(), rel=1e-2)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_a_sensor_loop_is_larger_than_the_noise_and_saturates(noise: float, context: Context) -> None:
    swinging = replace(context, recorded=3.0 * np.sin(FREQUENCY * context.time), noise=noise)
    effect = EFFECTS["torque_sensor_hysteresis"]
    width = effect.list_parameters([swinging])[1]
    assert np.exp(width.lower) == pytest.approx(max(10.0 * noise, 0.015), rel=0.01)
    assert np.exp(width.upper) == pytest.approx(0.8 * 3.0, rel=0.01)
    assert all(width.lower <= start["width"] <= width.upper for start in effect.scan([swinging]))


@pytest.mark.parametrize(("height", "physical"), [(-0.03, True), (0.03, False)])
def test_a_sensor_reads_late_and_never_ahead(height: float, physical: bool, context: Context) -> None:
    values = {"height": height, "width": 0.0, "exponent": 0.0, "initial": 0.0}
    assert (EFFECTS["torque_sensor_hysteresis"].refuse(values, [context]) is None) == physical


@pytest.mark.parametrize(("amplitude", "physical"), [(1e-3, True), (4e-3, False)])
def test_a_gear_whose_load_would_stand_still_along_a_wave_is_none(
    amplitude: float, physical: bool, context: Context
) -> None:
    values = {"sine": 0.6 * amplitude, "cosine": 0.8 * amplitude, "order": 200.0, "load_share": 0.5}
    assert (EFFECTS["kinematic_error"].refuse(values, [context]) is None) == physical


@pytest.mark.slow
def test_a_twist_is_that_of_its_equation_though_samples_are_far_apart() -> None:
    """A step that took the motor's position from half a step later would twist by 0.3 mrad more."""
    stiffness, damping, half, dt = 2e4, 60.0, 1e-3, 2e-3
    coupling = Coupling(4.0, stiffness, damping, half)

    def move(t: np.ndarray | float) -> np.ndarray:
        return np.asarray(0.3 * np.sin(np.asarray(t)))

    def weigh(t: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        return 4.0 + np.sin(0.7 * np.asarray(t)), 12.0 * np.cos(1.3 * np.asarray(t))

    def differentiate(t: float, state: np.ndarray) -> list[float]:
        inertia, gravity = weigh(t)
        torque, damped = coupling.pull(float(state[0] - move(t)), float(state[1] - 0.3 * np.cos(t)))
        torque -= damped * float(state[1] - 0.3 * np.cos(t))
        return [state[1], float((torque - gravity) / inertia)]

    time = np.arange(0.0, 12.0, dt)
    inertia, gravity = weigh(time)
    start = [float(coupling.compute_rest(12.0)), 0.3]
    exact = solve_ivp(differentiate, (0.0, 12.0), start, t_eval=time, max_step=5e-4, rtol=1e-7, atol=1e-9)
    twist = compute_twist(move(time), dt, CarriedLoad(inertia, gravity, np.zeros_like(time)), coupling)
    settled = time > 1.0
    off = (twist - (move(time) - exact.y[0]))[settled]
    assert np.sqrt(np.mean(off**2)) < 0.05 * half


def _record_swing(context: Context, load: Transmission, twist: float, rate: float) -> tuple[Context, np.ndarray]:
    """A recording whose load starts off its rest by `twist` [rad] and `rate` [rad/s], and the torque that it draws."""
    time, own = context.time, np.sqrt(load.stiffness / load.inertia)

    def move(t: float, state: np.ndarray) -> tuple[float, float]:
        lead = 0.4 * np.sin(FREQUENCY * t) - state[0]
        slip = 0.4 * FREQUENCY * np.cos(FREQUENCY * t) - state[1]
        return state[1], own**2 * lead + 2.0 * load.damping_ratio * own * slip

    start = [-twist, 0.4 * FREQUENCY - rate]
    theta, speed = solve_ivp(move, (0.0, time[-1]), start, t_eval=time, rtol=1e-9, atol=1e-11).y
    pull = load.inertia * (
        own**2 * (context.position - theta) + 2 * load.damping_ratio * own * (context.velocity - speed)
    )
    drawn = pull - load.inertia * context.acceleration
    return replace(context, recorded=drawn), drawn


@pytest.mark.parametrize(("twist", "rate"), [(0.0, 0.0), (0.01, 0.0), (-0.005, 0.5)])
def test_a_load_may_swing_when_a_recording_begins(twist: float, rate: float, context: Context) -> None:
    load = Transmission(0.3, 0.3 * 70.0**2, 0.01)
    recorded, drawn = _record_swing(context, load, twist, rate)
    found = compute_carried(recorded, load)
    inner = slice(50, -50)
    assert np.std((found - drawn)[inner]) < 0.03 * np.std(drawn[inner])


@pytest.mark.parametrize("samples", [1, 3, 20])
def test_a_few_samples_late_in_a_swing_tell_next_to_nothing(samples: int, context: Context) -> None:
    """Two numbers would meet them exactly, and make the beginning of a swing that dies away as large as they like."""
    load = Transmission(0.3, 0.3 * 70.0**2, 0.02)
    swings = round(EFFECT.ringing / (0.02 * 70.0 * context.dt))
    assert swings < context.time.size
    slides = np.arange(context.time.size) >= swings - samples
    recorded = replace(context, recorded=np.where(slides, 20.0, 0.0), velocity=np.where(slides, 1e3, 0.0))
    still = replace(recorded, velocity=np.zeros(slides.size))
    swing = np.subtract(compute_carried(recorded, load), compute_carried(still, load))
    assert np.max(np.abs(swing)) < 0.1 * np.std(context.acceleration) * load.inertia


def test_no_swing_is_looked_for_where_the_joint_may_stick(context: Context) -> None:
    load = Transmission(0.3, 0.3 * 70.0**2, 0.01)
    recorded, _ = _record_swing(context, load, 0.01, 0.0)
    slow = replace(recorded, plant=replace(context.plant, forward=(2.0, 3.0, 9.0, 1.0), reverse=(2.0, 3.0, 9.0, 1.0)))
    plain = replace(slow, recorded=np.zeros_like(recorded.recorded))
    np.testing.assert_array_equal(compute_carried(slow, load), compute_carried(plain, load))


@pytest.mark.parametrize("name", ["backlash", "joint_elasticity"])
def test_a_load_stays_as_heavy_where_the_joint_turns_out_to_be_another(context: Context, name: str) -> None:
    """A gap took half of the inertia from the base. Its load was told as a share of that, and became another load as
    soon as the share was one of the inertia that was found."""
    heavier = (replace(context, plant=replace(context.plant, inertia=1.3 * context.plant.inertia)),)
    values = {"stiffness": 6.0, "damping_ratio": -2.0, "gap": -5.0, "load_share": 0.6}
    values |= {"contact_rate": 6.0, "contact_damping": -1.0}
    before = Structure((context,), (Candidate(name, tuple(values.items())),))
    after = before.move_to(heavier)
    share = after.name_values(after.build_start())[name]["load_share"]
    assert share == pytest.approx(0.6 / 1.3)
    at = [np.concatenate([pack(one.contexts[0].plant), one.build_start()]) for one in (before, after)]
    added = [one.compute_contributions(theta)[0].additive for one, theta in zip((before, after), at, strict=True)]
    assert np.max(np.abs(added[0] - added[1])) < 1e-9 * np.max(np.abs(added[0]))
    assert after.move_to((context,)).build_start() == pytest.approx(before.build_start())


def test_a_spring_of_a_motor_without_inertia_or_that_never_swings_is_none(context: Context) -> None:
    """A soft bristle that is damped as strongly came with a spring of both beside its own name."""
    effect = EFFECTS["joint_elasticity"]
    usual = {"stiffness": 6.0, "load_share": 0.6, "damping_ratio": -2.0, "hardening": 0.0}
    assert effect.doubt(usual, (context,)) is None
    assert effect.doubt(usual | {"load_share": EFFECT.load_shares[0]}, (context,)) is None
    assert effect.doubt(usual | {"load_share": EFFECT.load_shares[1]}, (context,)) == "the motor would have no inertia"
    assert effect.doubt(usual | {"damping_ratio": 0.0}, (context,)) == "the spring would never swing"
