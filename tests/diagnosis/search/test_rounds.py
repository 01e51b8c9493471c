"""Which base a search is kept from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.joint.problem import Weights
from fricomp.diagnosis.search import rounds
from fricomp.diagnosis.search.preparation import Baseline

from ..known import known_baseline, known_fit, known_search


def _weighed(noise: float, loudness: float) -> Baseline:
    """A base whose rows have this noise [N·m], and whose residual is so many times that."""
    plain = known_baseline(loudness=loudness)
    size = plain.fit.residual.size
    weights = Weights((np.zeros(size),), (np.full(size, noise),), np.ones(1))
    return replace(plain, problem=replace(plain.problem, weights=weights))


@pytest.mark.parametrize(("noise", "kept"), [(0.5, True), (4.0, False)])
def test_friction_that_holds_leaves_less_torque_or_creeps(
    monkeypatch: pytest.MonkeyPatch, noise: float, kept: bool
) -> None:
    """A base that is far off leaves nothing by its own noise, which is as large as what it has wrong."""
    creeping, holding = _weighed(1.0, 1.5), _weighed(noise, 1.0)
    found, again = (known_search(known_fit(one, ["joint_elasticity"], 100.0)) for one in (creeping, holding))
    monkeypatch.setattr(rounds, "_begin_again", lambda _: (holding, again))
    _, base, _ = rounds._search_with_bristle(creeping, found, lambda **_: holding, lambda _: None)
    assert base is (holding if kept else creeping)
