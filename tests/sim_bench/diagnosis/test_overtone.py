"""What is a ripple of its own, and what the form of another one."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

from fricomp.sim_bench.diagnosis.overtone import overtones

from .known import Known, known


@dataclass(frozen=True, eq=False)
class Ripples(Known):
    """An explanation by ripples of given orders."""

    orders: dict[str, float] = field(default_factory=dict)

    @property
    def values(self) -> dict[str, dict[str, float]]:
        return {name: {"order": order} for name, order in self.orders.items()}


def ripples(**orders: float) -> Ripples:
    plain = known(tuple(orders), 5000.0)
    return Ripples(plain.structure, plain.fit, plain.gain, plain.certain, plain.coverage, orders=orders)


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
    assert overtones(ripples(**orders), dict(zip(orders, energy, strict=True)), 2.0) == found


def test_an_effect_that_is_no_ripple_is_no_overtone() -> None:
    one = ripples(cogging=240.0)
    assert overtones(one, {"cogging": 1.0}, 2.0) == {}


@pytest.mark.parametrize(("span", "found"), [(1.0, True), (2.0, False)])
def test_a_short_range_tells_orders_no_better_than_a_quarter_of_its_wave(span: float, found: bool) -> None:
    near = ripples(cogging=18.0, kinematic_error=36.9)
    assert bool(overtones(near, {"cogging": 10.0, "kinematic_error": 1.0}, span)) == found
