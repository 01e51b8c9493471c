"""Laws of one form, worked out together, give each joint what its own law gives it."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.evaluation.equation import advance_states, list_dynamic, resist
from fricomp.evaluation.stacked_law import group_laws
from fricomp.laws import (
    BidirectionalStribeck,
    FrictionLaw,
    LoadCoulomb,
    LuGre,
    OperatingPoint,
    SpringTorque,
    StribeckCurve,
)


def _make_law(rng: np.random.Generator, *, bends: bool) -> FrictionLaw:
    forward, reverse = (StribeckCurve(*row) for row in rng.uniform(0.2, 2.0, (2, 4)).tolist())
    bristle = (LuGre(forward, reverse, float(rng.uniform(50.0, 500.0)), 0.0),) if bends else ()
    spring = SpringTorque(float(rng.uniform(0.1, 2.0)), 0.1)
    return FrictionLaw((BidirectionalStribeck(forward, reverse), *bristle, LoadCoulomb(0.1), spring))


@pytest.mark.parametrize("seed", range(4))
def test_each_joint_gets_what_its_own_law_gives(seed: int) -> None:
    rng = np.random.default_rng(seed)
    laws = [_make_law(rng, bends=True), None, _make_law(rng, bends=False), _make_law(rng, bends=True)]
    shape, h, top = (5, len(laws)), 1e-3, rng.uniform(0.5, 2.0, len(laws))
    v, q, a, load = (rng.normal(size=shape) for _ in range(4))
    groups = group_laws(laws)
    assert sorted(group.joints for group in groups) == [(0, 3), (2,)]
    for group in groups:
        at = list(group.joints)
        dynamic = len(list_dynamic(group.law))
        memory = tuple(1e-3 * rng.normal(size=(1, shape[0], len(at))) for _ in range(dynamic))
        point = OperatingPoint(v[:, at], q[:, at], a[:, at], load[:, at])
        together = resist(group.law, point, memory, h, top[at])
        after = advance_states(group.law, point, memory, h)
        for k, j in enumerate(at):
            own, law = OperatingPoint(v[:, j], q[:, j], a[:, j], load[:, j]), laws[j]
            assert law is not None
            alone = resist(law, own, [one[:, :, k] for one in memory], h, float(top[j]))
            for seen, expected in zip(together, alone, strict=True):
                assert np.array_equal(np.broadcast_to(seen, point.speed.shape)[:, k], np.broadcast_to(expected, 5))
            own_after = advance_states(law, own, [one[:, :, k] for one in memory], h)
            assert all(np.array_equal(x[:, :, k], y) for x, y in zip(after, own_after, strict=True))


def test_numbers_that_joints_share_stay_numbers() -> None:
    """What does not differ costs no array, and a form is told by all that is no number."""
    rng = np.random.default_rng(0)
    (group,) = group_laws([_make_law(rng, bends=False), _make_law(rng, bends=False)])
    (load,) = (term for term in group.law.terms if isinstance(term, LoadCoulomb))
    assert load.coefficient == 0.1
