"""Effects of one kind in place of each other: which are tried, from where, and that the better one is found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from fricomp.diagnosis.effects.structure import N_BASE, Candidate, Structure
from fricomp.diagnosis.search import siblings
from fricomp.diagnosis.search.siblings import fit_siblings

from ..known import known_baseline, known_fit

_BESIDE = {("load_coulomb", "load_quadratic"), ("load_coulomb", "load_stribeck")}


@pytest.mark.parametrize(
    ("names", "wanted"),
    [
        (("quadratic_drag",), set()),
        (("encoder_eccentricity",), set()),
        (("load_coulomb",), {("load_quadratic",), ("load_stribeck",), *_BESIDE}),
        (("cogging",), {("kinematic_error",), ("position_coulomb",), ("torque_ripple",)}),
        (
            ("cogging", "quadratic_drag"),
            {
                ("kinematic_error", "quadratic_drag"),
                ("position_coulomb", "quadratic_drag"),
                ("quadratic_drag", "torque_ripple"),
            },
        ),
    ],
)
def test_others_of_the_kind_are_tried_in_place_and_laws_of_load_beside(
    names: tuple[str, ...], wanted: set[tuple[str, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = _keep_tried(monkeypatch)
    baseline = known_baseline()
    best = known_fit(baseline, names, 900.0)
    candidates = tuple(
        Candidate(one.name, (("order", 7.5),)) if one.effect.ripple else one for one in best.structure.candidates
    )
    best = replace(best, structure=replace(best.structure, candidates=candidates))
    fit_siblings(baseline, best)
    others = [one for one in tried if not set(one.names) <= set(names)]
    assert {tuple(sorted(one.names)) for one in others} == wanted
    orders = {dict(c.values)["order"] for one in others for c in one.candidates if c.effect.ripple}
    assert orders == ({best.values["cogging"]["order"]} if "cogging" in names else set())


def _keep_tried(monkeypatch: pytest.MonkeyPatch) -> list[Structure]:
    """What is tried from now on, without a fit."""
    tried: list[Structure] = []

    def keep(_: object, pairs: list[tuple[Structure, object]], *__: object, **___: object) -> list[Any]:
        tried.extend(structure for structure, _ in pairs)
        return []

    monkeypatch.setattr(siblings, "rebuild", lambda _, one: one.settled_structure)
    monkeypatch.setattr(siblings, "fit_from", keep)
    monkeypatch.setattr(siblings, "polish", lambda _, fitted, **__: fitted)
    return tried


def test_the_other_form_of_an_effect_is_tried_beside_the_rest_and_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A lag of the wrong order leaves what a power law of the speed draws."""
    tried = _keep_tried(monkeypatch)
    baseline = known_baseline()
    best = known_fit(baseline, ("drive_lag", "quadratic_drag"), 900.0)
    theta = best.fit.theta.copy()
    numbers = [one.name for _, one in best.structure.parameters]
    theta[N_BASE + numbers.index("order")], theta[N_BASE + numbers.index("damping_ratio")] = 2.0, 1.0
    fit_siblings(baseline, replace(best, fit=replace(best.fit, theta=theta)))
    tried_lags = [(one, dict(c.values)) for one in tried for c in one.candidates if c.name == "drive_lag"]
    lags = {(one.names, values["order"], values["damping_ratio"]) for one, values in tried_lags}
    others, both = ((1.0, 1.0), (2.0, 0.7)), ("drive_lag", "quadratic_drag")
    assert lags == {(names, *form) for names in (("drive_lag",), both) for form in others}
