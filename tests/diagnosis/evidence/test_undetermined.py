"""A number is not determined where what it may be is more than it is, and makes a difference."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.effects.structure import N_BASE, Candidate, Structure
from fricomp.diagnosis.evidence.refitted import RefittedJoint
from fricomp.diagnosis.evidence.undetermined import list_undetermined
from fricomp.diagnosis.joint.base import BASE_NAMES

from ..known import known_baseline, known_fit

_UNITS = ("N·m", "rad")


def _joint(name: str = "", own: float = 0.0, values: dict[str, float] | None = None, **base: float) -> RefittedJoint:
    """The known base, maybe with an effect; standard deviations of numbers of the base by name, and of the effect's."""
    baseline, candidates = known_baseline(), [Candidate(name, tuple((values or {}).items()))] if name else []
    recorded = [replace(one, recorded=np.sin(np.arange(one.time.size))) for one in baseline.structure.contexts]
    structure = Structure(tuple(recorded), tuple(candidates))
    one = replace(known_fit(baseline, [name] if name else [], 100.0), structure=structure)
    theta = np.concatenate([baseline.fit.theta, structure.build_start()])
    deviation = np.concatenate([[base.get(each, 0.0) for each in BASE_NAMES], np.full(theta.size - N_BASE, own)])
    fit = replace(one.fit, theta=theta, jacobian=np.zeros((baseline.fit.residual.size, theta.size)))
    return RefittedJoint(structure, fit, np.diag(deviation**2))


@pytest.mark.parametrize(("deviation", "found"), [(0.05, ()), (0.3, ()), (0.6, ("inertia",)), (60.0, ("inertia",))])
def test_an_inertia_that_may_be_twice_or_next_to_nothing_is_not_determined(
    deviation: float, found: tuple[str, ...]
) -> None:
    assert list_undetermined(_joint(log_inertia=deviation), _UNITS) == found


def test_a_constant_torque_that_is_next_to_nothing_for_sure_is_determined() -> None:
    assert list_undetermined(_joint(offset=0.01), _UNITS) == ()
    assert list_undetermined(_joint(offset=10.0), _UNITS) == ("offset",)


def test_a_share_that_may_be_all_that_is_looked_for_is_not_determined() -> None:
    load = {"coefficient": 0.3, "inertia_share": 0.5}
    assert "load_coulomb.inertia_share" in list_undetermined(_joint("load_coulomb", 0.4, load), _UNITS)
    assert list_undetermined(_joint("load_coulomb", 0.05, load), _UNITS) == ()


def test_one_part_of_a_wave_may_be_zero() -> None:
    wave = {"sine": 0.0, "cosine": 0.3, "order": 40.0}
    assert list_undetermined(_joint("cogging", 0.02, wave), _UNITS) == ()
