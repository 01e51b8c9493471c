"""Effects of one kind in place of each other: which are tried, from where, and that the better one is found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from fricomp.diagnosis.effects.structure import Candidate, Structure
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
    tried: list[Structure] = []

    def keep(_: object, pairs: list[tuple[Structure, object]], *__: object, **___: object) -> list[Any]:
        tried.extend(structure for structure, _ in pairs)
        return []

    monkeypatch.setattr(siblings, "rebuild_contexts", lambda _, one: one.structure.contexts)
    monkeypatch.setattr(siblings, "fit_from", keep)
    monkeypatch.setattr(siblings, "polish", lambda _, fitted, **__: fitted)
    baseline = known_baseline()
    best = known_fit(baseline, names, 900.0)
    candidates = tuple(
        Candidate(one.name, (("order", 7.5),)) if one.effect.ripple else one for one in best.structure.candidates
    )
    best = replace(best, structure=replace(best.structure, candidates=candidates))
    fit_siblings(baseline, best)
    assert {tuple(sorted(one.names)) for one in tried} == wanted
    orders = {dict(c.values)["order"] for one in tried for c in one.candidates if c.effect.ripple}
    assert orders == ({best.values["cogging"]["order"]} if "cogging" in names else set())
