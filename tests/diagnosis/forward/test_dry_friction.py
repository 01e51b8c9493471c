"""Friction of a joint that is simulated forward acts as its law says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.forward.dry_friction import FrictionCurve, build_dry_friction, compute_bristle_rate
from fricomp.diagnosis.joint.kernel import compute_creep_friction
from fricomp.diagnosis.joint.observer import Plant
from fricomp.laws import LuGre, OperatingPoint, StribeckCurve
from fricomp.laws.term import Scalar

_STEP = 2e-4  # [s]
_SIDES = (1.5, 2.2, 0.05, 0.8), (1.8, 2.4, 0.04, 0.6)
_PLANT = Plant(0.3, (0.0, 0.0), 0.0, *_SIDES, 2000.0, 1.5)
_VELOCITY = 0.05 * np.sin(np.arange(20_000) * _STEP * 5.0) + 0.03 * np.sin(np.arange(20_000) * _STEP * 17.0)


def _followed(plant: Plant) -> np.ndarray:
    """Friction torque along a slow motion with many turns [N·m]. Shape (n,)."""
    curve, dry = FrictionCurve(plant, _STEP, 0.0), build_dry_friction(plant, plant.inertia, _STEP, 0.0)
    torque = np.empty(_VELOCITY.size)
    for k, w in enumerate(_VELOCITY.tolist()):
        level, viscous = curve.follow(w)
        torque[k] = viscous + dry.follow(w, level, 0.0)[0]
    return torque


def test_a_bristle_is_that_of_the_friction_law() -> None:
    forward, reverse = (StribeckCurve(*side) for side in _SIDES)
    law = LuGre(forward, reverse, sigma_0=_PLANT.sigma_0, sigma_1=_PLANT.sigma_1)
    state: Scalar = 0.0
    known = np.empty(_VELOCITY.size)
    for k, w in enumerate(_VELOCITY):
        known[k], state = law.advance(state, OperatingPoint(velocity=w), _STEP)
    np.testing.assert_allclose(_followed(_PLANT), known, atol=1e-9)


def test_elements_that_yield_abruptly_have_their_stiffness_at_a_turn_and_then_their_level() -> None:
    plant = replace(_PLANT, sigma_1=0.0, sharpness=1.0, spread=1.5)
    dry, turn = build_dry_friction(plant, plant.inertia, _STEP, 1.0), 1e-3
    assert dry.follow(turn, 1.0, 0.0) == (1.0, 0.0)
    small = dry.follow(-turn, 1.0, 0.0)[0]
    assert 1.0 - small == pytest.approx(plant.sigma_0 * turn * _STEP * (1.5 + 1.0 + 1.0 / 1.5) / 3.0)
    assert dry.follow(-1e3, 1.0, 0.0)[0] == pytest.approx(-1.0)


def test_a_bristle_too_stiff_for_the_step_is_friction_loss() -> None:
    stiff = replace(_PLANT, sigma_0=1e9)
    assert compute_bristle_rate(stiff, stiff.inertia) * _STEP > 0.5
    assert build_dry_friction(stiff, stiff.inertia, _STEP, 0.0).follow(0.1, 1.7, 0.0) == (0.0, 1.7)


@pytest.mark.parametrize("sharpness", [0.0, 0.7, 1.0])
def test_friction_that_creeps_is_that_of_the_kernel(sharpness: float) -> None:
    plant = replace(_PLANT, creep_velocity=1e-3, creep_lead=5e-3, sharpness=sharpness)
    dry, slip = build_dry_friction(plant, plant.inertia, _STEP, 0.0), (_STEP + plant.creep_lead) / plant.inertia
    for w, net in ((0.0, 0.3), (2e-3, -0.4), (-5e-3, 0.1), (0.3, 4.0)):
        known = compute_creep_friction(w + slip * net, 1.5, plant.creep_velocity, sharpness, slip)
        assert dry.follow(w, 1.5, net)[0] == pytest.approx(known, rel=1e-12, abs=1e-12)


def test_friction_that_creeps_never_takes_more_than_it_is_given() -> None:
    dry = build_dry_friction(replace(_PLANT, creep_velocity=1e-3), _PLANT.inertia, _STEP, 0.0)
    for net in (0.0, 0.5, 1.0, 20.0):
        torque, loss = dry.follow(0.0, 1.5, net)
        assert loss == 0.0
        assert 0.0 <= torque <= min(net, 1.5)
