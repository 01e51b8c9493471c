"""A drive that stops at a limit: what it is told of the limit, and that a joint without one is told none."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fricomp.diagnosis.diagnose import diagnose
from fricomp.diagnosis.effects import EFFECTS, Context

from ..toy_joint import ToyJoint, recording


@pytest.mark.slow
def test_a_torque_limit_that_the_command_exceeds_is_named_with_its_size() -> None:
    limit = 6.3
    log = recording(ToyJoint(limit=limit), "fourier", 40.0, 3)
    beyond = float(np.mean(np.abs(np.asarray(log.torque)) > limit))
    assert 0.001 < beyond < 0.2
    answer = diagnose(log)
    assert [effect.name for effect in answer.effects] == ["torque_saturation"]
    found = answer.effects[0].parameters["limit"]
    assert found.ci95 is not None
    assert found.ci95[0] < limit < found.ci95[1]
    assert found.value == pytest.approx(limit, rel=0.02)


@pytest.mark.parametrize(("limit", "refused"), [(1.4, False), (0.4, True)])
def test_a_limit_that_most_of_the_recording_exceeds_is_none(limit: float, refused: bool) -> None:
    """Friction alone asks for more than 0.4 N·m, so any torque would be as good as another."""
    time = np.arange(0.0, 20.0, 0.01)
    torque = np.sign(np.cos(time)) + 0.6 * np.sin(7.0 * time)
    motion = cast(Context, SimpleNamespace(recorded=torque, position=np.sin(time)))
    why = EFFECTS["torque_saturation"].refuse({"coefficient": 0.0, "limit": limit}, [motion])
    assert (why is not None and "most of the recording" in why) == refused


@pytest.mark.parametrize(("coefficient", "refused"), [(0.01, False), (-0.002, False), (-0.1, True)])
def test_below_its_limit_no_drive_gives_more_than_is_recorded(coefficient: float, refused: bool) -> None:
    time = np.arange(0.0, 20.0, 0.01)
    motion = cast(Context, SimpleNamespace(recorded=1.6 * np.sin(7.0 * time), position=np.sin(time)))
    why = EFFECTS["torque_saturation"].refuse({"coefficient": coefficient, "limit": 1.4}, [motion])
    assert why == ("the torque would exceed the recorded one" if refused else None)
