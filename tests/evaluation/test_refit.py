"""All numbers of a model fitted together: the minimum does not hang on where the fit starts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.evaluation import measure_torque_error, read_motion, refit_model
from fricomp.laws import BidirectionalStribeck, Cogging, FrictionLaw, LoadCoulomb, LuGre, StribeckCurve, Term
from fricomp.model import FrictionModel, JointDynamics
from fricomp.recording import Recording

INERTIA, GRAVITY, NOISE = 0.03, 0.9, 0.01
COULOMB, STATIC, FALL, VISCOUS = 0.3, 0.4, 0.06, 0.1
WAVE, ORDER, LOAD = 0.08, 30.0, 0.2


def _record(*, wave: float = 0.0, load: float = 0.0, viscous: float = VISCOUS) -> Recording:
    """A motion of three sines, and the torque that it takes by an equation of the tests' own."""
    t = np.arange(4000, dtype=np.float64) * np.float64(4e-3)
    parts = np.array([(0.8, 0.13, 0.0), (0.3, 0.41, 1.0), (0.1, 1.3, 2.0)])
    angle = 2.0 * np.pi * np.outer(parts[:, 1], t) + parts[:, 2:]
    rate = 2.0 * np.pi * parts[:, 1]
    q, v = parts[:, 0] @ np.sin(angle), (parts[:, 0] * rate) @ np.cos(angle)
    a = -(parts[:, 0] * rate**2) @ np.sin(angle)
    gravity = GRAVITY * np.cos(q)
    level = COULOMB + (STATIC - COULOMB) * np.exp(-((v / FALL) ** 2)) + load * np.abs(gravity)
    torque = INERTIA * a + gravity + level * np.sign(v) + viscous * v + wave * np.sin(ORDER * q)
    noise = NOISE * np.random.default_rng(0).normal(size=t.size)
    return Recording(t, q, np.asarray(torque + noise, dtype=np.float64))


def _start(curve: tuple[float, float, float, float], *terms: Term) -> FrictionModel:
    side = StribeckCurve(*curve)
    law = FrictionLaw((BidirectionalStribeck(side, side), *terms))
    return FrictionModel(law, dynamics=JointDynamics(inertia=1.0, gravity_cosine=0.0, gravity_sine=0.0))


def _held(model: FrictionModel) -> tuple[str, ...]:
    return ("offset", *(name for name in model.law.parameters() if name.endswith("exponent")))


CURVES = [
    (0.3, 0.4, 0.06, 0.1),
    (0.01, 0.01, 0.01, 50.0),
    (0.01, 3.0, 1e-3, 0.0),
    (9.0, 0.0, 40.0, 0.0),
]
"""Where fits start: the truth; next to no friction; a fall that no sample shows; one that lasts over all speeds."""


@pytest.mark.parametrize(("curve", "size"), list(zip(CURVES, (1.0, 1e-6, 1.0, 1e-6), strict=True)))
def test_every_start_comes_to_the_same_minimum(curve: tuple[float, float, float, float], size: float) -> None:
    motion = read_motion(_record(wave=WAVE))
    start = _start(curve, Cogging(size, -size, ORDER * 1.002))
    found = refit_model(start, [motion], held=_held(start), fold=False).model
    truth = _start(CURVES[0], Cogging(WAVE, 0.0, ORDER))
    assert truth.dynamics is not None
    truth = replace(truth, dynamics=replace(truth.dynamics, inertia=INERTIA, gravity_cosine=GRAVITY))
    assert measure_torque_error(found, motion).rms < 1.02 * measure_torque_error(truth, motion).rms
    numbers = found.law.parameters()
    assert numbers["cogging.order"] == pytest.approx(ORDER, rel=1e-3)
    assert np.hypot(numbers["cogging.sine"], numbers["cogging.cosine"]) == pytest.approx(WAVE, rel=0.03)
    assert numbers["stribeck.forward.coulomb_torque"] == pytest.approx(COULOMB, rel=0.03)
    assert found.dynamics is not None
    assert found.dynamics.inertia == pytest.approx(INERTIA, rel=0.05)


def test_a_term_that_starts_at_nothing_is_fitted() -> None:
    motion = read_motion(_record(load=LOAD))
    start = _start(CURVES[0], LoadCoulomb(1e-17))
    found = refit_model(start, [motion], held=_held(start), fold=False).model
    assert found.law.parameters()["load_coulomb.coefficient"] == pytest.approx(LOAD, rel=0.05)


def test_what_may_not_be_negative_ends_at_zero_and_the_others_make_the_best_of_it() -> None:
    motion = read_motion(_record(viscous=-0.02))
    start = _start(CURVES[0])
    found = refit_model(start, [motion], held=_held(start), fold=False).model
    numbers = found.law.parameters()
    assert 0.0 <= numbers["stribeck.forward.viscous_coefficient"] < 1e-6
    assert measure_torque_error(found, motion).rms < 0.03


def test_folds_stay_near_the_minimum_of_all() -> None:
    motion = read_motion(_record(load=LOAD))
    start = _start(CURVES[1], LoadCoulomb(1e-17))
    found = refit_model(start, [motion], held=_held(start))
    least = measure_torque_error(found.model, motion).rms
    assert len(found.folds) == 4
    assert all(measure_torque_error(one, motion).rms < 1.1 * least for one in found.folds)


def test_a_bristle_whose_level_falls_to_nothing_is_fitted_all_the_same() -> None:
    motion = read_motion(_record())
    side = StribeckCurve(1e-6, 5.0, 0.02, 0.1)
    start = replace(_start(CURVES[0]), law=FrictionLaw((LuGre(side, side, 4e4, 0.0),)))
    found = refit_model(start, [motion], held=_held(start), fold=False).model
    assert measure_torque_error(found, motion).rms < 0.5 * measure_torque_error(start, motion).rms
