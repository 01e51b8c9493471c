"""What is refused for the effects that stand beside each other."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fricomp.diagnosis.effects.structure import N_BASE, Structure
from fricomp.diagnosis.joint.solver import Fit
from fricomp.diagnosis.search.explanation import find_refusal


@pytest.mark.parametrize(
    ("other", "order", "refused"),
    [
        ("torque_ripple", 60.5, True),  # one part, seen twice
        ("kinematic_error", 59.0, True),
        ("torque_ripple", 120.0, False),  # another part, or another harmonic
        ("position_coulomb", 60.5, False),  # a detent makes both
    ],
)
def test_two_ripples_of_one_order_are_one_part(other: str, order: float, refused: bool) -> None:
    found = {
        "cogging": {"sine": 0.5, "cosine": 0.1, "order": 60.0},
        other: {"sine": 0.02, "cosine": 0.01, "order": order},
        "drive_lag": {"time_constant": 0.002, "order": 60.0},
    }
    joint = SimpleNamespace(name_values=lambda _: found, candidates=(), contexts=(), parameters=())
    why = find_refusal(cast(Structure, joint), cast(Fit, SimpleNamespace(theta=np.zeros(N_BASE))), bodied=True)
    assert ("two ripples of one order" in why) == refused
