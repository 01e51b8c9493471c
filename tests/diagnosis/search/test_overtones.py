"""Ripples that are no sines."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.effects.structure import N_BASE, Candidate, Structure
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.search.overtones import fit_overtones
from fricomp.diagnosis.search.preparation import Baseline, prepare
from fricomp.diagnosis.search.refit import fit_from
from fricomp.recording import Recording

from ..toy_joint import ToyJoint, record

_SIZE = 0.12


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "overtone", "drag", "order"),
    [
        ("cogging", 0.06, 0.3, 18.0),  # beside another effect that is missing, so that a pure wave leaves much as well
        ("cogging", 0.0, 0.3, 18.0),
        ("torque_ripple", 0.06, 0.3, 18.0),
        ("torque_ripple", 0.0, 0.0, 18.0),  # its square is no overtone
        ("cogging", 0.06, 0.0, 120.0),  # so fine that it has made the noise loud, and nothing is left above that
    ],
)
def test_an_overtone_belongs_to_its_ripple_where_it_takes_much_of_what_is_left(
    name: str, overtone: float, drag: float, order: float
) -> None:
    columns = record(ToyJoint(gravity=1.0, quadratic_drag=drag), "rich", 20.0)
    q = columns["true_position"]
    ripple = _SIZE * np.sin(order * q) + overtone * np.sin(2.0 * order * q + 1.0)
    torque = columns["torque"] + ripple if name == "cogging" else columns["torque"] / (1.0 - ripple)
    baseline = _prepare(Recording(columns["time"], columns["position"], torque))
    wave = Candidate(name, (("order", order),))
    pure = Structure(baseline.structure.contexts, (wave,))
    (before,) = fit_from(baseline, [(pure, baseline.fit.theta)], baseline.box)
    found = fit_overtones(baseline, [before], 30.0)
    assert len(found) == (overtone > 0.0)
    for one in found:
        values = one.structure.name_values(one.fit.theta[N_BASE:])[name]
        assert np.hypot(values["sine_overtone_2"], values["cosine_overtone_2"]) == pytest.approx(overtone, rel=0.1)
        assert one.gain > before.gain
        assert fit_overtones(baseline, [one], 30.0) == []


def _prepare(recording: Recording) -> Baseline:
    return prepare(build_tracks([recording]), observer=Observer(), nulls=12, seed=0)
