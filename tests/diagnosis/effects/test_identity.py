"""Effects that are one torque: the table by algebra holds what the rank of all columns at generic points shows."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from fricomp.diagnosis.effects import EFFECTS, Context
from fricomp.diagnosis.effects.identity import IDENTITIES, find_identity, find_twin
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.observer import Plant

_PLANT = Plant(0.3, (1.0, 6.0), 0.0, (2.0, 2.6, 0.05, 1.0), (2.3, 2.9, 0.04, 1.2), 4e4)
_MEMORYLESS: dict[str, list[dict[str, float]]] = {
    "load_coulomb": [{"inertia_share": 0.6}],
    "load_quadratic": [{"split": split, "inertia_share": 0.6} for split in (0.0, 1.0, 2.0)],
    "load_stribeck": [{"stribeck_exponent": 2.0, "inertia_share": 0.6}],
    "position_coulomb": [{"order": 3.0, "cosine": 0.0}],
    "cogging": [{"order": 7.0, "cosine": 0.0}],
    "torque_ripple": [{"order": 7.0, "cosine": 0.0}],
    "power_law_viscous": [{"exponent": 0.6}],
    "quadratic_drag": [{}],
    "spring_torque": [{"centre": 0.2, "hardening": 0.5}],
    "torque_saturation": [{"limit": 1e9}],
}
"""Effects without a memory, with the parameters that make their forms; the first linear one is set to its scale."""


def _generic_points(count: int = 400) -> Context:
    """States of which none has anything to do with another."""
    rng = np.random.default_rng(5)
    q, v, a, torque = (rng.normal(size=count) * scale for scale in (1.5, 1.0, 3.0, 4.0))
    gravity = np.cos(q) + 6.0 * np.sin(q)
    return Context(
        dt=1e-3, position=q, velocity=v, acceleration=a, torque=torque, recorded=torque, gravity=gravity,
        load_torque=gravity, friction=np.sign(v), plant=_PLANT, rotary=True, scale=1.0,
    )  # fmt: skip


def _base_columns(at: Context) -> FloatArray:
    """What a rigid joint with Stribeck friction in both directions has; its offset is the difference of the levels."""
    q, v = at.position, at.velocity
    columns = [np.cos(q), np.sin(q), at.acceleration]
    for side, speed in ((v > 0.0, 0.05), (v < 0.0, 0.04)):
        fall = np.exp(-((v / speed) ** 2))
        columns += [side * np.sign(v), side * np.sign(v) * fall, side * v, side * fall * (v / speed) ** 2]
    return np.column_stack(columns)


def _column(name: str, form: dict[str, float], at: Context) -> FloatArray:
    effect = EFFECTS[name]
    values = {p.name: 0.0 for p in effect.list_parameters([at])} | form
    size = next(p for p in effect.list_parameters([at]) if p.linear)
    added = effect.compute_contribution(at, values | {size.name: size.scale})
    total = np.zeros(at.position.size) + added.additive + np.sign(at.velocity) * added.level
    return np.asarray(total / np.linalg.norm(total))


def _are_one(columns: list[FloatArray], base: FloatArray) -> bool:
    table = np.column_stack([base / np.linalg.norm(base, axis=0), *columns])
    return bool(np.linalg.matrix_rank(table, tol=1e-8) < base.shape[1] + len(columns))


def test_the_table_has_the_pairs_that_rank_shows() -> None:
    at = _generic_points()
    base = _base_columns(at)
    forms = [(name, form) for name, forms in _MEMORYLESS.items() for form in forms]
    found = [
        (one, other)
        for (one, a), (other, b) in combinations(forms, 2)
        if one != other and _are_one([_column(one, a, at), _column(other, b, at)], base)
    ]
    assert found == [(each.one, each.other) for each in IDENTITIES for _ in ("driving", "braking")]


def test_no_effect_without_a_memory_is_in_the_base() -> None:
    at = _generic_points()
    base = _base_columns(at)
    for name, forms in _MEMORYLESS.items():
        for form in forms:
            assert not _are_one([_column(name, form, at)], base), name


@pytest.mark.parametrize(("split", "sign_of_load"), [(1.0, -1.0), (2.0, 1.0)])
def test_twice_the_coefficient_turns_one_into_the_other(split: float, sign_of_load: float) -> None:
    at = _generic_points()
    (identity,) = IDENTITIES
    load = at.load_torque + 0.6 * _PLANT.inertia * at.acceleration
    share = {"inertia_share": 0.6}
    one = EFFECTS[identity.one].compute_contribution(at, {"coefficient": 0.1, **share})
    other = EFFECTS[identity.other].compute_contribution(
        replace(at, usual_load=1.0), {"coefficient": 0.2, "split": split, **share}
    )
    sign = np.sign(at.velocity)
    np.testing.assert_allclose(sign * one.level, sign * other.level + sign_of_load * 0.1 * load, atol=1e-12)


@pytest.mark.parametrize(("split", "same"), [(1.0, True), (2.0, True), (0.0, False)])
def test_only_the_forms_of_driving_and_braking_are_the_same(split: float, same: bool) -> None:
    values = {"load_coulomb": {"coefficient": 0.1}, "load_quadratic": {"coefficient": 0.01, "split": split}}
    assert (find_identity(values) is not None) == same


@pytest.mark.parametrize(("split", "gravity"), [(1.0, 1.45), (2.0, 0.55)])
def test_a_twin_is_the_same_torque_with_another_gravity(split: float, gravity: float) -> None:
    at = replace(_generic_points(), usual_load=6.0)
    own = {"coefficient": 0.15, "split": split, "inertia_share": 0.0}
    twin = find_twin({"load_quadratic": own}, at.usual_load)
    assert twin is not None
    assert twin.values["inertia_share"] == 0.0
    assert twin.gravity == pytest.approx(gravity)
    driving = EFFECTS["load_quadratic"].compute_contribution(at, own).level * np.sign(at.velocity) + at.load_torque
    more = replace(at, load_torque=twin.gravity * at.load_torque)
    level = EFFECTS["load_coulomb"].compute_contribution(more, twin.values).level
    assert level * np.sign(at.velocity) + more.load_torque == pytest.approx(driving)


def test_what_curves_with_the_load_or_falls_with_it_has_no_twin() -> None:
    curved = {"coefficient": 0.15, "split": 0.0, "inertia_share": 0.0}
    assert find_twin({"load_quadratic": curved}, 6.0) is None
    assert find_twin({"load_quadratic": curved | {"split": 1.0, "coefficient": -0.1}}, 6.0) is None
    assert find_twin({"load_coulomb": {"coefficient": 0.1, "inertia_share": 0.0}}, 6.0) is None
