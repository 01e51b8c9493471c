"""What stays in the model of an arm: what recurs and lowers held-out errors, a named gear, no mend by itself."""

from __future__ import annotations

import pytest

from fricomp.arm.answer import TermEvidence, _stays


def weigh(recurrence: float, fall: float) -> TermEvidence:
    return TermEvidence(recurrence=recurrence, log_bayes_factor=50.0, fall=fall)


@pytest.mark.parametrize(
    ("name", "recurrence", "fall", "stays"),
    [
        ("presliding_hysteresis", 1.0, 0.03, True),
        ("presliding_hysteresis", 1.0, -0.05, False),  # it recurs since the model is wrong, and helps nowhere
        ("presliding_hysteresis", 0.6, 0.2, True),
        ("presliding_hysteresis", 0.6, 0.05, False),
        ("joint_elasticity", 1.0, 0.2, True),
        ("joint_elasticity", 1.0, 0.06, False),  # all links would bend with it
        ("backlash", 1.0, 0.06, False),
        ("torque_delay", 1.0, 0.05, False),
    ],
)
def test_a_term_stays_for_what_it_gains_on_held_out_data(
    name: str, recurrence: float, fall: float, stays: bool
) -> None:
    evidence = weigh(recurrence, fall)
    assert _stays(name, evidence, evidence) is stays


def test_what_mends_an_effect_stays_beside_one_that_matters() -> None:
    """A power law beside a drag that gains 6 %: together with a Stribeck curve they are any curve."""
    mend = weigh(1.0, 0.06)
    assert not _stays("power_law_viscous", mend, weigh(1.0, 0.06))
    assert _stays("power_law_viscous", mend, weigh(1.0, 0.3))
