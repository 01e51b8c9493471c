"""A stop that dissipates: its stiffness, damping and edge, and that it never pulls."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fricomp.diagnosis.diagnose import diagnose
from fricomp.diagnosis.effects import EFFECTS, Context
from fricomp.diagnosis.effects.settings import EFFECT
from fricomp.diagnosis.inputs.track import differentiate

from ..toy_joint import ToyJoint, recording


def test_a_damped_stop_pushes_in_and_never_pulls_on_the_way_out() -> None:
    time = np.arange(0.0, 4.0, 1e-3)
    velocity = differentiate(np.sin(3.0 * time), 1e-3, EFFECT.quick_window)
    motion = cast(Context, SimpleNamespace(position=np.sin(3.0 * time), quick_velocity=velocity))
    values = {"stiffness": 5.0, "damping": 4.0, "edge": 0.9, "side": 1.0}
    torque = np.asarray(EFFECTS["end_stop"].compute_contribution(motion, values).additive)
    depth, speed = np.sin(3.0 * time) - 0.9, 3.0 * np.cos(3.0 * time)
    inside = np.abs(depth) > 2e-3  # at the edge itself the speed that is smoothed makes a difference
    wanted = np.where(depth > 0.0, np.maximum(5.0 * depth + 4.0 * speed, 0.0), 0.0)
    assert torque[inside] == pytest.approx(wanted[inside], abs=0.02)
    assert torque.min() == 0.0
    assert np.any((torque == 0.0) & (depth > 0.01))


@pytest.mark.slow
def test_a_damped_stop_is_named_with_its_numbers() -> None:
    stop = {"stiffness": 90.0, "damping": 3.5, "edge": 0.8}
    answer = diagnose(recording(ToyJoint(stop=tuple(stop.values())), "fourier", 30.0, 5))  # type: ignore[arg-type]
    assert [effect.name for effect in answer.effects] == ["end_stop"]
    for name, truth in stop.items():
        found = answer.effects[0].parameters[name]
        assert found.ci95 is not None
        assert found.ci95[0] < truth < found.ci95[1], name
        assert found.value == pytest.approx(truth, rel=0.2)
