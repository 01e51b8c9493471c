"""A curve over speed is fitted from friction that was estimated beside it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fricomp.diagnosis.effects.structure import N_BASE, Structure
from fricomp.diagnosis.joint.base import BASE_NAMES, pack
from fricomp.diagnosis.joint.observer import Plant
from fricomp.diagnosis.search import straightened
from fricomp.diagnosis.search.straightened import fit_straightened

from ..known import known_baseline, known_fit

_BESIDE = Plant(9.0, (0.0, 0.0), 0.3, (1.1, 1.5, 0.04, 0.7), (1.2, 1.6, 0.05, 0.8), 1e4)


@pytest.mark.parametrize(("names", "fits"), [(("cogging",), 0), (("cogging", "quadratic_drag"), 1)])
def test_only_curves_are_fitted_again_from_the_friction_beside_them(
    names: tuple[str, ...], fits: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[tuple[Structure, Any]] = []
    monkeypatch.setattr(straightened, "estimate_beside", lambda *_, **__: (0, 1.0, _BESIDE))

    def keep(_: object, wanted: list[tuple[Structure, Any]], __: object) -> list[Any]:
        tried.extend(wanted)
        return []

    monkeypatch.setattr(straightened, "fit_from", keep)
    best = known_fit(known_baseline(), names, 900.0)
    fit_straightened(known_baseline(), best)
    assert len(tried) == fits
    for structure, start in tried:
        assert structure.names == names
        friction = [i for i, name in enumerate(BASE_NAMES) if name == "offset" or name.startswith(("forw", "rev"))]
        np.testing.assert_array_equal(start[friction], pack(_BESIDE)[friction])
        rest = np.setdiff1d(np.arange(N_BASE), friction)
        np.testing.assert_array_equal(start[rest], best.fit.theta[rest])
