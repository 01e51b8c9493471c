"""A new effect is one module: what is defined here takes part in the search at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from fricomp.diagnosis.effects import EFFECTS, Context, Effect, EffectParameter, register
from fricomp.diagnosis.effects.effect import Values
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Contribution, Observer
from fricomp.diagnosis.search.preparation import prepare
from fricomp.diagnosis.search.screening import screen
from fricomp.recording import Recording

from ..toy_joint import ToyJoint, record


@pytest.fixture
def cubic_drag() -> Iterator[str]:
    """Drag that grows with the cube of the speed, for as long as a test lasts."""

    class CubicDrag(Effect):
        name = "cubic_drag"
        kind = "physics"
        equation = "tau_f = c v^3"
        citation = ""
        says = "friction grows with the cube of the speed"

        def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
            scale, top = contexts[0].scale, max(float(np.max(np.abs(c.velocity))) for c in contexts)
            return (EffectParameter("coefficient", "{torque}·s³/{position}³", 0.05 * scale / top**3, -1e6, 1e6),)

        def compute_contribution(self, context: Context, values: Values) -> Contribution:
            return Contribution(additive=values["coefficient"] * context.velocity**3)

    register(CubicDrag)
    yield CubicDrag.name
    del EFFECTS[CubicDrag.name]


@pytest.mark.slow
def test_the_search_screens_an_effect_that_is_defined_elsewhere(cubic_drag: str) -> None:
    columns = record(ToyJoint(), "rich", 10.0)
    drag = 0.3 * np.gradient(columns["position"], 1e-3) ** 3
    recording = Recording(columns["time"], columns["position"], columns["torque"] + drag)
    baseline = prepare(build_tracks([recording]), observer=Observer(), nulls=6, seed=0)
    fit = baseline.fit
    first = screen(baseline.problem, baseline.structure, fit.theta, fit.residual, fit.jacobian)
    assert first.columns[0].candidate.name == cubic_drag
