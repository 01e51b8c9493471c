"""How far the base strays beside a law of slightly another form."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fricomp.diagnosis.effects.settings import EFFECT
from fricomp.diagnosis.effects.structure import N_BASE
from fricomp.diagnosis.evidence.form_strays import compute_form_strays
from fricomp.diagnosis.joint.solver import Box, Fit


def _case(alike: float) -> tuple[Any, Any, Any]:
    """Rows in which the torque of an effect is correlated by `alike` with that of the second base parameter."""
    rng, rows = np.random.default_rng(4), 1600
    effect, other = rng.standard_normal((2, rows))
    jacobian = np.zeros((rows, N_BASE + 1))
    jacobian[:, 1] = alike * effect + np.sqrt(1.0 - alike**2) * other
    one = np.ones(N_BASE + 1)
    box = Box(-1e9 * one, 1e9 * one, one, 0.0 * one, np.zeros((N_BASE + 1, N_BASE + 1)), one)
    context = SimpleNamespace(position=rng.uniform(size=rows), velocity=rng.uniform(-1.0, 1.0, rows))
    structure = SimpleNamespace(
        contexts=(context,), names=("cogging",), compute_added=lambda *_: effect, build_known_box=lambda: None
    )
    baseline = SimpleNamespace(problem=SimpleNamespace(grids=[SimpleNamespace(centres=np.arange(rows))]))
    chosen = SimpleNamespace(box=SimpleNamespace(join=lambda _: box))
    refitted = SimpleNamespace(structure=structure, fit=Fit(np.zeros(N_BASE + 1), np.zeros(rows), jacobian, 0.0))
    return baseline, chosen, refitted


def test_a_parameter_with_the_torque_of_the_effect_strays_by_its_form() -> None:
    """Each of 16 ranges moves it by an eighth of the form, one way or the other: half of the form in all."""
    strays = compute_form_strays(*_case(1.0))
    assert strays[1] == pytest.approx(0.5 * EFFECT.usual_form, rel=0.05)
    assert not np.delete(strays, 1).any()


def test_a_parameter_that_has_nothing_to_do_with_the_effect_hardly_strays() -> None:
    assert compute_form_strays(*_case(0.0))[1] < 0.15 * compute_form_strays(*_case(1.0))[1]


def test_beside_nothing_nothing_strays() -> None:
    baseline, _, refitted = _case(1.0)
    assert not compute_form_strays(baseline, None, refitted).any()
