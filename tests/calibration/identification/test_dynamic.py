import numpy as np
import pytest

from fricomp.calibration import identify
from fricomp.calibration.identification.dynamic import simulate_bristle
from fricomp.errors import IdentificationError
from fricomp.laws import Dahl, FloatArray, LuGre, OperatingPoint, StribeckCurve

from .paper import TRUE

DT = 1e-3


def _motion(seconds: float) -> FloatArray:
    t = np.arange(0.0, seconds, DT)
    slow = 0.6 * np.sin(2.0 * np.pi * 0.3 * t) * np.sin(2.0 * np.pi * 0.05 * t + 0.3)
    return np.asarray(slow + 0.02 * np.sin(2.0 * np.pi * 1.1 * t))


def _lugre() -> LuGre:
    return LuGre(StribeckCurve(*TRUE[:4]), StribeckCurve(*TRUE[4:]), 200.0, 0.5)


def test_simulation_of_many_sets_is_the_law_step_by_step() -> None:
    velocity, law = _motion(1.0), _lugre()
    z = law.rest_state()
    expected = np.empty(len(velocity))
    for k, v in enumerate(velocity):
        expected[k], z = law.advance(z, OperatingPoint(float(v)), DT)
    values = np.array([[*TRUE, 200.0, 0.5]])
    np.testing.assert_allclose(simulate_bristle(values, velocity, DT)[:, 0], expected, atol=1e-12)


@pytest.mark.slow
def test_recovers_lugre_from_reversals_with_two_percent_noise() -> None:
    velocity = _motion(40.0)
    values = np.array([*TRUE, 200.0, 0.5])
    exact = simulate_bristle(values[None], velocity, DT)[:, 0]
    torque = exact * (1.0 + 0.02 * np.random.default_rng(0).normal(size=len(exact)))
    result = identify(velocity, torque, law="lugre", time=DT * np.arange(len(velocity)))
    found = np.array(list(result.parameters.values()))
    assert np.max(np.abs(found / values - 1.0)[:8]) < 0.02
    assert abs(found[8] / 200.0 - 1.0) < 0.1


def test_recovers_dahl() -> None:
    velocity = _motion(8.0)
    torque = simulate_bristle(np.array([[0.3, 50.0]]), velocity, DT)[:, 0]
    torque = torque + 0.005 * np.random.default_rng(0).normal(size=len(torque))
    result = identify(velocity, torque, law="dahl", time=DT * np.arange(len(velocity)))
    assert isinstance(result.model.law.terms[0], Dahl)
    assert result.parameters["dahl.coulomb_torque"] == pytest.approx(0.3, rel=0.01)
    assert result.parameters["dahl.sigma_0"] == pytest.approx(50.0, rel=0.05)


def test_a_record_without_reversals_is_refused() -> None:
    time = DT * np.arange(500)
    with pytest.raises(IdentificationError, match="reverses"):
        identify(np.ones(500), np.ones(500), law="lugre", time=time)
