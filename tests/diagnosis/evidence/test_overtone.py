"""What is a ripple of its own, and what the form of another one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from fricomp.diagnosis.effects.structure import Candidate, Structure
from fricomp.diagnosis.evidence.overtone import find_overtones, is_explained_by_overtone
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.search.preparation import prepare
from fricomp.diagnosis.search.refit import fit_from
from fricomp.recording import Recording

from ..known import Known, known
from ..toy_joint import ToyJoint, record


@dataclass(frozen=True, eq=False)
class Ripples(Known):
    """An explanation by ripples of given orders."""

    orders: dict[str, float] = field(default_factory=dict)

    @property
    def values(self) -> dict[str, dict[str, float]]:
        return {name: {"order": order} for name, order in self.orders.items()}


def ripples(**orders: float) -> Ripples:
    plain = known(tuple(orders), 5000.0)
    return Ripples(plain.structure, plain.fit, plain.box, plain.gain, plain.certain, plain.coverage, orders=orders)


@pytest.mark.parametrize(
    ("orders", "energy", "found"),
    [
        ({"cogging": 240.0, "kinematic_error": 482.0}, (10.0, 1.0), {"kinematic_error": ("cogging", 482.0)}),
        ({"cogging": 240.0, "kinematic_error": 482.0}, (10.0, 8.0), {}),
        ({"cogging": 240.0, "kinematic_error": 377.0}, (10.0, 1.0), {}),
        ({"cogging": 240.0, "kinematic_error": 120.0}, (10.0, 1.0), {}),
        ({"cogging": 2.0, "position_coulomb": 2.0}, (9.0, 1.0), {"position_coulomb": ("cogging", 2.0)}),
    ],
)  # fmt: skip
def test_a_weak_ripple_in_the_rhythm_of_a_strong_one_is_its_form(
    orders: dict[str, float], energy: tuple[float, float], found: dict[str, tuple[str, float]]
) -> None:
    assert find_overtones(ripples(**orders), dict(zip(orders, energy, strict=True)), 2.0, never) == found


def test_an_effect_that_is_no_ripple_is_no_overtone() -> None:
    one = ripples(cogging=240.0)
    assert find_overtones(one, {"cogging": 1.0}, 2.0, never) == {}


@pytest.mark.parametrize(("span", "found"), [(1.0, True), (2.0, False)])
def test_a_short_range_tells_orders_no_better_than_a_quarter_of_its_wave(span: float, found: bool) -> None:
    near = ripples(cogging=18.0, kinematic_error=36.9)
    assert bool(find_overtones(near, {"cogging": 10.0, "kinematic_error": 1.0}, span, never)) == found


@pytest.mark.parametrize(("order", "found"), [(39.0, {"kinematic_error": ("cogging", 36.0)}), (21.0, {})])
def test_what_an_overtone_explains_as_well_is_one_wherever_its_own_order_came_out(
    order: float, found: dict[str, tuple[str, float]]
) -> None:
    apart = ripples(cogging=18.0, kinematic_error=order)
    assert find_overtones(apart, {"cogging": 10.0, "kinematic_error": 1.0}, 4.0, lambda *_: True) == found
    assert find_overtones(apart, {"cogging": 10.0, "kinematic_error": 1.0}, 4.0, never) == {}


@pytest.mark.slow
@pytest.mark.parametrize("overtone", [True, False])
def test_an_overtone_is_told_from_a_ripple_of_another_form(overtone: bool) -> None:
    joint = ToyJoint(gravity=0.0)
    columns = record(joint, "rich", 20.0)
    q, v, n, size = columns["true_position"], columns["true_velocity"], 18.0, 4e-4
    uneven = (
        joint.inertia * size * n * (4.0 * np.cos(2 * n * q) * np.gradient(v, 1e-3) - 4.0 * n * np.sin(2 * n * q) * v**2)
    )
    second = 0.06 * np.sin(2 * n * q) if overtone else uneven
    recording = Recording(columns["time"], columns["position"], columns["torque"] + 0.12 * np.sin(n * q) + second)
    baseline = prepare(build_tracks([recording]), observer=Observer(), nulls=12, seed=0)
    wave, other = (
        Candidate("cogging", (("order", n),)),
        Candidate("kinematic_error", (("order", 2 * n), ("load_share", 0.6))),
    )
    structures = [Structure(baseline.structure.contexts, effects) for effects in ((wave,), (wave, other))]
    tried = fit_from(baseline, [(one, baseline.fit.theta) for one in structures], baseline.box)
    found = is_explained_by_overtone(baseline, tried, tried[1], "kinematic_error", "cogging", 2 * n)
    assert found == overtone


def never(name: str, other: str, order: float) -> bool:
    """No overtone explains as much."""
    return False
