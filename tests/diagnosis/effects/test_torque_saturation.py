"""A drive that stops at a limit: what it is told of the limit, and that a joint without one is told none."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.diagnose import diagnose

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
