"""Stops that dissipate, at one end and at both: their stiffness, damping and edges, and that they never pull."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fricomp.diagnosis.diagnose import diagnose
from fricomp.diagnosis.effects import EFFECTS, Context
from fricomp.diagnosis.effects.settings import EFFECT
from fricomp.diagnosis.inputs.track import differentiate
from fricomp.laws import EndStop, FloatArray, OperatingPoint

from ..toy_joint import ToyJoint, recording


def _move(position: FloatArray, velocity: FloatArray, acceleration: FloatArray) -> Context:
    """What a stop knows of a motion."""
    known = SimpleNamespace(position=position, quick_velocity=velocity, quick_acceleration=acceleration)
    return cast(Context, known)


def test_a_damped_stop_pushes_in_and_never_pulls_on_the_way_out() -> None:
    time = np.arange(0.0, 4.0, 1e-3)
    velocity = differentiate(np.sin(3.0 * time), 1e-3, EFFECT.quick_window)
    motion = _move(np.sin(3.0 * time), velocity, np.zeros_like(time))
    values = {"stiffness": 5.0, "damping": 4.0, "inertia": 0.3, "edge": 0.9, "side": 1.0, "travel": 2.0}
    values["hardening"] = 0.0
    torque = np.asarray(EFFECTS["end_stop"].compute_contribution(motion, values).additive)
    depth, speed = np.sin(3.0 * time) - 0.9, 3.0 * np.cos(3.0 * time)
    inside = np.abs(depth) > 2e-3  # at the edge itself the speed that is smoothed makes a difference
    wanted = np.where(depth > 0.0, np.maximum(5.0 * depth + 4.0 * speed, 0.0), 0.0)
    assert torque[inside] == pytest.approx(wanted[inside], abs=0.02)
    assert torque.min() == 0.0
    assert np.any((torque == 0.0) & (depth > 0.01))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_stops_at_both_ends_push_inwards_as_the_law_says(side: float) -> None:
    position, velocity = np.linspace(-1.0, 1.0, 401), np.cos(np.arange(401.0))
    acceleration = np.sin(0.7 * np.arange(401.0))
    motion = _move(position, velocity, acceleration)
    values = {"stiffness": 5.0, "damping": 0.4, "inertia": 0.2, "edge": 0.7 * side, "side": side, "travel": 1.5}
    values["hardening"] = 3.0
    torque = np.asarray(EFFECTS["end_stop"].compute_contribution(motion, values).additive)
    low, high = sorted((0.7 * side, -0.8 * side))
    moved = 0.4 * velocity + 0.2 * acceleration
    above, below = np.maximum(position - high, 0.0), np.maximum(low - position, 0.0)
    up = np.where(position > high, np.maximum(5.0 * above * (1.0 + 3.0 * above) + moved, 0.0), 0.0)
    down = np.where(position < low, np.minimum(-5.0 * below * (1.0 + 3.0 * below) + moved, 0.0), 0.0)
    assert torque == pytest.approx(up + down, abs=1e-12)
    massless = _move(position, velocity, np.zeros(401))
    torque = np.asarray(EFFECTS["end_stop"].compute_contribution(massless, values).additive)
    law = EndStop(5.0, 0.7 * side, side, 0.4, 1.5, 3.0)
    assert law.torque(OperatingPoint(velocity, position)) == pytest.approx(torque, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("travel", [2.0e9, 1.35])
def test_damped_stops_are_named_with_their_numbers(travel: float) -> None:
    stop = {"stiffness": 90.0, "damping": 3.5, "edge": 0.8, "travel": travel}
    answer = diagnose(recording(ToyJoint(stop=tuple(stop.values())), "fourier", 30.0, 5))  # type: ignore[arg-type]
    assert [effect.name for effect in answer.effects] == ["end_stop"]
    if travel > 1e3:
        stop.pop("travel")
    for name, truth in stop.items():
        found = answer.effects[0].parameters[name]
        assert found.ci95 is not None
        assert found.ci95[0] < truth < found.ci95[1], name
        assert found.value == pytest.approx(truth, rel=0.05)
