"""What a loop tells its compensators: position, load and temperature; and how it lets them adapt."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from fricomp.control import AdaptationSettings, Compensator, ControlLoop, ReferenceState, SineReference
from fricomp.control.loop.load import ReportedLoad
from fricomp.control.loop.loop_compensation import LoopCompensation
from fricomp.errors import ParameterError
from fricomp.joint import JointFeedback
from fricomp.laws import (
    Cogging,
    Coulomb,
    FrictionLaw,
    KinematicError,
    LoadCoulomb,
    LoadScaling,
    ThermalViscous,
    Viscous,
)
from fricomp.model import FrictionModel, Provenance, Validity

from .test_loop import IdealJoints

RANGES = Validity(velocity=(-2.0, 2.0), load_torque=(-5.0, 5.0), normal_load=(0.0, 5.0))
PLAIN = FrictionModel(FrictionLaw((Coulomb(0.2), Viscous(0.1))), validity=RANGES)
EXTENDED = replace(
    PLAIN,
    law=FrictionLaw(
        (Coulomb(0.2), Viscous(0.3), Cogging(0.05, 0.0, 9.0), LoadCoulomb(0.1), ThermalViscous(0.01, 25.0))
    ),
)


class Carrier:
    """A load model that carries gravity."""

    def __init__(self, torque: float = 2.0) -> None:
        self.torque = torque

    def load_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        out[:] = [self.torque] * len(out)

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        self.load_into(out, feedback, reference)


def moving(velocity: float = 0.5, temperature: float = math.nan) -> tuple[JointFeedback, ReferenceState]:
    feedback, reference = JointFeedback(2), ReferenceState(2)
    feedback.position[:], feedback.velocity[:], feedback.torque[:] = [0.3, 0.3], [velocity] * 2, [0.0, 0.0]
    feedback.temperature[:] = [temperature] * 2
    reference.position[:], reference.velocity[:] = [0.3, 0.3], [velocity] * 2
    return feedback, reference


@pytest.mark.parametrize(("hot", "temperature"), [(math.nan, None), (45.0, 45.0)])
def test_extended_model_gets_position_load_and_temperature(hot: float, temperature: float | None) -> None:
    compensators = [Compensator(PLAIN, gain=1.0), Compensator(EXTENDED, gain=1.0)]
    compensation = LoopCompensation(compensators, 2, 1e-3, load_model=Carrier())
    feedback, reference = moving(temperature=hot)
    plain, extended = compensation.update(feedback, reference, reference)
    assert plain == pytest.approx(float(PLAIN.torque(0.5)))
    inputs = {"position": 0.3, "load_torque": 2.0, "temperature": temperature}
    assert extended == pytest.approx(float(EXTENDED.torque(0.5, **inputs)))


def test_terms_over_acceleration_get_that_of_the_reference() -> None:
    model = replace(PLAIN, law=FrictionLaw((Coulomb(0.2), KinematicError(1e-3, 0.0, 9.0, 2.0))))
    compensation = LoopCompensation([Compensator(model, gain=1.0, authority=9.0)] * 2, 2, 1e-3)
    feedback, reference = moving()
    reference.acceleration[:] = [3.0, -3.0]
    expected = [float(model.torque(0.5, position=0.3, acceleration=a)) for a in reference.acceleration]
    assert compensation.update(feedback, reference, reference) == pytest.approx(expected)
    assert expected[0] - expected[1] < -0.05


def test_transmitted_normal_load_is_the_size_of_the_load() -> None:
    law = FrictionLaw((Coulomb(0.2, LoadScaling(0.5, 1.0)),))
    model = replace(PLAIN, law=law, provenance=Provenance(notes={"normal_load": "the model's transmitted torque"}))
    compensation = LoopCompensation(
        [Compensator(model, gain=1.0, authority=9.0)] * 2, 2, 1e-3, load_model=Carrier(-3.0)
    )
    feedback, reference = moving()
    assert compensation.update(feedback, reference, reference)[0] == pytest.approx(0.2 * (1.0 + 0.5 * 2.0))


def test_without_a_load_model_the_reported_torque_serves() -> None:
    compensation = LoopCompensation([Compensator(EXTENDED, gain=1.0)] * 2, 2, 1e-3)
    feedback, reference = moving()
    for _ in range(500):
        feedback.torque[:] = [2.0 + compensation.torque[0], math.nan]
        loaded, unreported = compensation.update(feedback, reference, reference)
    assert loaded == pytest.approx(float(EXTENDED.torque(0.5, position=0.3, load_torque=2.0)), rel=1e-6)
    assert unreported == pytest.approx(float(EXTENDED.torque(0.5, position=0.3)))


def test_reported_load_keeps_its_last_value_over_a_gap() -> None:
    load, out, feedback = ReportedLoad([0.0], 1e-3), [0.0], JointFeedback(1)
    feedback.torque[:] = [1.0]
    for _ in range(1000):
        load.load_into(out, feedback, ReferenceState(1))
    feedback.torque[:] = [math.nan]
    load.load_into(out, feedback, ReferenceState(1))
    assert out == pytest.approx([1.0])


def test_loop_asks_a_controller_that_knows_the_load() -> None:
    joints = IdealJoints()
    compensators = [Compensator(EXTENDED, gain=1.0), Compensator(EXTENDED, gain=1.0)]
    reference = SineReference([0.1] * 2, 1.0, [0.0] * 2)
    asked = ControlLoop(joints, reference, Carrier(), compensators=compensators).run(0.25).log
    other = (
        ControlLoop(IdealJoints(), reference, Carrier(), compensators=compensators, load_model=Carrier(0.0))
        .run(0.25)
        .log
    )
    difference = asked.signal("compensation")[-1] - other.signal("compensation")[-1]
    assert difference == pytest.approx([0.2, 0.2], rel=1e-3)


def test_adaptation_is_off_unless_asked_for_and_needs_the_rigid_body() -> None:
    joints, reference = IdealJoints(), SineReference([0.1] * 2, 1.0, [0.0] * 2)
    plain = ControlLoop(joints, reference, Carrier(), compensators=[Compensator(PLAIN) for _ in range(2)])
    assert plain.compensation.adaptations == ()
    with pytest.raises(ParameterError, match="rigid body"):
        LoopCompensation([Compensator(PLAIN)], 1, 1e-3, adaptation=AdaptationSettings())


@pytest.mark.parametrize("model", [PLAIN, EXTENDED], ids=["plain", "extended"])
def test_loop_adapts_to_friction_that_has_grown(model: FrictionModel) -> None:
    settings = AdaptationSettings(
        time_constant=0.5, dry_bounds=(0.5, 2.0), viscous_bounds=(1.0, 1.0), sliding_velocity=0.1
    )
    compensators = [Compensator(model, gain=1.0, authority=9.0) for _ in range(2)]
    compensation = LoopCompensation(compensators, 2, 1e-3, load_model=Carrier(), adaptation=settings)
    inputs = {"position": 0.3, "load_torque": 2.0}
    held = 0.05 * math.sin(0.9 * 3.0) if model is EXTENDED else 0.0
    viscous = 0.05 if model is PLAIN else 0.15
    dry = float(model.torque(0.5, **inputs)) - held - viscous
    feedback, reference = moving()
    feedback.torque[:] = [2.0 + 1.3 * dry + viscous + held] * 2
    for _ in range(6000):
        found = compensation.update(feedback, reference, reference)
    assert compensation.adaptations[0].dry_scale == pytest.approx(1.3, abs=0.02)
    assert found[0] == pytest.approx(1.3 * dry + viscous + held, rel=0.02)
    compensation.reset()
    assert compensation.adaptations[0].dry_scale == 1.0
