import numpy as np
import pytest

from fricomp.calibration import IdentificationOptions, identify
from fricomp.calibration.identification import Status, identify_dynamic
from fricomp.calibration.identification.dynamic import simulate_bristle
from fricomp.errors import IdentificationError
from fricomp.laws import Dahl, FloatArray, LuGre, OperatingPoint, StribeckCurve
from fricomp.sim_bench.studies.paper.bristle import BRISTLE, record_lugre

from .paper import TRUE

DT = 1e-3


def _motion(seconds: float) -> FloatArray:
    t = np.arange(0.0, seconds, DT)
    slow = 0.6 * np.sin(2.0 * np.pi * 0.3 * t) * np.sin(2.0 * np.pi * 0.05 * t + 0.3)
    return np.asarray(slow + 0.02 * np.sin(2.0 * np.pi * 1.1 * t))


def test_simulation_of_many_sets_is_the_law_in_fine_steps() -> None:
    finer = 50
    law = LuGre(StribeckCurve(*TRUE[:4]), StribeckCurve(*TRUE[4:]), *BRISTLE)
    velocity = _motion(1.0)
    fine = np.interp(np.arange(finer * (len(velocity) - 1) + 1) / finer, np.arange(len(velocity)), velocity)
    z = law.rest_state()
    expected = [0.0]
    for k, v in enumerate(fine[1:], start=1):
        torque, z = law.advance(z, OperatingPoint(float(v)), DT / finer)
        if k % finer == 0:
            expected.append(float(torque))
    found = simulate_bristle(np.array([[*TRUE, *BRISTLE], [*TRUE, 50.0, 0.1]]), velocity, DT)
    np.testing.assert_allclose(found[1:, 0], expected[1:], atol=3e-4)


def test_recovers_lugre_of_a_joint_solved_by_another_rule_and_seen_through_an_encoder() -> None:
    record = record_lugre(tuple(TRUE.tolist()), 16.0, 0)
    result = identify_dynamic(record.time, record.velocity, record.torque)
    error = np.array(list(result.parameters.values())) / [*TRUE, *BRISTLE] - 1.0
    assert result.status == "converged"
    assert np.max(np.abs(error[:8])) < 0.03
    assert abs(error[8]) < 0.01
    assert abs(error[9]) < 0.06
    deviation = np.sqrt(np.diag(result.covariance)) / [*TRUE, *BRISTLE]
    assert np.max(np.abs(error) / deviation) < 4.0


@pytest.mark.slow
def test_deviations_of_dahl_hold_for_noise_that_grows_with_the_torque_and_is_correlated() -> None:
    velocity, time = _motion(8.0), DT * np.arange(8000)
    exact = simulate_bristle(np.array([[0.3, 50.0]]), velocity, DT)[:, 0]
    scores = []
    for seed in range(20):
        noise = np.convolve(np.random.default_rng(seed).normal(0.0, 0.01, len(exact) + 9), np.ones(10), "valid")
        result = identify_dynamic(time, velocity, exact * (1.0 + noise), "dahl")
        error = np.array(list(result.parameters.values())) - [0.3, 50.0]
        scores.append(error / np.sqrt(np.diag(result.covariance)))
    assert np.sqrt(np.mean(np.square(scores))) < 1.4


def test_recovers_dahl() -> None:
    velocity = _motion(8.0)
    torque = simulate_bristle(np.array([[0.3, 50.0]]), velocity, DT)[:, 0]
    torque = torque + 0.005 * np.random.default_rng(0).normal(size=len(torque))
    result = identify_dynamic(DT * np.arange(len(velocity)), velocity, torque, "dahl")
    assert isinstance(result.model.law.terms[0], Dahl)
    assert result.parameters["dahl.coulomb_torque"] == pytest.approx(0.3, rel=0.01)
    assert result.parameters["dahl.sigma_0"] == pytest.approx(50.0, rel=0.05)


def test_a_record_without_reversals_is_refused() -> None:
    time = DT * np.arange(500)
    with pytest.raises(IdentificationError, match="reverses"):
        identify_dynamic(time, np.ones(500), np.ones(500))


def test_a_bristle_model_knows_its_joint_and_friction_without_one_has_a_status() -> None:
    velocity = _motion(4.0)
    torque = 0.2 * np.tanh(velocity / 1e-4) + 1e-3 * np.random.default_rng(1).normal(size=velocity.size)
    options = IdentificationOptions(joint="elbow", motion="linear", torque_unit="A")
    result = identify_dynamic(DT * np.arange(velocity.size), velocity, torque, "dahl", options=options)
    assert (result.model.joint, result.model.motion, result.model.torque_unit) == ("elbow", "linear", "A")
    assert result.status in (Status.CONVERGED, Status.NOT_IDENTIFIABLE)


def test_points_cannot_be_identified_with_a_law_that_has_a_state() -> None:
    with pytest.raises(IdentificationError, match="identify_dynamic"):
        identify([0.1, 0.2, 0.3, 0.4], [0.1, 0.1, 0.1, 0.1], law="lugre")
