"""The model that the error of parameters as given is of: what was found to be off is put back, and nothing else."""

from dataclasses import replace

import pytest

from fricomp.diagnosis.evidence.comparison import Comparison, Shift
from fricomp.diagnosis.inputs.rigid import RigidJoint
from fricomp.diagnosis.verdict.given_model import write_given_model
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel, JointDynamics

from ..known import known_baseline, known_case, known_findings

_BASE = known_baseline()
_FOUND = FrictionModel(
    FrictionLaw((BidirectionalStribeck(StribeckCurve(3.0, 4.0, 0.1, 1.0), StribeckCurve(1.0, 2.0, 0.3, 2.0)),)),
    dynamics=JointDynamics(0.5, 1.0, 2.0, 0.25, load_inertia=0.1),
)
_ARM = RigidJoint(0.4, (1.5, 2.5), 0.05, 0.0, 0.0, True)
_LIFT = RigidJoint(20.0, (0.0, 0.0), 98.1, 0.0, 0.0, False)


@pytest.mark.parametrize(
    ("rigid", "off", "held", "dynamics", "even"),
    [
        (_ARM, "payload_error", ("inertia", "gravity_cosine", "gravity_sine"), (0.4, 1.5, 2.5, 0.25), False),
        (_ARM, "torque_offset", ("offset",), (0.5, 1.0, 2.0, 0.05), True),
        (_ARM, "direction_asymmetry", ("offset",), (0.5, 1.0, 2.0, 0.05), True),
        (_LIFT, "payload_error", ("inertia", "gravity_cosine", "gravity_sine", "offset"), (20.0, 0, 0, 98.1), True),
    ],
)
def test_what_was_off_is_as_given(
    rigid: RigidJoint, off: str, held: tuple[str, ...], dynamics: tuple[float, ...], even: bool
) -> None:
    found = known_findings(_BASE, known_case(_BASE, rigid=rigid), comparison=Comparison((Shift(off, {}, ""),)))
    given = write_given_model(found, _FOUND)
    assert given is not None
    body = given.model.dynamics
    assert body is not None
    assert (given.held, (body.inertia, body.gravity_cosine, body.gravity_sine, body.offset)) == (held, dynamics)
    assert (given.model.forward == given.model.reverse) == even
    if even:
        assert given.model.forward.coulomb_torque == 2.0


def test_where_nothing_was_off_there_is_none() -> None:
    assert write_given_model(known_findings(_BASE, known_case(_BASE, rigid=_ARM)), _FOUND) is None


def test_directions_of_a_given_friction_model_are_not_evened() -> None:
    shifts = Comparison((Shift("direction_asymmetry", {}, ""),))
    case = known_case(_BASE, rigid=_ARM, friction=replace(_FOUND, dynamics=None))
    assert write_given_model(known_findings(_BASE, case, comparison=shifts), _FOUND) is None
