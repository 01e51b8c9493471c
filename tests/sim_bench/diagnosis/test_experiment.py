"""A motion is proposed only where it would tell explanations apart, whatever a refit makes of them."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.sim_bench.diagnosis.agreement import hold
from fricomp.sim_bench.diagnosis.experiment import _ENOUGH, _worth, propose
from fricomp.sim_bench.diagnosis.explanation import Explanation
from fricomp.sim_bench.diagnosis.loading import build_tracks
from fricomp.sim_bench.diagnosis.observer import Observer
from fricomp.sim_bench.diagnosis.preparation import Prepared, prepare
from fricomp.sim_bench.diagnosis.refit import fit_from
from fricomp.sim_bench.diagnosis.rigid import RigidJoint
from fricomp.sim_bench.diagnosis.structure import Candidate

from .toy_joint import ToyJoint, recording

_JOINT = ToyJoint(load_coulomb=0.15)
_KNOWN = RigidJoint(
    _JOINT.inertia,
    (_JOINT.gravity * np.sin(_JOINT.phase), _JOINT.gravity * np.cos(_JOINT.phase)),
    0.0,
    0.0,
    0.0,
    True,
)


@pytest.fixture(scope="module")
def prepared() -> Prepared:
    tracks = build_tracks([recording(_JOINT, "fourier", 15.0)])
    return prepare(tracks, observer=Observer(), nulls=12, seed=0, rigid=_KNOWN)


@pytest.fixture(scope="module")
def fitted(prepared: Prepared) -> list[Explanation]:
    """Friction under load, and friction that differs between driving and braking."""
    candidates = (Candidate("load_coulomb", ()), Candidate("load_quadratic", (("split", 1.0),)))
    wanted = [([candidate], prepared.fit.theta) for candidate in candidates]
    return fit_from(prepared, wanted, prepared.box)


def test_driving_and_braking_is_friction_under_load_and_another_gravity_on_any_motion(
    prepared: Prepared, fitted: list[Explanation]
) -> None:
    linear, driving = fitted
    assert driving.gain == pytest.approx(linear.gain, rel=1e-3)
    assert propose(prepared, linear, [driving], prepared.box) is None


def test_with_the_gravity_of_the_simulation_a_motion_tells_them_apart(
    prepared: Prepared, fitted: list[Explanation]
) -> None:
    linear, driving = fitted
    proposal = propose(prepared, linear, [driving], hold(prepared.box, _KNOWN))
    assert proposal is not None
    assert proposal.separates == ("load_coulomb", "load_quadratic")
    track = prepared.problem.tracks[0]
    wanted = proposal.motion["position_reference"]
    assert track.position.min() < wanted.min() < wanted.max() < track.position.max()
    assert np.ptp(np.diff(proposal.motion["time"])) < 1e-9


def test_two_rivals_told_apart_are_worth_more_than_one_told_clearly() -> None:
    assert _worth([1.1 * _ENOUGH, 1.1 * _ENOUGH]) > _worth([0.0, 100.0 * _ENOUGH])
    assert _worth([1.1 * _ENOUGH, 0.5 * _ENOUGH]) > _worth([1.1 * _ENOUGH, 0.0])
